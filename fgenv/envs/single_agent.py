"""One robot of each world does as told, the others follow a policy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Flags, Floats, Floats32

from .policy import checked_actions, policy_of
from .simulator import Simulator
from .simulator_view import View
from .state_readers import MOVING


class Outcome(NamedTuple):
    """Of a step, for the robot that learns."""

    observations: Floats32  # (worlds, size)
    rewards: Floats  # (worlds,)
    terminated: Flags  # (worlds,): it has arrived, or a collision has ended the episode
    truncated: Flags  # (worlds,): the horizon is reached


class Learner:
    """A robot in each world of a simulator without autoreset.

    Args:
        robot: its name, or its place.
        others: a policy, a function of observations, or a name; see `policy_of`. A policy by name
            is made anew with each seed.
    """

    def __init__(self, simulator: Simulator, robot: str | int, others: Any) -> None:
        self.simulator, self.place = simulator, place_of(simulator, robot)
        self.others, self._policy = others, policy_of(others)
        self._over = np.ones(simulator.n_worlds, dtype=bool)

    def reset(
        self, seed: int | Sequence[int] | None = None, worlds: ArrayLike | None = None
    ) -> Floats32:
        """Begin episodes of all worlds, or of some; returns observations of all, (worlds, size)."""
        self.simulator.reset(seed, worlds)
        if worlds is None:
            if isinstance(self.others, str) and seed is not None:
                first = seed if isinstance(seed, (int, np.integer)) else seed[0]
                self._policy = policy_of(self.others, int(first))
            self._policy.reset(View(self.simulator))
        self._over[slice(None) if worlds is None else np.asarray(worlds)] = False
        self._seen = self.simulator.observe()
        return self._own(self._seen)

    def step(self, actions: ArrayLike) -> Outcome:
        """Step with actions (worlds, size); an episode ends with the robot's.

        Raises:
            ValueError: wrong shape, or a number that is not finite. Nothing has changed then.
            RuntimeError: an episode is over.
        """
        own = self._checked(actions)
        if self._over.any():
            raise RuntimeError("step: the episode is over, or has not begun, call reset()")
        asked = checked_actions(self._policy, self.simulator, self._seen)
        asked[:, self.place, : own.shape[1]] = own
        done = self.simulator.step(asked)
        self._seen = done.observations
        ended = done.terminated | (self.simulator.status[:, self.place] != MOVING)
        late = done.truncated & ~ended
        self._over = ended | late
        return Outcome(self._own(self._seen), done.rewards[:, self.place].copy(), ended, late)

    def _own(self, rows: Floats32) -> Floats32:
        return rows[:, self.place, : self.simulator.observation_sizes[self.place]].copy()

    def _checked(self, actions: ArrayLike) -> Floats:
        own = np.asarray(actions, dtype=np.float64)
        expected = (self.simulator.n_worlds, self.simulator.action_sizes[self.place])
        name = self.simulator.names[self.place]
        if own.shape != expected:
            raise ValueError(f"action of {name!r}: shape {own.shape}, expected {expected}")
        if not np.isfinite(own).all():
            world = int(np.argwhere(~np.isfinite(own))[0, 0])
            raise ValueError(f"action of {name!r} in world {world}: {own[world].tolist()}")
        return own


def place_of(simulator: Simulator, robot: str | int) -> int:
    """The place of a robot by its name, or a place.

    Raises:
        ValueError: there is none.
    """
    if isinstance(robot, str):
        if robot not in simulator.names:
            raise ValueError(f"robot: {robot!r} is unknown, expected {', '.join(simulator.names)}")
        return simulator.names.index(robot)
    if isinstance(robot, bool) or not isinstance(robot, (int, np.integer)):
        raise ValueError(f"robot: got {robot!r}, expected a name or a place")
    if not 0 <= robot < simulator.n_robots:
        raise ValueError(f"robot: got {robot}, expected 0 to {simulator.n_robots - 1}")
    return int(robot)

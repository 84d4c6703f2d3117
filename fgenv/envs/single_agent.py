"""One learning robot in each world; the other robots follow a policy."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Flags, Floats, Floats32

from .policy import checked_actions, policy_of
from .simulator import Simulator
from .simulator_view import View
from .state_readers import MOVING


class RobotStep(NamedTuple):
    """A step of the learning robots."""

    observations: Floats32  # (worlds, size)
    rewards: Floats  # (worlds,)
    terminated: Flags  # (worlds,): it has arrived, or a collision has ended the episode
    truncated: Flags  # (worlds,): the horizon is reached


class LearnerState(NamedTuple):
    """The state of an environment with a learning robot."""

    simulator: bytes
    policy: Any  # a copy of that of the other robots


class LearningRobot:
    """The learning robot in each world of a simulator without autoreset.

    Args:
        robot: its name or index.
        others: policy of the other robots, see `policy_of`.
    """

    def __init__(self, simulator: Simulator, robot: str | int, others: Any) -> None:
        self.simulator, self.index = simulator, robot_index(simulator, robot)
        self._policy = policy_of(others)
        self._seen = -1  # changes of the simulator at the last observations

    @property
    def name(self) -> str:
        """Name of the learning robot."""
        return self.simulator.names[self.index]

    def reset(
        self, seed: int | Sequence[int] | None = None, worlds: ArrayLike | None = None
    ) -> Floats32:
        """Begin episodes of all or some worlds; return observations of all, (worlds, size)."""
        self.simulator.reset(seed, worlds)
        if worlds is None:
            self._policy.reset(View(self.simulator))
        return self.observe()

    def observe(self) -> Floats32:
        """Return the observations of the current state, (worlds, size)."""
        self._keep(self.simulator.observe())
        return self._own(self._observations)

    @property
    def over(self) -> Flags:
        """Whether the episode of each robot is over or has not begun, (worlds,)."""
        if not self.simulator.begun:
            return np.ones(self.simulator.n_worlds, dtype=bool)
        arrived: Flags = self.simulator.status[:, self.index] != MOVING
        return arrived | self.simulator.over

    def get_state(self) -> LearnerState:
        """Return the state of all worlds and of the policy of the other robots."""
        return LearnerState(self.simulator.state(), self._copied(self._policy))

    def set_state(self, state: LearnerState) -> None:
        """Continue from a state, bit for bit."""
        self.simulator.set_state(state.simulator)
        self._policy = self._copied(state.policy)

    def _copied(self, policy: Any) -> Any:
        """A copy of a policy for the same simulator, which it may refer to."""
        return copy.deepcopy(policy, {id(self.simulator): self.simulator})

    def _keep(self, observations: Floats32) -> None:
        self._observations, self._seen = observations, self.simulator.changes

    def step(self, actions: ArrayLike, begin_next: bool = False) -> RobotStep:
        """Step with actions (worlds, size); an episode ends with that of the robot.

        Args:
            begin_next: a world with an ended episode begins the next one in this step; its action
                is ignored, and its reward is 0. Otherwise such a world is an error.

        Raises:
            ValueError: wrong shape, or a number that is not finite. The state is unchanged.
            RuntimeError: an episode is over.
        """
        own = self._checked(actions)
        over = self.over
        if over.any() and not (begin_next and self.simulator.begun):
            raise RuntimeError("step: the episode is over or has not begun; call reset()")
        if self._seen != self.simulator.changes:
            self.observe()
        every = checked_actions(self._policy, self.simulator, self._observations)
        every[:, self.index, : own.shape[1]] = own
        step = self.simulator.step(every, after_end=begin_next)
        self._keep(step.observations)
        terminated = step.terminated | (self.simulator.status[:, self.index] != MOVING)
        truncated = step.truncated & ~terminated
        rewards = step.rewards[:, self.index].copy()
        if over.any():
            self.reset(worlds=np.flatnonzero(over))
            terminated, truncated, rewards = terminated & ~over, truncated & ~over, rewards * ~over
        return RobotStep(self._own(self._observations), rewards, terminated, truncated)

    def _own(self, observations: Floats32) -> Floats32:
        size = self.simulator.observation_sizes[self.index]
        return observations[:, self.index, :size].copy()

    def _checked(self, actions: ArrayLike) -> Floats:
        worlds, size = self.simulator.n_worlds, self.simulator.action_sizes[self.index]
        label = f"action of {self.name!r}"
        own = real_numbers(actions, label)
        if own.shape != (worlds, size):
            raise ValueError(f"{label}: got shape {own.shape}, expected {(worlds, size)}")
        if not np.isfinite(own).all():
            world = int(np.argwhere(~np.isfinite(own))[0, 0])
            where = f" in world {world}" if worlds > 1 else ""
            raise ValueError(f"{label}{where}: got {own[world].tolist()}, expected finite numbers")
        return own


def real_numbers(value: Any, label: str) -> Floats:
    """Return real numbers as an array.

    Raises:
        ValueError: text, objects or complex numbers.
    """
    try:
        array = np.asarray(value)
        if array.dtype.kind in "biuf":
            return array.astype(np.float64)
    except (TypeError, ValueError):  # rows of different lengths
        pass
    raise ValueError(f"{label}: got {value!r}, expected real numbers")


def robot_index(simulator: Simulator, robot: str | int) -> int:
    """Return the index of a robot, given by its name or index.

    Raises:
        ValueError: no such robot.
    """
    if isinstance(robot, str):
        if robot not in simulator.names:
            raise ValueError(f"robot: got {robot!r}, expected {', '.join(simulator.names)}")
        return simulator.names.index(robot)
    if isinstance(robot, bool) or not isinstance(robot, (int, np.integer)):
        raise ValueError(f"robot: got {robot!r}, expected a name or an index")
    if not 0 <= robot < simulator.n_robots:
        raise ValueError(f"robot: got {robot}, expected 0 to {simulator.n_robots - 1}")
    return int(robot)

"""The batched simulator: many worlds of one scenario, stepped at once in native code.

In a step every robot drives, all motions are certified free or stopped at their first contact, in
chronological order (`World.advance`); goals, rewards and observations follow. The PettingZoo,
Gymnasium and Stable-Baselines3 environments are views of this class.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.arrays import Flags, Floats, Floats32
from fgenv.robots import Robot
from fgenv.scenarios import FrozenSet, Scenario

from . import native_config
from .cases import Cases, resolve_scenario
from .observations import Observation
from .rewards import Reward
from .simulator_settings import SimulatorSettings
from .state_readers import CACHED, MOVING, SimulatorState

Source = str | Path | Scenario | FrozenSet


class StepResult(NamedTuple):
    """Arrays that a step returns."""

    observations: Floats32  # (worlds, robots, size)
    rewards: Floats  # (worlds, robots)
    terminated: Flags  # (worlds,): all have arrived, or a collision ended the episode
    truncated: Flags  # (worlds,): the horizon is reached


class Simulator(SimulatorState):
    """Worlds of one scenario, stepped at once.

    `changes` counts resets, steps and other changes of the state, for views that keep a copy.

    Arrays have shape (worlds, robots, ...). If robots differ, rows are as wide as the widest one
    and end in zeros.

    Actions are in [-1, 1] and clipped to it. With `actions="drive"`, they scale the limits of the
    drive: 0 is the middle, 1 the upper limit. With `actions="way_points"`, an action is a waypoint:
    x, y (z) and yaw of the base in its own frame, then the joints. 1 is the distance at full speed
    in `way_point_seconds`, or half a turn. A waypoint sets the path's mask, and the drive goes
    there for one step.

    Random numbers depend on a world's seed and its number of episodes alone. Results are the same
    bits for any number of threads and any instruction set.

    Args:
        scenario: Name, file, Scenario, or FrozenSet. Each episode is a case of a frozen set.
        worlds: Number of worlds.
        observation, reward: See `Observation` and `Reward`; None: their defaults.
        actions: `drive` or `way_points`.
        way_point_seconds: Seconds to the farthest waypoint at full speed.
        starts: `scenario`, or `random`: starts and goals of each episode are uniform in the
            workspace (a free base is level) and free of collisions; those of the scenario if there
            is no room.
        cases: Number of cases of a built-in scenario, each with its own seed, as in `frozen`.
        case_order: `random`, or `seed`: the case is (seed + episode) modulo the number of cases.
        clearance: Measure each robot's distance to the nearest body after each step.
        tolerance: Distance at which a robot may stop before a contact, meters; a smaller one costs
            more time.
        autoreset: Begin a new episode in the step in which one ends; `final_observations` are those
            at the end. If False, stepping after the end is an error.
        max_steps: Steps of an episode, in place of the scenario's horizon.
        threads: Number of threads; None: FGENV_THREADS, else all cores.
        overrides: Arguments of `Scenario.load`.

    Raises:
        ScenarioError, ValueError, TypeError: with the argument, its value, the expected value and
            the remedy.
    """

    def __init__(
        self,
        scenario: Source,
        worlds: int = 1,
        *,
        observation: Observation | None = None,
        reward: Reward | None = None,
        actions: str = "drive",
        way_point_seconds: float = 1.0,
        starts: str = "scenario",
        cases: int | None = None,
        case_order: str = "random",
        clearance: bool = False,
        tolerance: float = 1e-4,
        autoreset: bool = True,
        max_steps: int | None = None,
        threads: int | None = None,
        **overrides: Any,
    ) -> None:
        self.settings = SimulatorSettings(
            n_worlds=worlds,
            observation=Observation() if observation is None else observation,
            reward=Reward() if reward is None else reward,
            actions=actions,
            way_point_seconds=way_point_seconds,
            starts=starts,
            case_order=case_order,
            clearance=clearance,
            tolerance=tolerance,
            autoreset=autoreset,
            max_steps=max_steps,
            threads=threads,
        )
        self.scenario, frozen_set = resolve_scenario(scenario, cases, overrides)
        if not self.scenario.robots:
            raise ValueError(
                f"scenario: got {self.scenario.name!r} without robots, expected at least one"
            )
        self.built = self.scenario.build()
        self.cases = Cases.of(self.built, frozen_set)
        if starts == "random":
            check_bounded(self.robots)
        self._make_core()

    def _make_core(self) -> None:
        """Make the native simulator, before its first reset."""
        self._like = self.built.world()
        self._core = native_config.make_simulator(
            self._like, self.built, self.cases, self.settings, self.horizon
        )
        self.final_observations: Floats32 | None = None
        self._begun = False
        self._over = np.zeros(self.n_worlds, dtype=bool)
        self.changes = 0

    def reset(
        self,
        seed: int | Sequence[int] | None = None,
        worlds: ArrayLike | None = None,
    ) -> Floats32:
        """Begin episodes.

        Args:
            seed: The k-th of the worlds gets seed + k, or seed[k], and begins its first episode.
                None: the next episode of the current seeds (seed 0 at first).
            worlds: Numbers of worlds, or a mask (worlds,); None: all.

        Returns:
            Observations of these worlds, (worlds, robots, size).
        """
        which = self._world_numbers(worlds)
        seeds = None if seed is None else world_seeds(seed, len(which))
        if not self._begun and len(which) < self.n_worlds:
            self._core.reset(None, None, self.settings.threads)
        observations = self._core.reset(which, seeds, self.settings.threads)
        self._begun = True
        self._over[which] = False
        self.changes += 1
        return observations

    def step(self, actions: ArrayLike, *, after_end: bool = False) -> StepResult:
        """Step all worlds with actions (worlds, robots, size).

        Args:
            after_end: also step worlds with an ended episode, which begin anew afterwards.

        Raises:
            ValueError: wrong shape, or a number that is not finite, with its index.
            RuntimeError: before the first reset, or after the end without autoreset. The state has
                not changed then.
        """
        self._check_begun("step")
        if not self.autoreset and not after_end and self._over.any():
            over = int(self._over.argmax())
            raise RuntimeError(f"step: the episode of world {over} is over, call reset()")
        rows, rewards, arrived, terminated, truncated = self._core.step(
            actions, self.settings.threads
        )
        if self.reward.own:
            own = self.reward.sum_of_own_terms(self)
            arrived_before = arrived & (self.arrival_steps < self.steps[:, None])
            rewards = rewards + np.where(arrived_before, 0.0, own)
        self._over = terminated | truncated
        self.changes += 1
        self.final_observations = None
        if self.autoreset and self._over.any():
            self.final_observations = rows.copy()
            ended = np.flatnonzero(self._over)
            rows[ended] = self.reset(worlds=ended)
        return StepResult(rows, rewards, terminated, truncated)

    def would_collide(self, actions: ArrayLike) -> Flags:
        """Return which robots would collide in a step with these actions, (worlds, robots).

        The state does not change: the step is made in a copy.

        Raises:
            ValueError: wrong shape, or a number that is not finite, with its index.
        """
        self._check_begun("would_collide")
        return self._core.would_collide(actions, self.settings.threads)

    def safe_actions(self, actions: ArrayLike, rest: ArrayLike) -> Floats:
        """Stop robots that would collide: replace their actions by `rest`, at which they stop.

        A robot that stops may be hit by those behind it, so the step is tested again until no
        other robot would collide. Both arrays are (worlds, robots, size).

        Raises:
            ValueError: wrong shape, or a number that is not finite, with its index.
        """
        self._check_begun("safe_actions")
        return self._core.safe_actions(actions, rest, self.settings.threads)

    def place(self, world: int, robot: int, start: ArrayLike, goal: ArrayLike) -> None:
        """Begin a robot's episode, from a start to a goal, (nq,), without a collision check.

        The episode of a world that was over goes on, if nothing else has ended it.
        """
        self._check_begun("place")
        self._core.place(world, robot, start=start, goal=goal)
        self._update_over()

    def set_path(self, world: int, robot: int, path: ArrayLike) -> None:
        """Set a robot's path (K, nq): its mask follows from it, and so does the path hint."""
        self._check_begun("set_path")
        self._core.set_path(world, robot, path)

    def observe(self) -> Floats32:
        """Return the observations of the current state, (worlds, robots, size)."""
        self._check_begun("observe")
        return self._core.observe(self.settings.threads)

    def toward(self, targets: ArrayLike) -> Floats:
        """Return actions of the drives that lead straight to configurations (worlds, robots, nq).

        Robots slow down in time, and turn or steer as the drive requires. Obstacles are ignored.
        """
        self._check_begun("toward")
        return self._core.toward(targets)

    def sample(self, rng: np.random.Generator | None = None) -> Floats:
        """Return random actions, uniform in [-1, 1], (worlds, robots, size)."""
        shape = (self.n_worlds, self.n_robots, self.action_size)
        return (rng or np.random.default_rng()).uniform(-1.0, 1.0, shape)

    def _world_numbers(self, worlds: ArrayLike | None) -> NDArray[np.int64]:
        if worlds is None:
            return np.arange(self.n_worlds)
        which = np.asarray(worlds)
        if which.dtype == bool:
            if which.shape != (self.n_worlds,):
                raise ValueError(
                    f"worlds: got a mask of shape {which.shape}, expected ({self.n_worlds},)"
                )
            return np.flatnonzero(which)
        return np.atleast_1d(which) if which.size else np.empty(0, dtype=np.int64)

    # Copies

    def state(self) -> bytes:
        """Return the state of all episodes, for `set_state` of an equal simulator."""
        self._check_begun("state")
        return self._core.state()

    def set_state(self, state: bytes) -> None:
        """Continue from a state, bit for bit.

        Raises:
            ValueError: the state is of another simulator; call `reset` then.
        """
        self._begun = False
        self._core.set_state(state)
        self._begun = True
        self._update_over()

    def _update_over(self) -> None:
        self._over = (self.status != MOVING).all(axis=1) | (self.steps >= self.horizon)
        if self.scenario.on_collision == "terminate":
            self._over |= (self.hits >= 0).any(axis=1)
        self.changes += 1

    def __getstate__(self) -> dict[str, Any]:
        left_out = {"_core", "_like", *CACHED}
        kept = {name: value for name, value in self.__dict__.items() if name not in left_out}
        return {**kept, "state": self.state() if self._begun else None}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        state = kept.pop("state")
        self.__dict__.update(kept)
        over, final, changes = self._over, self.final_observations, self.changes
        self._make_core()
        if state is not None:
            self.set_state(state)
        self._over, self.final_observations, self.changes = over, final, changes

    def __deepcopy__(self, memo: dict[int, Any]) -> Simulator:
        other = object.__new__(type(self))
        kept = self.__getstate__()  # immutable members are shared
        kept["_over"] = kept["_over"].copy()
        kept["settings"] = replace(self.settings, reward=copy.deepcopy(self.reward, memo))
        other.__setstate__(kept)
        return other

    def __copy__(self) -> Simulator:
        return copy.deepcopy(self)

    def __repr__(self) -> str:
        return f"Simulator({self.scenario.name!r}: {self.n_worlds} worlds, {self.n_robots} robots)"


def world_seeds(seed: int | Sequence[int], n: int) -> NDArray[np.int64]:
    """Return one seed per world, from a first seed or a list of n seeds."""
    if isinstance(seed, (int, np.integer)):
        if not 0 <= seed <= 2**63 - n:
            raise ValueError(f"seed: got {seed}, expected 0 to 2^63 - {n}")
        return np.arange(n, dtype=np.int64) + np.int64(seed)
    seeds = np.asarray(seed)
    if seeds.shape != (n,) or seeds.dtype.kind not in "iu" or (seeds < 0).any():
        raise ValueError(f"seed: got {seed!r}, expected an integer, or {n} integers, 0 or more")
    return seeds.astype(np.int64)


def check_bounded(robots: Sequence[Robot]) -> None:
    """Raise ValueError if a coordinate has no limits to sample from."""
    for robot in robots:
        unbounded = ~(np.isfinite(robot.lower) & np.isfinite(robot.upper))
        if unbounded.any():
            name = robot.coordinates[int(unbounded.argmax())]
            raise ValueError(
                f"starts: got 'random' with {name!r} of {robot.name!r} unbounded, expected limits;"
                " give the scenario a workspace"
            )

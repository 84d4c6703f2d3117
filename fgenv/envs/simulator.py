"""The batched simulator: many worlds of one scenario, stepped at once in native code.

In a step every robot drives, all motions are proved free or brought to their first contact in the
order of time (`World.advance`), then goals, rewards and sensors follow. All faces (PettingZoo,
Gymnasium, Stable-Baselines3) are views of this class.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv import _core
from fgenv.arrays import Flags, Floats, Floats32
from fgenv.robots import Robot
from fgenv.scenarios import Built, FrozenSet, Scenario

from . import native_config
from .cases import Cases, scenario_of
from .global_planner import Guide
from .observations import Observation
from .rewards import TERMS, Reward
from .state_readers import MOVING, PARKED, Readings

Source = str | Path | Scenario | FrozenSet

MOST_WORLDS = 1_000_000


class Step(NamedTuple):
    """What a step gives."""

    observations: Floats32  # (worlds, robots, size)
    rewards: Floats  # (worlds, robots)
    terminated: Flags  # (worlds,): all have arrived, or one that had to stop it met something
    truncated: Flags  # (worlds,): the horizon is reached


class Simulator(Readings):
    """Worlds of one scenario, stepped at once.

    Arrays are over (worlds, robots, ...); where robots differ, rows are as wide as the widest and
    end in zeros.

    An action is in [-1, 1] (beyond is clipped): of the drive, the middle and half width of its
    limits; with `actions="way_points"`, a way point: x, y (z) and yaw of the base in its own frame,
    as far as full speed gets in `way_point_seconds` and half a turn, then the joints. A way point
    sets the path's mask, and the drive goes there for one step.

    Random numbers depend on a world's seed and the number of its episode alone. Results are the
    same bits for any number of threads and any instruction set.

    Args:
        scenario: a name, a file, a Scenario, or a FrozenSet, each episode being one of its cases.
        worlds: how many.
        observation, reward: see there.
        actions: `drive` or `way_points`.
        starts: `scenario`, or `random`: for each episode starts and goals uniform in the workspace
            (a free base level), where nobody meets anybody; the scenario's own where no room is
            found.
        cases: of a built-in scenario: that many, each with a seed of its own, as `frozen` has them.
        case_order: which case an episode is, where there are several: `random`, or `seed`: that of
            the number seed + episode, round and round.
        clearance: measure each robot's distance to whatever is nearest after each step.
        tolerance: meters that a robot may stop before what it meets; less costs more.
        autoreset: a world that ends begins anew in the same step; what its robots observed at the
            end is in `final_observations`. Else stepping after the end is an error.
        max_steps: of an episode, in place of the scenario's horizon.
        threads: None: FGENV_THREADS, else all cores.
        overrides: for `Scenario.load`.

    Raises:
        ScenarioError, ValueError, TypeError: saying what does not fit, and the remedy.
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
        chosen(actions, "actions", ("drive", "way_points"))
        chosen(starts, "starts", ("scenario", "random"))
        chosen(case_order, "case_order", ("random", "seed"))
        if (
            isinstance(worlds, bool)
            or not isinstance(worlds, int)
            or not 1 <= worlds <= MOST_WORLDS
        ):
            raise ValueError(f"worlds: got {worlds!r}, expected 1 to {MOST_WORLDS}")
        whole = isinstance(max_steps, int) and not isinstance(max_steps, bool)
        if max_steps is not None and not (whole and 1 <= max_steps < 2**62):
            raise ValueError(
                f"max_steps: got {max_steps!r}, expected a whole number over 0, or None"
            )
        number = isinstance(way_point_seconds, (int, float))
        if not number or not 0 < way_point_seconds <= 1e3:
            raise ValueError(
                f"way_point_seconds: got {way_point_seconds!r}, expected over 0, to 1000"
            )
        if not 1e-9 <= tolerance <= 0.1:
            raise ValueError(f"tolerance: got {tolerance!r}, expected meters, 1e-9 to 0.1")
        self.scenario, several = scenario_of(scenario, cases, overrides)
        if not self.scenario.robots:
            raise ValueError(
                f"scenario: {self.scenario.name!r} has no robots, expected one at least"
            )
        self.observation: Observation = given(observation, "observation", Observation)
        self.reward: Reward = given(reward, "reward", Reward)
        self.actions, self.starts, self.way_point_seconds = actions, starts, way_point_seconds
        self.case_order, self.clearance, self.tolerance = case_order, clearance, tolerance
        self.autoreset, self.threads = autoreset, threads
        self.n_worlds, self.max_steps = worlds, max_steps
        self.built: Built = self.scenario.build()
        self.cases = Cases.of(self.built, several)
        if starts == "random":
            bounded(self.robots)
        if self.observation.path == "shortest" and actions == "way_points":
            raise ValueError("path: 'shortest' and way_points: each way point is a path of its own")
        self._begin()

    def _begin(self) -> None:
        """The native simulator, not yet reset."""
        self._like = self.built.world()
        bodies, poses = native_config.standing(self._like, self.built, self.cases)
        self._core = _core.Simulator(
            self._like._core,
            native_config.agents(self._like, self.built, self.cases, self.observation),
            self._settings,
            worlds=self.n_worlds,
            bodies=bodies,
            poses=poses,
        )
        guided = self.observation.path_hint and self.observation.path == "shortest"
        self._guide = Guide(self) if guided else None
        self.final_observations: Floats32 | None = None
        self._begun = False
        self._over = np.zeros(self.n_worlds, dtype=bool)

    @property
    def _settings(self) -> dict[str, Any]:
        scenario, seen = self.scenario, self.observation
        return {
            "dt": scenario.time_step,
            "horizon": self.horizon,
            "response": scenario.on_collision,
            "vanish": scenario.at_goal == "vanish",
            "way_points": self.actions == "way_points",
            "way_point_seconds": float(self.way_point_seconds),
            "random": self.starts == "random",
            "in_order": self.case_order == "seed",
            "clearance": bool(self.clearance),
            "near": float(self.reward.near),
            "tolerance": float(self.tolerance),
            "goal": seen.goal,
            "velocity": seen.velocity,
            "configuration": seen.configuration,
            "path_hint": seen.path_hint,
            "lidar": seen.lidar,
            "neighbors": seen.neighbors if seen.pad else min(seen.neighbors, self.n_robots - 1),
            "intent": seen.intent,
            "priority": seen.priority,
            "neighbor_range": float(seen.neighbor_range or 0.0),
            "look_ahead": float(seen.look_ahead),
            **dict.fromkeys(TERMS, 0.0),
            **{name: float(weight) for name, weight in self.reward.weights.items()},
        }

    # Stepping

    def reset(
        self,
        seed: int | Sequence[int] | None = None,
        worlds: ArrayLike | None = None,
    ) -> Floats32:
        """Begin episodes; returns observations, (worlds, robots, size).

        Args:
            seed: world k of those reset gets seed + k, or seed[k], and its first episode begins;
                None: the next episode of the seeds there are (at first, those of seed 0).
            worlds: numbers of worlds, or a mask (worlds,); all if left out. Observations are of
                these alone.
        """
        which = self._worlds(worlds)
        seeds = None if seed is None else seeds_of(seed, len(which))
        if not self._begun and len(which) < self.n_worlds:
            self._core.reset(None, None, self.threads)
        self._core.reset(which, seeds, self.threads)
        self._begun = True
        self._over[which] = False
        self._guided(which.tolist())
        return self._core.observe(which, self.threads)

    def step(self, actions: ArrayLike) -> Step:
        """Step all worlds with actions (worlds, robots, size).

        Raises:
            ValueError: wrong shape, or a number that is not finite, by its place.
            RuntimeError: before the first reset, or after the end without autoreset. Nothing
                has changed then.
        """
        self._ready("step")
        if not self.autoreset and self._over.any():
            over = int(self._over.argmax())
            raise RuntimeError(f"step: the episode of world {over} is over, call reset()")
        rows, rewards, there, terminated, truncated = self._core.step(actions, self.threads)
        if self.reward.own:
            own = self.reward.of_own_terms(self)
            arrived_before = there & (self.arrival_steps < self.steps[:, None])
            rewards = rewards + np.where(arrived_before, 0.0, own)
        self._over = terminated | truncated
        self._guide_around_parked(rows)
        self.final_observations = None
        if self.autoreset and self._over.any():
            self.final_observations = rows.copy()
            ended = np.flatnonzero(self._over)
            rows[ended] = self.reset(worlds=ended)
        return Step(rows, rewards, terminated, truncated)

    def place(self, world: int, robot: int, start: ArrayLike, goal: ArrayLike) -> None:
        """Begin a robot's episode anew, from a start to a goal, (nq,); nobody asks who is there."""
        self._ready("place")
        self._core.place(world, robot, start=start, goal=goal)
        self._guided([world])

    def _guided(self, worlds: Iterable[int]) -> None:
        """Paths of who is on the way from where it is, where they are not straight."""
        if self._guide is None:
            return
        for world in worlds:
            for robot, path in self._guide.paths(world).items():
                self._core.set_path(world, robot, path)

    def _guide_around_parked(self, rows: Floats32) -> None:
        """Where somebody parked in this step others have new paths from here."""
        if self._guide is None:
            return
        parked = (self.status == PARKED) & (self.arrival_steps == self.steps[:, None])
        which = np.flatnonzero(parked.any(axis=1) & ~self._over)
        if len(which):
            self._guided(which.tolist())
            rows[which] = self._core.observe(which, self.threads)

    def set_path(self, world: int, robot: int, path: ArrayLike) -> None:
        """Give a robot a path (K, nq): its mask is set, and the path hint follows it."""
        self._ready("set_path")
        self._core.set_path(world, robot, path)

    def observe(self) -> Floats32:
        """Observations as they are, (worlds, robots, size)."""
        self._ready("observe")
        return self._core.observe(None, self.threads)

    def toward(self, targets: ArrayLike) -> Floats:
        """Actions of the drives that lead to configurations (worlds, robots, nq), straight.

        They slow down in time, turn or steer as the drive has to, and look at no obstacle.
        """
        self._ready("toward")
        return self._core.toward(targets)

    def sample(self, rng: np.random.Generator | None = None) -> Floats:
        """Random actions, uniform in [-1, 1], (worlds, robots, size)."""
        shape = (self.n_worlds, self.n_robots, self.action_size)
        return (rng or np.random.default_rng()).uniform(-1.0, 1.0, shape)

    def _worlds(self, worlds: ArrayLike | None) -> NDArray[np.int64]:
        if worlds is None:
            return np.arange(self.n_worlds)
        which = np.asarray(worlds)
        if which.dtype == bool:
            if which.shape != (self.n_worlds,):
                raise ValueError(
                    f"worlds: a mask of shape {which.shape}, expected {self.n_worlds},"
                )
            return np.flatnonzero(which)
        return np.atleast_1d(which) if which.size else np.empty(0, dtype=np.int64)

    # Copies

    def state(self) -> bytes:
        """All that the further course depends on, for `set_state` of an equal simulator."""
        self._ready("state")
        return self._core.state()

    def set_state(self, state: bytes) -> None:
        """Go on from a state, bit for bit.

        Raises:
            ValueError: it is of another simulator; this one is then to be reset.
        """
        self._begun = False
        self._core.set_state(state)
        self._begun = True
        self._over = (self.status != MOVING).all(axis=1) | (self.steps >= self.horizon)
        if self.scenario.on_collision == "terminate":
            self._over |= (self.hits >= 0).any(axis=1)

    def __getstate__(self) -> dict[str, Any]:
        left_out = {"_core", "_like", "_guide", *CACHED}
        kept = {name: value for name, value in self.__dict__.items() if name not in left_out}
        return {**kept, "state": self.state() if self._begun else None}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        state = kept.pop("state")
        self.__dict__.update(kept)
        over, final = self._over, self.final_observations
        self._begin()
        if state is not None:
            self.set_state(state)
        self._over, self.final_observations = over, final

    def __deepcopy__(self, memo: dict[int, Any]) -> Simulator:
        other = object.__new__(type(self))
        kept = self.__getstate__()  # what never changes is shared
        kept["_over"] = kept["_over"].copy()
        kept["reward"] = copy.deepcopy(kept["reward"], memo)
        other.__setstate__(kept)
        return other

    def __copy__(self) -> Simulator:
        return copy.deepcopy(self)

    def __repr__(self) -> str:
        return f"Simulator({self.scenario.name!r}: {self.n_worlds} worlds, {self.n_robots} robots)"


CACHED = ("names", "action_sizes", "layouts", "observation_sizes", "body_names")


def chosen(value: str, name: str, known: tuple[str, ...]) -> None:
    """ValueError where a word is none of those known."""
    if value not in known:
        raise ValueError(f"{name}: got {value!r}, expected {' or '.join(known)}")


def given(value: Any, name: str, kind: type[Any]) -> Any:
    """The value, or the default one of its kind; TypeError where it is of another kind."""
    if value is not None and not isinstance(value, kind):
        raise TypeError(f"{name}: got {value!r}, expected fgenv.envs.{kind.__name__}")
    return kind() if value is None else value


def seeds_of(seed: int | Sequence[int], n: int) -> NDArray[np.int64]:
    """One seed a world."""
    if isinstance(seed, (int, np.integer)):
        if not 0 <= seed < 2**63 - n:
            raise ValueError(f"seed: got {seed}, expected 0 to 2^63 - 1")
        return np.arange(n, dtype=np.int64) + np.int64(seed)
    seeds = np.asarray(seed)
    if seeds.shape != (n,) or seeds.dtype.kind not in "iu" or (seeds < 0).any():
        raise ValueError(f"seed: got {seed!r}, expected a number, or {n}, 0 or more")
    return seeds.astype(np.int64)


def bounded(robots: Sequence[Robot]) -> None:
    """ValueError where a robot has no limits to draw a configuration from."""
    for robot in robots:
        open_ = ~(np.isfinite(robot.lower) & np.isfinite(robot.upper))
        if open_.any():
            name = robot.coordinates[int(open_.argmax())]
            raise ValueError(
                f"starts: {name!r} of {robot.name!r} has no limits to draw from, give the scenario"
                " a workspace"
            )

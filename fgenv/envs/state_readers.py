"""The state of a simulator: names, sizes, and arrays over its worlds and robots."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fgenv import _core
from fgenv.arrays import Flags, Floats
from fgenv.collision import World
from fgenv.robots import Action, Robot
from fgenv.scenarios import Built, Scenario

from .cases import Cases
from .observations import Observation, Part, observation_parts
from .rewards import Reward
from .simulator_settings import SimulatorSettings

MOVING, PARKED, GONE = 0, 1, 2  # values of `status`
CACHED = ("names", "action_sizes", "layouts", "observation_sizes", "body_names")


class Collision(NamedTuple):
    """A collision of a moving robot in a step; a resting robot that is hit has none."""

    robot: str
    other: str  # name of the robot or body
    with_robot: bool
    time: float  # seconds in the step
    point: Floats  # (3,), world frame, meters


class SimulatorState:
    """Read access to a simulator. Arrays are copies, (worlds, robots, ...) or (worlds,)."""

    scenario: Scenario
    built: Built
    cases: Cases
    settings: SimulatorSettings
    _core: _core.Simulator
    _like: World
    _begun: bool
    _over: Flags

    def _check_begun(self, method: str) -> None:
        """Raise RuntimeError before the first reset."""
        if not self._begun:
            raise RuntimeError(f"{method}: before the first reset, call reset()")

    def _check_world(self, world: int) -> None:
        """Raise ValueError if there is no such world."""
        if not 0 <= world < self.n_worlds:
            raise ValueError(f"world: got {world}, expected 0 to {self.n_worlds - 1}")

    # Settings

    @property
    def n_worlds(self) -> int:
        """Number of worlds."""
        return self.settings.n_worlds

    @property
    def observation(self) -> Observation:
        """The parts of observations."""
        return self.settings.observation

    @property
    def reward(self) -> Reward:
        """The terms of rewards."""
        return self.settings.reward

    @property
    def actions(self) -> str:
        """Kind of actions: `drive` or `way_points`."""
        return self.settings.actions

    @property
    def autoreset(self) -> bool:
        """Whether episodes begin anew in the step in which one ends."""
        return self.settings.autoreset

    @property
    def robots(self) -> tuple[Robot, ...]:
        """The robots, with drives, limits and shapes."""
        return self.built.robots

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the robots."""
        return tuple(robot.name for robot in self.robots)

    @property
    def n_robots(self) -> int:
        """Number of robots per world."""
        return len(self.built.robots)

    @property
    def dt(self) -> float:
        """Seconds per step."""
        return self.scenario.time_step

    @property
    def horizon(self) -> int:
        """Maximum number of steps of an episode."""
        if self.settings.max_steps is not None:
            return self.settings.max_steps
        return max(1, round(self.scenario.horizon / self.scenario.time_step))

    @cached_property
    def action_sizes(self) -> tuple[int, ...]:
        """Sizes of the robots' actions."""
        return tuple(self._core.action_sizes())

    @property
    def action_size(self) -> int:
        """The largest of `action_sizes`."""
        return max(self.action_sizes)

    @cached_property
    def layouts(self) -> tuple[tuple[Part, ...], ...]:
        """The parts of each robot's row of observations: name, slice, unit, frame, about."""
        slices = [self._core.slices(i) for i in range(self.n_robots)]
        return tuple(observation_parts(s, r) for s, r in zip(slices, self.robots, strict=True))

    @cached_property
    def observation_sizes(self) -> tuple[int, ...]:
        """Sizes of the robots' observations."""
        return tuple(max((p.slice.stop for p in parts), default=0) for parts in self.layouts)

    @property
    def observation_size(self) -> int:
        """The largest of `observation_sizes`."""
        return max(self.observation_sizes)

    def action_names(self, robot: int) -> tuple[Action, ...]:
        """Return names, units and limits of the numbers of a robot's drive."""
        return self.robots[robot].actions

    # Current state

    @property
    def begun(self) -> bool:
        """Whether the simulator has been reset; before, there is no state."""
        return self._begun

    @property
    def over(self) -> Flags:
        """Whether the episode of each world is over, (worlds,)."""
        return self._over.copy()

    @property
    def configurations(self) -> Floats:
        """Configurations, (worlds, robots, nq)."""
        return self._core.configurations()

    @property
    def goals(self) -> Floats:
        """Goal configurations, (worlds, robots, nq)."""
        return self._core.goals()

    @property
    def velocities(self) -> Floats:
        """Velocities of the drives in their units, (worlds, robots, numbers)."""
        return self._core.velocities()

    @property
    def status(self) -> NDArray[np.uint8]:
        """MOVING, PARKED or GONE."""
        return self._core.status()

    @property
    def steps(self) -> NDArray[np.int64]:
        """Steps of the episode so far, (worlds,)."""
        return self._core.steps()

    @property
    def episodes(self) -> NDArray[np.int64]:
        """Number of the episode since the seed was set, (worlds,)."""
        return self._core.numbers()

    @property
    def seeds(self) -> NDArray[np.int64]:
        """Seeds, (worlds,)."""
        return self._core.seeds()

    @property
    def case_numbers(self) -> NDArray[np.int64]:
        """Index in `cases` of the episode, (worlds,)."""
        return self._core.cases()

    @property
    def remaining(self) -> Floats:
        """Distances to the goals: meters; for a fixed base, radians of all joints together."""
        return self._core.remaining()

    def path(self, world: int, robot: int) -> Floats:
        """Return the path that a robot's path hint follows, (K, nq)."""
        self._check_begun("path")
        return self._core.path(world, robot)

    # Last step

    @property
    def hits(self) -> NDArray[np.int32]:
        """Id of the body that each robot hit, -1: none; see `collisions`."""
        return self._core.hits()

    @property
    def hit_robots(self) -> NDArray[np.int32]:
        """Index of the robot that each robot hit, -1: none."""
        return self._core.hit_robots()

    @property
    def hit_times(self) -> Floats:
        """Times of the hits, seconds in the step."""
        return self._core.hit_times()

    @property
    def hit_points(self) -> Floats:
        """Contact points, (worlds, robots, 3), world frame, meters; 0 without a hit."""
        return self._core.hit_points()

    @property
    def checks(self) -> NDArray[np.int64]:
        """Number of pairs of bodies tested."""
        return self._core.checks()

    @property
    def masked(self) -> NDArray[np.int32]:
        """Number of bodies that remain after the mask of the motion."""
        return self._core.masked()

    @property
    def clearances(self) -> Floats:
        """Distances to the nearest bodies, meters; infinite if not measured."""
        return self._core.clearances()

    def collisions(self, world: int = 0) -> list[Collision]:
        """Return the collisions in the last step of a world."""
        self._check_world(world)
        hits, robots = self.hits[world], self.hit_robots[world]
        times, points = self.hit_times[world], self.hit_points[world]
        return [
            Collision(
                self.names[i],
                self.names[robots[i]] if robots[i] >= 0 else self.body_names[int(hits[i])],
                bool(robots[i] >= 0),
                float(times[i]),
                points[i],
            )
            for i in np.flatnonzero(hits >= 0).tolist()
        ]

    # Episode

    @property
    def collision_counts(self) -> NDArray[np.int64]:
        """Number of steps in which each robot collided."""
        return self._core.collisions()

    @property
    def arrival_steps(self) -> NDArray[np.int64]:
        """Step in which each robot arrived, -1: not yet."""
        return self._core.arrivals()

    @property
    def traveled(self) -> Floats:
        """Distance that each base traveled, meters; for a fixed base, radians of all joints."""
        return self._core.traveled()

    @property
    def least_clearances(self) -> Floats:
        """The smallest of `clearances`."""
        return self._core.least_clearances()

    def static_poses(self, world: int) -> Floats:
        """Return the poses of the static bodies in a world, (m, 4, 4)."""
        poses = self.built.poses
        if self.cases.poses is not None:
            poses = poses.copy()
            poses[list(self.cases.bodies)] = self.cases.poses[int(self.case_numbers[world])]
        return poses

    def world(self, world: int = 0) -> World:
        """Return a copy of a world: a `World` with all bodies at their current poses."""
        self._check_world(world)
        self._check_begun("world")
        made = self._like.copy()
        if self.cases.bodies:
            made.set_pose(list(self.built.names), self.static_poses(world))
        q, status = self.configurations[world], self.status[world]
        for i, robot in enumerate(self.robots):
            if status[i] == GONE:
                made.remove(robot.name)
            else:
                made.set_configuration(robot.name, q[i, : robot.nq])
        return made

    @cached_property
    def body_names(self) -> dict[int, str]:
        """Names of bodies and of robots' parts, by id."""
        return dict(zip(self._like.ids.tolist(), self._like.names, strict=True))

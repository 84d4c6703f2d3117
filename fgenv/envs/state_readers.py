"""What a simulator is and how it stands: names, sizes, and arrays over its worlds and robots."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.robots import Action, Robot
from fgenv.scenarios import Built, Scenario

from .cases import Cases
from .observations import Part, parts_of

MOVING, PARKED, GONE = 0, 1, 2  # of `status`


class Collision(NamedTuple):
    """A robot that met something in a step; one that was met at rest has none of its own."""

    robot: str
    other: str  # name of the robot or body
    with_robot: bool
    time: float  # seconds in the step
    point: Floats  # (3,), world, meters


class Readings:
    """What is read from a simulator; arrays are copies, (worlds, robots, ...) or (worlds,)."""

    scenario: Scenario
    built: Built
    cases: Cases
    n_worlds: int
    max_steps: int | None
    _core: _core.Simulator
    _like: World
    _begun: bool

    def _ready(self, what: str) -> None:
        """RuntimeError before the first reset."""
        if not self._begun:
            raise RuntimeError(f"{what}: before the first reset, call reset()")

    def _has(self, world: int) -> None:
        """ValueError where there is no such world."""
        if not 0 <= world < self.n_worlds:
            raise ValueError(f"world: got {world}, expected 0 to {self.n_worlds - 1}")

    @property
    def robots(self) -> tuple[Robot, ...]:
        """With drive, limits and shapes."""
        return self.built.robots

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of the robots."""
        return tuple(robot.name for robot in self.robots)

    @property
    def n_robots(self) -> int:
        """In each world."""
        return len(self.built.robots)

    @property
    def dt(self) -> float:
        """Seconds of a step."""
        return self.scenario.time_step

    @property
    def horizon(self) -> int:
        """Steps of an episode at most."""
        if self.max_steps is not None:
            return self.max_steps
        return max(1, round(self.scenario.horizon / self.scenario.time_step))

    @cached_property
    def action_sizes(self) -> tuple[int, ...]:
        """Numbers of each robot's action."""
        return tuple(self._core.action_sizes())

    @property
    def action_size(self) -> int:
        """The greatest of `action_sizes`."""
        return max(self.action_sizes)

    @cached_property
    def layouts(self) -> tuple[tuple[Part, ...], ...]:
        """The parts of each robot's row of observations: name, slice, unit, frame, about."""
        slices = [self._core.slices(i) for i in range(self.n_robots)]
        return tuple(parts_of(s, robot) for s, robot in zip(slices, self.robots, strict=True))

    @cached_property
    def observation_sizes(self) -> tuple[int, ...]:
        """Numbers of each robot's observation."""
        return tuple(max((p.slice.stop for p in parts), default=0) for parts in self.layouts)

    @property
    def observation_size(self) -> int:
        """The greatest of `observation_sizes`."""
        return max(self.observation_sizes)

    def action_names(self, robot: int) -> tuple[Action, ...]:
        """What the numbers of a robot's drive are, with units and limits."""
        return self.robots[robot].actions

    @property
    def begun(self) -> bool:
        """Whether it has been reset; before that there is no state."""
        return self._begun

    # How it stands

    @property
    def configurations(self) -> Floats:
        """(worlds, robots, nq)."""
        return self._core.configurations()

    @property
    def goals(self) -> Floats:
        """(worlds, robots, nq)."""
        return self._core.goals()

    @property
    def velocities(self) -> Floats:
        """What the drives do, in their units, (worlds, robots, numbers)."""
        return self._core.velocities()

    @property
    def status(self) -> NDArray[np.uint8]:
        """MOVING, PARKED or GONE."""
        return self._core.status()

    @property
    def steps(self) -> NDArray[np.int64]:
        """Of the episode, (worlds,)."""
        return self._core.steps()

    @property
    def episodes(self) -> NDArray[np.int64]:
        """Number of the episode since the seed was given, (worlds,)."""
        return self._core.numbers()

    @property
    def seeds(self) -> NDArray[np.int64]:
        """(worlds,)."""
        return self._core.seeds()

    @property
    def case_numbers(self) -> NDArray[np.int64]:
        """Which of `cases` the episode is, (worlds,)."""
        return self._core.cases()

    @property
    def remaining(self) -> Floats:
        """To the goal: meters, of a fixed base radians of all joints together."""
        return self._core.remaining()

    # Of the last step

    @property
    def hits(self) -> NDArray[np.int32]:
        """Id of the body that each robot met, -1: none; see `collisions`."""
        return self._core.hits()

    @property
    def hit_robots(self) -> NDArray[np.int32]:
        """Place of the robot that each robot met, -1: none."""
        return self._core.hit_robots()

    @property
    def hit_times(self) -> Floats:
        """Seconds in the step."""
        return self._core.hit_times()

    @property
    def hit_points(self) -> Floats:
        """(worlds, robots, 3), world, meters; 0 where there is none."""
        return self._core.hit_points()

    @property
    def checks(self) -> NDArray[np.int64]:
        """Pairs of bodies looked at."""
        return self._core.checks()

    @property
    def masked(self) -> NDArray[np.int32]:
        """Bodies that the motion's mask left."""
        return self._core.masked()

    @property
    def clearances(self) -> Floats:
        """Meters to what is nearest; infinite where not measured."""
        return self._core.clearances()

    def collisions(self, world: int = 0) -> list[Collision]:
        """Who met whom in the last step of a world."""
        self._has(world)
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

    # Of the episode

    @property
    def collision_counts(self) -> NDArray[np.int64]:
        """Steps in which each robot met something."""
        return self._core.collisions()

    @property
    def arrival_steps(self) -> NDArray[np.int64]:
        """The step in which each robot arrived, -1: not yet."""
        return self._core.arrivals()

    @property
    def traveled(self) -> Floats:
        """Meters that each base went; of a fixed base, radians of all joints together."""
        return self._core.traveled()

    @property
    def least_clearances(self) -> Floats:
        """The least of `clearances`."""
        return self._core.least_clearances()

    def standing_poses(self, world: int) -> Floats:
        """Of the static bodies in a world, (m, 4, 4)."""
        poses = self.built.poses
        if self.cases.poses is not None:
            poses = poses.copy()
            poses[list(self.cases.stands)] = self.cases.poses[int(self.case_numbers[world])]
        return poses

    def world(self, world: int = 0) -> World:
        """A `World` with everything where it is now; it goes its own way from there."""
        self._has(world)
        self._ready("world")
        made = self._like.copy()
        if self.cases.stands:
            made.set_pose(list(self.built.names), self.standing_poses(world))
        q, status = self.configurations[world], self.status[world]
        for i, robot in enumerate(self.robots):
            if status[i] == GONE:
                made.remove(robot.name)
            else:
                made.set_configuration(robot.name, q[i, : robot.nq])
        return made

    @cached_property
    def body_names(self) -> dict[int, str]:
        """Names of bodies, and of robots' parts, by id."""
        return dict(zip(self._like.ids.tolist(), self._like.names, strict=True))

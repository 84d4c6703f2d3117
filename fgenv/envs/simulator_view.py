"""What a policy sees of a simulator beside its observations: it looks, and changes nothing."""

from __future__ import annotations

import copy
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.collision import World
from fgenv.robots import Robot

from .native_config import directions, lidar_of
from .observations import Part
from .rewards import Reward
from .simulator import Simulator
from .state_readers import GONE, MOVING
from .waypoints import way_points_toward

if TYPE_CHECKING:
    from fgenv.arrays import Flags, Floats


class View:
    """A simulator, read-only. Arrays are copies; rows are as wide as the widest and end in zeros.

    It follows the simulator: what it says is of now, not of when it was made.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    @property
    def n_worlds(self) -> int:
        """How many are stepped at once."""
        return self._simulator.n_worlds

    @property
    def n_robots(self) -> int:
        """In each world."""
        return self._simulator.n_robots

    @property
    def robots(self) -> tuple[Robot, ...]:
        """With drive, limits and shapes; immutable."""
        return self._simulator.robots

    @property
    def names(self) -> tuple[str, ...]:
        """Of the robots."""
        return self._simulator.names

    @property
    def dt(self) -> float:
        """Seconds of a step."""
        return self._simulator.dt

    @property
    def horizon(self) -> int:
        """Steps of an episode at most."""
        return self._simulator.horizon

    @property
    def steps(self) -> NDArray[np.int64]:
        """Of the episode so far, (worlds,)."""
        return self._simulator.steps

    @property
    def configurations(self) -> Floats:
        """(worlds, robots, nq)."""
        return self._simulator.configurations

    @property
    def goals(self) -> Floats:
        """(worlds, robots, nq)."""
        return self._simulator.goals

    @property
    def velocities(self) -> Floats:
        """What the drives do, in their units, (worlds, robots, numbers); see `Robot.actions`."""
        return self._simulator.velocities

    @property
    def remaining(self) -> Floats:
        """To the goals, (worlds, robots): meters; of a fixed base radians of all joints."""
        return self._simulator.remaining

    @property
    def moving(self) -> Flags:
        """Who is still on the way, (worlds, robots): not parked at its goal, and not gone."""
        return np.asarray(self._simulator.status == MOVING)

    @property
    def present(self) -> Flags:
        """Who is there, (worlds, robots): on the way or parked, not gone."""
        return np.asarray(self._simulator.status != GONE)

    @property
    def actions(self) -> str:
        """What actions are: `drive` or `way_points`."""
        return self._simulator.actions

    @property
    def action_size(self) -> int:
        """Numbers of the longest action."""
        return self._simulator.action_size

    @property
    def layouts(self) -> tuple[tuple[Part, ...], ...]:
        """The parts of each robot's row of observations: name, slice, unit, frame, about."""
        return self._simulator.layouts

    def rays(self, robot: int) -> tuple[Floats, Floats, float]:
        """A robot's lidar, base's frame: its place (3,), unit vectors (rays, 3), and range (m)."""
        spec, built = self._simulator.scenario.robots[robot], self._simulator.built
        lidar = lidar_of(built.scenario.models[spec.model].lidar, self._simulator.observation)
        if lidar is None:
            return np.zeros(3), np.empty((0, 3)), 0.0
        return np.array(lidar.position), directions(lidar), lidar.range

    def toward(self, targets: ArrayLike) -> Floats:
        """Actions that lead straight to configurations (worlds, robots, nq); looks at no obstacle.

        (worlds, robots, action_size), whichever kind of actions the simulator takes.

        Raises:
            ValueError: wrong shape, or a number that is not finite.
        """
        if self._simulator.actions == "way_points":
            return way_points_toward(self._simulator, targets)
        return self._simulator.toward(targets)

    def meet(self, actions: ArrayLike) -> Flags:
        """Who would run into something in a step with these actions, (worlds, robots).

        Nothing moves: the step is made in a copy.

        Raises:
            ValueError: wrong shape, or a number that is not finite.
        """
        self._ahead.set_state(self._simulator.state())
        self._ahead.step(actions)
        return np.asarray(self._ahead.hits >= 0)

    @cached_property
    def _ahead(self) -> Simulator:
        """A copy to look ahead in."""
        made = copy.copy(self._simulator)
        made.autoreset, made.reward = False, Reward({})
        made._guide = None  # nobody looks at what it observes
        return made

    def world(self, k: int = 0) -> World:
        """A copy of a world with everything where it is now."""
        return self._simulator.world(k)

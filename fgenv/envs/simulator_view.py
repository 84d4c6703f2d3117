"""Read access to a simulator for policies, beside observations."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.arrays import Flags, Floats
from fgenv.collision import World
from fgenv.robots import Robot

from .native_config import directions, lidar_of
from .observations import Part
from .simulator import Simulator
from .state_readers import GONE, MOVING
from .waypoints import way_points_toward


class View:
    """A read-only simulator. Arrays are copies; rows are as wide as the widest and end in zeros.

    Values are those of the simulator's current state.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    @property
    def n_worlds(self) -> int:
        """Number of worlds."""
        return self._simulator.n_worlds

    @property
    def n_robots(self) -> int:
        """Number of robots per world."""
        return self._simulator.n_robots

    @property
    def robots(self) -> tuple[Robot, ...]:
        """The robots, with drives, limits and shapes; immutable."""
        return self._simulator.robots

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the robots."""
        return self._simulator.names

    @property
    def dt(self) -> float:
        """Seconds per step."""
        return self._simulator.dt

    @property
    def horizon(self) -> int:
        """Maximum number of steps of an episode."""
        return self._simulator.horizon

    @property
    def seeds(self) -> NDArray[np.int64]:
        """Seed of each world, (worlds,)."""
        return self._simulator.seeds

    @property
    def episodes(self) -> NDArray[np.int64]:
        """Number of each world's episode since its seed was given, (worlds,)."""
        return self._simulator.episodes

    @property
    def steps(self) -> NDArray[np.int64]:
        """Steps of the episode so far, (worlds,)."""
        return self._simulator.steps

    @property
    def configurations(self) -> Floats:
        """Configurations, (worlds, robots, nq)."""
        return self._simulator.configurations

    @property
    def goals(self) -> Floats:
        """Goal configurations, (worlds, robots, nq)."""
        return self._simulator.goals

    @property
    def velocities(self) -> Floats:
        """Velocities of the drives, (worlds, robots, numbers); units: see `Robot.actions`."""
        return self._simulator.velocities

    @property
    def remaining(self) -> Floats:
        """Distances to the goals, (worlds, robots): meters; for a fixed base, radians."""
        return self._simulator.remaining

    @property
    def moving(self) -> Flags:
        """Whether a robot still moves, (worlds, robots): it has neither parked nor vanished."""
        return np.asarray(self._simulator.status == MOVING)

    @property
    def present(self) -> Flags:
        """Whether a robot is there, (worlds, robots): it has not vanished at its goal."""
        return np.asarray(self._simulator.status != GONE)

    @property
    def actions(self) -> str:
        """Kind of actions: `drive` or `way_points`."""
        return self._simulator.actions

    @property
    def action_size(self) -> int:
        """Size of the longest action."""
        return self._simulator.action_size

    @property
    def layouts(self) -> tuple[tuple[Part, ...], ...]:
        """The parts of each robot's row of observations: name, slice, unit, frame, about."""
        return self._simulator.layouts

    def rays(self, robot: int) -> tuple[Floats, Floats, float]:
        """Return position (3,), unit vectors (rays, 3) and range (m) of a lidar, base frame."""
        spec, built = self._simulator.scenario.robots[robot], self._simulator.built
        lidar = lidar_of(built.scenario.models[spec.model].lidar, self._simulator.observation)
        if lidar is None:
            return np.zeros(3), np.empty((0, 3)), 0.0
        return np.array(lidar.position), directions(lidar), lidar.range

    def toward(self, targets: ArrayLike) -> Floats:
        """Return actions that lead straight to configurations (worlds, robots, nq).

        Obstacles are ignored.

        Returns:
            Actions (worlds, robots, action_size) of the kind that the simulator takes.

        Raises:
            ValueError: wrong shape, or a number that is not finite.
        """
        if self._simulator.actions == "way_points":
            return way_points_toward(self._simulator, targets)
        return self._simulator.toward(targets)

    def would_collide(self, actions: ArrayLike) -> Flags:
        """Return which robots would collide in a step with these actions, (worlds, robots).

        Raises:
            ValueError: wrong shape, or a number that is not finite.
        """
        return self._simulator.would_collide(actions)

    def safe_actions(self, actions: ArrayLike) -> Floats:
        """Stop the robots that would collide in a step with these actions; see `Simulator`.

        Returns:
            Actions (worlds, robots, action_size).

        Raises:
            ValueError: wrong shape, or a number that is not finite.
        """
        return self._simulator.safe_actions(actions, self.toward(self.configurations))

    def world(self, k: int = 0) -> World:
        """Return a copy of a world: a `World` with all bodies at their current poses."""
        return self._simulator.world(k)

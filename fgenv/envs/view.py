"""What a policy may see of a simulator."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.collision import World
from fgenv.robots import Robot

from .simulator import MOVING

if TYPE_CHECKING:
    from .simulator import Simulator

Floats = NDArray[np.float64]


class View:
    """Read-only: the robots, where they are and want to be, and copies of their worlds.

    Arrays are copies, over (worlds, robots, ...).
    """

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    @property
    def n_worlds(self) -> int:
        """How many."""
        return self._simulator.n_worlds

    @property
    def n_robots(self) -> int:
        """In each world."""
        return self._simulator.n_robots

    @property
    def robots(self) -> tuple[Robot, ...]:
        """With drive, limits and shapes."""
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
    def configurations(self) -> Floats:
        """(worlds, robots, nq)."""
        return self._simulator.configurations

    @property
    def velocities(self) -> Floats:
        """What the drives do, in their units, (worlds, robots, numbers)."""
        return self._simulator.velocities

    @property
    def goals(self) -> Floats:
        """(worlds, robots, nq)."""
        return self._simulator.goals

    @property
    def moving(self) -> NDArray[np.bool_]:
        """Who is on the way, (worlds, robots)."""
        return np.asarray(self._simulator.status == MOVING)

    @property
    def action_size(self) -> int:
        """Numbers of an action; where robots differ, the most."""
        return self._simulator.action_size

    def toward(self, targets: ArrayLike) -> Floats:
        """Actions of the drives that lead straight to configurations (worlds, robots, nq)."""
        return self._simulator.toward(targets)

    def world(self, world: int = 0) -> World:
        """A `World` with everything where it is now; it goes its own way from there."""
        return self._simulator.world(world)

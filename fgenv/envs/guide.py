"""The way a robot would go if it were alone: its path hint, where that is `shortest`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fgenv import _core
from fgenv.collision import World
from fgenv.robots import Robot
from fgenv.robots.limits import reaches

if TYPE_CHECKING:
    from .simulator import Simulator

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FINE = 1 / 3  # of the radius of a robot's circle: a cell's side
MOST = 200  # cells along a side of the workspace
YAWS = 4  # a cell is open if a body stands free in it at one of so many
NARROW, DEAR = 1 / 3, 2.0  # who has less room than that part of its radius pays so many times


class Guide:
    """Shortest paths of planar robots among what stands, one by one, over a grid of cells.

    Which cells are open the exact collision check tells, a cell's middle for all of it, so that a
    path is advice and no proof. Narrow cells are dear, so that paths keep off walls where they can.
    Paths and grids are kept: those of a case are found once.

    Args:
        simulator: that it is for.

    Raises:
        ValueError: a robot has no planar base, or no workspace.
    """

    def __init__(self, simulator: Simulator) -> None:
        for robot in simulator.robots:
            if robot.base != "planar" or robot.workspace is None:
                raise ValueError(
                    f"path: {robot.name!r} has no planar base, or no workspace; wanted 'straight'"
                )
        self._simulator = simulator
        self._grids: dict[tuple[int, int], tuple[Floats, Floats, float]] = {}
        self._paths: dict[bytes, Floats] = {}

    def path(self, world: int, i: int) -> Floats:
        """Of robot i from where it is to its goal, (k, 3): x, y, yaw.

        Straight where there is no way.
        """
        simulator = self._simulator
        case = int(simulator.case_numbers[world])
        start, goal = simulator.configurations[world, i, :3], simulator.goals[world, i, :3]
        key = b"%d %d " % (case, i) + start.tobytes() + goal.tobytes()
        if key not in self._paths:
            self._paths[key] = self._found(world, case, i, start, goal)
        return self._paths[key]

    def _found(self, world: int, case: int, i: int, start: Floats, goal: Floats) -> Floats:
        prices, low, side = self._grid(world, case, i)
        cells = [nearest_open(prices, (q[:2] - low) / side) for q in (start, goal)]
        way = _core.cheapest_way(prices, *cells)
        if len(way) < 3:
            return np.stack([start, goal])
        middles = low + side * turns_of(way)[1:-1]
        return headed(np.concatenate([start[None, :2], middles, goal[None, :2]]), start, goal)

    def _grid(self, world: int, case: int, i: int) -> tuple[Floats, Floats, float]:
        """Prices (nx, ny) of cells, the middle of the first, and their side; alike robots share."""
        models = [robot.model for robot in self._simulator.scenario.robots]
        key = case, models.index(models[i])
        if key not in self._grids:
            alone = self._simulator.built.world(robots=False)
            cases = self._simulator.cases
            if cases.stands:
                names = list(self._simulator.built.names)
                alone.set_pose(names, self._simulator.standing_poses(world))
            self._grids[key] = self._priced(alone, i)
        return self._grids[key]

    def _priced(self, alone: World, i: int) -> tuple[Floats, Floats, float]:
        robot = self._simulator.robots[i]
        room, radius = np.asarray(robot.workspace), radius_of(robot)
        side = max(FINE * radius, float(np.ptp(room, axis=0).max()) / MOST)
        counts = np.maximum(1, np.floor(np.ptp(room, axis=0) / side).astype(int))
        low = room[0] + 0.5 * (np.ptp(room, axis=0) - (counts - 1) * side)
        at = low + side * np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
        prices = np.full(counts, math.inf)
        me: Any = None
        for yaw in np.arange(YAWS) * (math.pi / YAWS):
            q = np.concatenate([at, np.full((*counts, 1), yaw)], axis=-1)
            me = self._simulator.built.add_robot(alone, i, q[0, 0]) if me is None else me
            free = ~np.asarray(alone.collides(me, q))
            roomy = ~np.asarray(alone.collides(me, q, margin=NARROW * radius))
            prices = np.minimum(prices, np.where(roomy, 1.0, np.where(free, DEAR, math.inf)))
        return prices, low, side


def radius_of(robot: Robot) -> float:
    """Metres from the base's origin that no point of a robot exceeds."""
    return float(reaches(robot)[robot.root])


def nearest_open(prices: Floats, at: Floats) -> Ints:
    """The open cell nearest to a place, in cells; the cell there if none is open."""
    cells = np.argwhere(np.isfinite(prices))
    if not len(cells):
        return np.clip(np.round(at).astype(np.int64), 0, np.array(prices.shape) - 1)
    found: Ints = cells[((cells - at) ** 2).sum(axis=1).argmin()]
    return found


def turns_of(way: Ints) -> Ints:
    """The cells of a way where it begins, turns and ends."""
    steps = np.diff(way, axis=0)
    turns = np.flatnonzero((steps[1:] != steps[:-1]).any(axis=1)) + 1
    kept: Ints = way[np.concatenate([[0], turns, [len(way) - 1]])]
    return kept


def headed(points: Floats, start: Floats, goal: Floats) -> Floats:
    """Points (k, 2) with yaws: each looks to the next, the ends as they are."""
    ahead = np.diff(points, axis=0)
    yaws = [_core.arc_tangent(float(y), float(x)) for x, y in ahead]
    return np.column_stack([points, [start[2], *yaws[1:], goal[2]]])

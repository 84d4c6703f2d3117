"""The way a robot would go if nobody else moved: its path hint, where that is `shortest`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fgenv import _core
from fgenv.collision import World
from fgenv.robots import Robot
from fgenv.robots.limits import reaches

from .readings import PARKED

if TYPE_CHECKING:
    from .simulator import Simulator

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FINE = 1 / 3  # of the radius of a robot's circle: a cell's side
MOST = 200  # cells along a side of the workspace
LONG = 1.5  # times as long as wide: who is has to turn with its path
HEADINGS = 8  # of who has to; others fit in a cell if they do at one of the first half of them
NARROW, DEAR = 1 / 3, 2.0  # who has less room than that part of half its width pays so many times


class Grid(NamedTuple):
    """Prices (layers, nx, ny) of cells, infinite: closed; the middle of the first, and their side.

    One layer, or one for each heading of who has to turn with its path.
    """

    prices: Floats
    low: Floats
    side: float

    def axis(self, k: int) -> Floats:
        """Where the cells' middles are on an axis, metres."""
        places: Floats = self.low[k] + self.side * np.arange(self.prices.shape[k + 1])
        return places


class Guide:
    """Shortest paths of planar robots among what stands and who has parked, over a grid of cells.

    Which cells are open the exact collision check tells, a cell's middle for all of it, so that a
    path is advice and no proof. Narrow cells are dear, so that paths keep off walls where they can.
    A parked robot is a disc as wide as the ball about its base that holds it: of low robots wider
    than they are, room that is needed to drive around them (in `random` on wheels the closest
    discs bring ORCA from 0.88 of episodes to 0.60). Grids are kept, and the paths of cases'
    beginnings.

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
        self._radii = [float(reaches(robot)[robot.root]) for robot in simulator.robots]
        self._grids: dict[tuple[int, int], Grid] = {}
        self._paths: dict[bytes, Floats] = {}

    def path(self, world: int, i: int) -> Floats:
        """Of robot i from where it is to its goal, (k, 3): x, y, yaw.

        Straight where there is no way at all; through parked robots where there is none around.
        """
        simulator = self._simulator
        case = int(simulator.case_numbers[world])
        start, goal = simulator.configurations[world, i, :3], simulator.goals[world, i, :3]
        parked = np.flatnonzero(simulator.status[world] == PARKED)
        grid = self._grid(world, case, i)
        if len(parked):
            around = found(self._around(world, i, parked, grid), start, goal)
            if around is not None:
                return around
        key = b"%d %d " % (case, i) + start.tobytes() + goal.tobytes()
        if key not in self._paths:
            way = found(grid, start, goal)
            self._paths[key] = np.stack([start, goal]) if way is None else way
        return self._paths[key]

    def _around(self, world: int, i: int, parked: Ints, grid: Grid) -> Grid:
        """The grid without what parked robots take of it."""
        prices, places = grid.prices.copy(), self._simulator.configurations[world, parked, :2]
        for j, place in zip(parked.tolist(), places, strict=True):
            x, y = (grid.axis(k) - place[k] for k in range(2))
            squared, apart = x[:, None] ** 2 + y**2, self._radii[i] + self._radii[j]
            near = squared < (apart + NARROW * self._radii[i]) ** 2
            prices[:, near] = np.maximum(prices[:, near], DEAR)
            prices[:, squared < apart**2] = math.inf
        return grid._replace(prices=prices)

    def _grid(self, world: int, case: int, i: int) -> Grid:
        """That of a robot in a case; alike robots share it."""
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

    def _priced(self, alone: World, i: int) -> Grid:
        robot, radius = self._simulator.robots[i], self._radii[i]
        room, margin = np.asarray(robot.workspace), NARROW * 0.5 * min(sides_of(robot))
        side = max(FINE * radius, float(np.ptp(room, axis=0).max()) / MOST)
        counts = np.maximum(1, np.floor(np.ptp(room, axis=0) / side).astype(int))
        low = room[0] + 0.5 * (np.ptp(room, axis=0) - (counts - 1) * side)
        grid = Grid(np.empty((HEADINGS, *counts)), low, side)
        at = np.stack(np.meshgrid(grid.axis(0), grid.axis(1), indexing="ij"), axis=-1)
        turns = is_long(robot)
        me: Any = None
        for k in range(HEADINGS if turns else HEADINGS // 2):
            yaw = np.full((*counts, 1), k * (2 * math.pi / HEADINGS))
            q = np.concatenate([at, yaw], axis=-1)
            me = self._simulator.built.add_robot(alone, i, q[0, 0]) if me is None else me
            free = ~np.asarray(alone.collides(me, q))
            roomy = ~np.asarray(alone.collides(me, q, margin=margin))
            grid.prices[k] = np.where(roomy, 1.0, np.where(free, DEAR, math.inf))
        if turns:
            return grid
        return grid._replace(prices=grid.prices[: HEADINGS // 2].min(axis=0, keepdims=True))


def found(grid: Grid, start: Floats, goal: Floats) -> Floats | None:
    """The cheapest path (k, 3) over a grid, None: there is none."""
    way = _core.cheapest_way(grid.prices, *(nearest_open(grid, q) for q in (start, goal)))
    if not len(way):
        return None
    middles = grid.low + grid.side * turns_of(way[:, 1:])[1:-1]
    return headed(np.concatenate([start[None, :2], middles, goal[None, :2]]), start, goal)


def sides_of(robot: Robot) -> Floats:
    """Length and width of a robot's root link in its own frame, metres, (2,)."""
    parts = robot.links[0].shapes
    points = [p.shape.vertices @ p.origin[:2, :3].T + p.origin[:2, 3] for p in parts]
    return np.ptp(np.concatenate(points), axis=0) if points else np.zeros(2)


def is_long(robot: Robot) -> bool:
    """Whether a robot has to look along its path to get through where it is narrow."""
    short, long = sorted(sides_of(robot))
    return bool(long > LONG * short)


def nearest_open(grid: Grid, q: Floats) -> Ints:
    """The open cell nearest to a configuration: layer, row, column; that there if none is open."""
    layers, *size = grid.prices.shape
    heading = q[2] * HEADINGS / (2 * math.pi) if layers > 1 else 0.0
    at = np.array([heading, *((q[:2] - grid.low) / grid.side)])
    cells = np.argwhere(np.isfinite(grid.prices))
    if not len(cells):
        return np.clip(np.round(at).astype(np.int64), 0, np.array([layers, *size]) - 1)
    by = cells - at
    by[:, 0] = np.remainder(by[:, 0] + HEADINGS / 2, HEADINGS) - HEADINGS / 2
    nearest: Ints = cells[(by**2).sum(axis=1).argmin()]
    return nearest


def turns_of(way: Ints) -> Ints:
    """The cells (k, 2) of a way where it begins, changes its direction and ends."""
    way = way[np.concatenate([[True], (np.diff(way, axis=0) != 0).any(axis=1)])]
    steps = np.diff(way, axis=0)
    turns = np.flatnonzero((steps[1:] != steps[:-1]).any(axis=1)) + 1
    kept: Ints = way[np.concatenate([[0], turns, [len(way) - 1]])]
    return kept


def headed(points: Floats, start: Floats, goal: Floats) -> Floats:
    """Points (k, 2) with yaws: each looks to the next, the ends as they are."""
    ahead = np.diff(points, axis=0)
    yaws = [_core.arc_tangent(float(y), float(x)) for x, y in ahead]
    return np.column_stack([points, [start[2], *yaws[1:], goal[2]]])

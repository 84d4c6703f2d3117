"""The way a robot would go if nobody else moved: its path hint, where that is `shortest`."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats, Ints
from fgenv.collision import World
from fgenv.robots.footprint import enclosing_discs, enclosing_radius, footprint_size, is_elongated

from .state_readers import MOVING, PARKED

if TYPE_CHECKING:
    from .simulator import Simulator


FINE = 1 / 3  # of the radius of a robot's circle: a cell's side
MOST = 200  # cells along a side of the workspace
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
        """Where the cells' middles are on an axis, meters."""
        places: Floats = self.low[k] + self.side * np.arange(self.prices.shape[k + 1])
        return places


class Way(NamedTuple):
    """A path (k, 3), and the grid that it was found on."""

    grid: Grid
    path: Floats


class Guide:
    """Shortest paths of planar robots among what stands and who has parked, over a grid of cells.

    Which cells are open the exact collision check tells, a cell's middle for all of it, so that a
    path is advice and no proof. Narrow cells are dear, so that paths keep off walls where they can.
    A parked robot is a row of discs that hold it. One disc is as wide as the ball about its base:
    of low robots wider than they are, room that is needed to drive around them (in `random` on
    wheels the closest discs bring ORCA from 0.88 of episodes to 0.60). Grids are kept, what parked
    robots take of them for an episode, and the paths of cases' beginnings.

    Who would shut another's only way by parking, or is to park where that stands, has no path until
    that has parked: in `doorway` goals may be right behind the door.

    Args:
        simulator: that it is for.

    Raises:
        ValueError: a robot has no planar base, or no workspace.
    """

    def __init__(self, simulator: Simulator) -> None:
        for robot in simulator.robots:
            if robot.base != "planar" or robot.workspace is None:
                raise ValueError(
                    f"path: {robot.name!r} has no planar base, or no workspace; expected 'straight'"
                )
        self._simulator = simulator
        self._discs = [enclosing_discs(robot) for robot in simulator.robots]
        self._room = [
            float(robot.reach[robot.root]) - enclosing_radius(robot) if len(centers) == 1 else 0.0
            for robot, (centers, _) in zip(simulator.robots, self._discs, strict=True)
        ]
        models = [robot.model for robot in simulator.scenario.robots]
        self._like = [models.index(model) for model in models]  # the first of the same model
        self._grids: dict[tuple[int, int], Grid] = {}
        self._taken: list[dict[Any, tuple[Flags, Flags]]] = [{} for _ in range(simulator.n_worlds)]
        self._begun: dict[tuple[int, bytes], list[Floats]] = {}

    def paths(self, world: int) -> dict[int, Floats]:
        """Of robots on the way from where they are to their goals, (k, 3): x, y, yaw, by robot.

        Straight where there is no way at all; through parked robots where there is none around. Who
        waits for another's way has a path that ends where it begins.
        """
        simulator = self._simulator
        parked = np.flatnonzero(simulator.status[world] == PARKED)
        moving = np.flatnonzero(simulator.status[world] == MOVING).tolist()
        if not len(parked):
            self._taken[world].clear()
        if len(parked) or simulator.starts == "random":
            return dict(zip(moving, self._found(world, moving, parked), strict=True))
        at = simulator.configurations[world].tobytes() + simulator.goals[world].tobytes()
        key = int(simulator.case_numbers[world]), at
        if key not in self._begun:
            self._begun[key] = self._found(world, moving, parked)
        return dict(zip(moving, self._begun[key], strict=True))

    def _found(self, world: int, moving: list[int], parked: Ints) -> list[Floats]:
        """Paths of who is on the way."""
        q, goals = (
            x[world, :, :3] for x in (self._simulator.configurations, self._simulator.goals)
        )
        ways: dict[int, Way] = {}
        for i in moving:
            grid = self._grid(world, int(self._simulator.case_numbers[world]), i)
            around = self._around(world, i, grid, parked.tolist(), q[parked])
            path = found(around, q[i], goals[i])
            if path is not None:
                grid = around
            else:
                path = found(grid, q[i], goals[i])
            ways[i] = Way(grid, np.stack([q[i], goals[i]]) if path is None else path)
        waits = self._waiting(world, ways) if self._simulator.scenario.at_goal == "park" else set()
        return [np.stack([q[i], q[i]]) if i in waits else ways[i].path for i in moving]

    def _waiting(self, world: int, ways: dict[int, Way]) -> set[int]:
        """Who is to park later than another, and does not stand where that is to park."""
        waits: dict[int, set[int]] = {i: set() for i in ways}  # for whom, and for whom those wait
        for i, j in itertools.permutations(ways, 2):
            if i in waits[j] or not self._shuts(world, i, j, ways[j]):
                continue
            first, later = {j, *waits[j]}, {i, *(k for k in ways if i in waits[k])}
            if not any(
                self._stands(k, ways[k].path[0], m, ways[m].path[-1:]) for k in later for m in first
            ):
                for k in later:
                    waits[k] |= first
        return {i for i in ways if waits[i]}

    def _shuts(self, world: int, i: int, j: int, way: Way) -> bool:
        """Whether robot i at its goal shuts the only way of robot j, or would be where that is."""
        goal = self._simulator.goals[world, i, :3]
        if not self._stands(i, goal, j, way.path):
            return False
        if self._stands(i, goal, j, way.path[:1]):
            return True
        shut = self._around(world, j, way.grid, [i], goal[None], room=False)
        return found(shut, way.path[0], way.path[-1]) is None

    def _stands(self, i: int, at: Floats, j: int, path: Floats) -> bool:
        """Whether robot i at a configuration stands in a path of robot j, or at a point of it."""
        (centers, radius), (_, wide) = self._discs[i], self._discs[j]
        return gap(path, placed(centers, at)) < radius + wide

    def _around(
        self, world: int, i: int, grid: Grid, parked: Sequence[int], at: Floats, room: bool = True
    ) -> Grid:
        """The grid of a robot without what others take of it, parked at (k, 3)."""
        prices = grid.prices.copy()
        for j, place in zip(parked, at, strict=True):
            key = self._like[i], j, place.tobytes(), room
            if key not in self._taken[world]:
                self._taken[world][key] = self._takes(i, grid, j, place, room)
            near, closed = self._taken[world][key]
            prices[near] = np.maximum(prices[near], DEAR)
            prices[closed] = math.inf
        return grid._replace(prices=prices)

    def _takes(self, i: int, grid: Grid, j: int, at: Floats, room: bool) -> tuple[Flags, Flags]:
        """Cells of a robot's grid that another's discs at a place are near to, and in."""
        (mine, radius), (others, wide) = self._discs[i], self._discs[j]
        apart = radius + wide + room * (self._room[i] + self._room[j])
        squared = np.full(grid.prices.shape, math.inf)
        for layer in range(len(squared)):
            own = placed(mine, np.array([0.0, 0.0, layer * (2 * math.pi / HEADINGS)]))
            middles = placed(others, at)[:, None] - own  # of the robot where two discs have one
            x, y = (grid.axis(k) - middles[..., k, None] for k in range(2))
            each = x[..., :, None] ** 2 + y[..., None, :] ** 2
            squared[layer] = each.min(axis=(0, 1))
        near = squared < (apart + NARROW * (radius + self._room[i])) ** 2
        return near, squared < apart**2

    def _reach(self, i: int) -> float:
        """Meters from a robot's base that its discs reach."""
        centers, radius = self._discs[i]
        return float(np.abs(centers).max()) + radius

    def _grid(self, world: int, case: int, i: int) -> Grid:
        """That of a robot in a case; alike robots share it."""
        key = case, self._like[i]
        if key not in self._grids:
            alone = self._simulator.built.world(robots=False)
            cases = self._simulator.cases
            if cases.stands:
                names = list(self._simulator.built.names)
                alone.set_pose(names, self._simulator.standing_poses(world))
            self._grids[key] = self._priced(alone, i)
        return self._grids[key]

    def _priced(self, alone: World, i: int) -> Grid:
        robot, radius = self._simulator.robots[i], self._reach(i) + self._room[i]
        room, margin = np.asarray(robot.workspace), NARROW * 0.5 * min(footprint_size(robot))
        side = max(FINE * radius, float(np.ptp(room, axis=0).max()) / MOST)
        counts = np.maximum(1, np.floor(np.ptp(room, axis=0) / side).astype(int))
        low = room[0] + 0.5 * (np.ptp(room, axis=0) - (counts - 1) * side)
        grid = Grid(np.empty((HEADINGS, *counts)), low, side)
        at = np.stack(np.meshgrid(grid.axis(0), grid.axis(1), indexing="ij"), axis=-1)
        turns = is_elongated(robot)
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


def gap(path: Floats, places: Floats) -> float:
    """Meters between a path (n, 3), or a point (1, 3), and the nearest of places (k, 2)."""
    begins = path[: max(1, len(path) - 1), :2]
    legs, to = path[-len(begins) :, :2] - begins, places[:, None] - begins
    squared = (legs**2).sum(axis=1)
    along = np.divide(
        (to * legs).sum(axis=2), squared, out=np.zeros(to.shape[:2]), where=squared > 0
    )
    by = to - np.clip(along, 0.0, 1.0)[..., None] * legs
    return math.sqrt(float((by**2).sum(axis=2).min()))


def placed(ahead: Any, at: Floats) -> Floats:
    """Points (k, 2) that are so far ahead of a base at (3,), meters."""
    sine, cosine = _core.sin_cos(at[2:])
    found: Floats = at[:2] + np.multiply.outer(ahead, np.array([cosine[0], sine[0]]))
    return found


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

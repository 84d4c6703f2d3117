"""The shortest paths of the simulator's path hints in NumPy, on the native A*."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats, Indices, Ints
from fgenv.envs import Simulator
from fgenv.envs.state_readers import MOVING, PARKED
from fgenv.robots.footprint import enclosing_discs, enclosing_radius, footprint_size, is_elongated

HEADINGS = 8
NARROW = 1 / 3  # of half the width: cells with less clearance cost 2


class Grid(NamedTuple):
    """Costs (layers, nx, ny), 0: closed; center of the first cell; side of a cell."""

    costs: Ints
    low: Floats
    side: float

    def axis(self, k: int) -> Floats:
        """Centers of the cells on an axis, meters."""
        return np.asarray(self.low[k] + self.side * np.arange(self.costs.shape[k + 1]))


class Planner:
    """Paths of the robots of a simulator's world."""

    def __init__(self, simulator: Simulator, world: int) -> None:
        self.robots, self.built = simulator.robots, simulator.built
        self.q = simulator.configurations[world, :, :3]
        self.goals = simulator.goals[world, :, :3]
        status = simulator.status[world]
        self.moving = np.flatnonzero(status == MOVING).tolist()
        self.parked = np.flatnonzero(status == PARKED).tolist()
        self.waits = simulator.scenario.at_goal == "park"
        self.static_poses = simulator.static_poses(world)
        self.discs = [enclosing_discs(robot) for robot in self.robots]
        self.extra = [
            float(robot.reach[robot.root]) - enclosing_radius(robot) if len(centers) == 1 else 0.0
            for robot, (centers, _) in zip(self.robots, self.discs, strict=True)
        ]

    def paths(self) -> dict[int, Floats]:
        """Return the path (k, 3) of each moving robot."""
        grids: dict[int, Grid] = {}
        paths: dict[int, Floats] = {}
        for i in self.moving:
            empty = self.empty_grid(i)
            grids[i] = self.block(i, empty, self.parked, self.q[self.parked])
            path = find_path(grids[i], self.q[i], self.goals[i])
            if path is None:
                grids[i] = empty
                path = find_path(empty, self.q[i], self.goals[i])
            paths[i] = np.stack([self.q[i], self.goals[i]]) if path is None else path
        waiting = self.waiting(grids, paths) if self.waits else set()
        return {i: np.stack([self.q[i]] * 2) if i in waiting else paths[i] for i in self.moving}

    def waiting(self, grids: dict[int, Grid], paths: dict[int, Floats]) -> set[int]:
        """Return the robots that wait for others to park."""
        waits: dict[int, set[int]] = {i: set() for i in paths}
        for i, j in itertools.permutations(paths, 2):
            if i in waits[j] or not self.blocks_route(i, j, grids[j], paths[j]):
                continue
            first, later = {j, *waits[j]}, {i, *(k for k in paths if i in waits[k])}
            if not any(
                self.overlaps(k, paths[k][0], m, paths[m][-1:]) for k in later for m in first
            ):
                for k in later:
                    waits[k] |= first
        return {i for i in paths if waits[i]}

    def blocks_route(self, i: int, j: int, grid: Grid, path: Floats) -> bool:
        """Whether robot i at its goal blocks the only path of robot j, or overlaps it."""
        goal = self.goals[i]
        if not self.overlaps(i, goal, j, path):
            return False
        if self.overlaps(i, goal, j, path[:1]):
            return True
        blocked = self.block(j, grid, [i], goal[None], with_extra=False)
        return find_path(blocked, path[0], path[-1]) is None

    def overlaps(self, i: int, q: Floats, j: int, path: Floats) -> bool:
        """Whether the discs of robot i at a configuration overlap robot j on a path."""
        (centers, radius), (_, other) = self.discs[i], self.discs[j]
        return distance(path, discs_at(centers, q)) < radius + other

    def block(
        self,
        i: int,
        grid: Grid,
        robots: list[int],
        configurations: Iterable[Floats],
        with_extra: bool = True,
    ) -> Grid:
        """Return the grid of robot i without the cells that other robots take."""
        costs = grid.costs.copy()
        for j, q in zip(robots, configurations, strict=True):
            near, closed = self.taken(i, grid, j, q, with_extra)
            costs[near & (costs > 0)] = 2
            costs[closed] = 0
        return grid._replace(costs=costs)

    def taken(
        self, i: int, grid: Grid, j: int, q: Floats, with_extra: bool = True
    ) -> tuple[Flags, Flags]:
        """Return the cells near to robot j, and those where robot i would overlap it."""
        (own, radius), (others, other) = self.discs[i], self.discs[j]
        apart = radius + other + with_extra * (self.extra[i] + self.extra[j])
        squared = np.full(grid.costs.shape, math.inf)
        for layer in range(len(squared)):
            offsets = discs_at(own, np.array([0.0, 0.0, layer * (2 * math.pi / HEADINGS)]))
            centers = discs_at(others, q)[:, None] - offsets
            x, y = (grid.axis(k) - centers[..., k, None] for k in range(2))
            squared[layer] = (x[..., :, None] ** 2 + y[..., None, :] ** 2).min(axis=(0, 1))
        near = squared < (apart + NARROW * (radius + self.extra[i])) ** 2
        return near, squared < apart**2

    def empty_grid(self, i: int) -> Grid:
        """Return the grid of robot i among the static bodies."""
        robot, (centers, radius) = self.robots[i], self.discs[i]
        size = float(np.abs(centers).max()) + radius + self.extra[i]
        low, high = np.asarray(robot.workspace)
        side = max(size / 3, float((high - low).max()) / 200)
        counts = np.maximum(1, np.floor((high - low) / side).astype(int))
        first = low + 0.5 * ((high - low) - (counts - 1) * side)
        n = HEADINGS if is_elongated(robot) else HEADINGS // 2
        grid = Grid(np.empty((n, *counts), dtype=np.int64), first, side)
        world = self.built.world(robots=False)
        if len(self.static_poses):
            world.set_pose(list(self.built.names), self.static_poses)
        at = np.stack(np.meshgrid(grid.axis(0), grid.axis(1), indexing="ij"), axis=-1)
        me = self.built.add_robot(world, i, self.q[i])
        margin = NARROW * 0.5 * min(footprint_size(robot))
        for k in range(n):
            yaw = np.full((*counts, 1), k * (2 * math.pi / HEADINGS))
            q = np.concatenate([at, yaw], axis=-1)
            narrow = world.collides(me, q, margin=margin)
            grid.costs[k] = np.where(world.collides(me, q), 0, np.where(narrow, 2, 1))
        if is_elongated(robot):
            return grid
        best = np.where(grid.costs == 0, 3, grid.costs).min(axis=0, keepdims=True)
        return grid._replace(costs=np.where(best == 3, 0, best))


def find_path(grid: Grid, start: Floats, goal: Floats) -> Floats | None:
    """Return the cheapest path (k, 3), None if there is none."""
    cells = _core.cheapest_path(grid.costs, nearest_open(grid, start), nearest_open(grid, goal))
    if not len(cells):
        return None
    corners = grid.low + grid.side * turns_of(cells[:, 1:])[1:-1]
    points = np.concatenate([start[None, :2], corners, goal[None, :2]])
    yaws = [_core.arc_tangent(float(y), float(x)) for x, y in np.diff(points, axis=0)]
    return np.column_stack([points, [start[2], *yaws[1:], goal[2]]])


def nearest_open(grid: Grid, q: Floats) -> Indices:
    """Return the open cell nearest to a configuration; if all are closed, the cell there."""
    layers, *size = grid.costs.shape
    heading = q[2] * HEADINGS / (2 * math.pi) if layers > 1 else 0.0
    at = np.array([heading, *((q[:2] - grid.low) / grid.side)])
    cells = np.argwhere(grid.costs > 0)
    if not len(cells):
        return np.clip(np.round(at).astype(np.int64), 0, np.array([layers, *size]) - 1)
    by = cells - at
    by[:, 0] = np.remainder(by[:, 0] + HEADINGS / 2, HEADINGS) - HEADINGS / 2
    return np.asarray(cells[(by**2).sum(axis=1).argmin()])


def turns_of(cells: Ints) -> Ints:
    """Return the cells (k, 2) where a path begins, changes its direction and ends."""
    cells = cells[np.concatenate([[True], (np.diff(cells, axis=0) != 0).any(axis=1)])]
    steps = np.diff(cells, axis=0)
    turns = np.flatnonzero((steps[1:] != steps[:-1]).any(axis=1)) + 1
    return np.asarray(cells[np.concatenate([[0], turns, [len(cells) - 1]])])


def distance(path: Floats, points: Floats) -> float:
    """Return meters between a path (n, 3), or a point (1, 3), and the nearest of points (k, 2)."""
    begins = path[: max(1, len(path) - 1), :2]
    legs, to = path[-len(begins) :, :2] - begins, points[:, None] - begins
    squared = (legs**2).sum(axis=1)
    along = np.divide(
        (to * legs).sum(axis=2), squared, out=np.zeros(to.shape[:2]), where=squared > 0
    )
    by = to - np.clip(along, 0.0, 1.0)[..., None] * legs
    return math.sqrt(float((by**2).sum(axis=2).min()))


def discs_at(ahead: Floats, q: Floats) -> Floats:
    """Return points (k, 2) at distances ahead of a base at x, y, yaw."""
    sine, cosine = _core.sin_cos(q[2:])
    return np.asarray(q[:2] + np.multiply.outer(ahead, np.array([cosine[0], sine[0]])))

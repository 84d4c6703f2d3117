"""Roadmap of one kind of robot: configurations, connected by timed edges."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise

import numpy as np

from fgenv.arrays import Floats, Ints
from fgenv.planners.deadline import NEVER, Deadline
from fgenv.robots import Robot

from .motion_table import MotionTable
from .spatial_hash import RoadmapCells
from .time_scaling import TimeScaling

INF = UNREACHABLE = 1 << 40  # steps


class Roadmap:
    """Vertices and directed edges, each certified free of the static bodies.

    Edges begin and end at rest, so any edge can follow another, and a robot can wait at every
    vertex. Motion number v of the table is waiting at vertex v; the motions of an edge are added
    on demand.

    Args:
        robot: a robot of the kind.
        q: (n, nq), vertices.
        edges: (m, 2), vertices from and to; certified free.
        dt: seconds of a step.
        paths: configurations (k + 1, nq) at the steps of each edge; straight edges by default.
        deadline: of the construction, which raises PlanningError after it.

    Attributes:
        tails, heads: (m,), first and last vertex of each edge, sorted by tail.
        durations: steps of each edge.
        successors: for each vertex its edges as (edge, head, duration).
        motions: table of the one-step motions.
    """

    def __init__(
        self,
        robot: Robot,
        q: Floats,
        edges: Ints,
        dt: float,
        paths: list[Floats] | None = None,
        deadline: Deadline = NEVER,
    ) -> None:
        order = np.argsort(edges[:, 0], kind="stable")
        self.robot, self.q, self.dt = robot, q, dt
        self._paths = None if paths is None else [paths[i] for i in order]
        self.tails, self.heads = edges[order, 0], edges[order, 1]
        self.time_scaling = TimeScaling(robot, dt)
        self.durations: list[int] = []
        for e in range(len(edges)):
            deadline.check("the timing of a roadmap's edges")
            self.durations.append(self._duration(e))
        self._first_edge = np.searchsorted(self.tails, np.arange(len(q) + 1))
        self.successors = self._successors()
        self.motions = MotionTable(robot)
        self.motions.add(q, q)
        self._first_motion: dict[int, int] = {}
        self._cost_to_go: dict[int, list[int]] = {}

    def vertex(self, q: Floats) -> int:
        """Number of the vertex at configuration q (nq,), which must be one of the vertices."""
        return int(np.flatnonzero((self.q == q).all(1))[0])

    def _duration(self, e: int) -> int:
        if self._paths is not None:
            return len(self._paths[e]) - 1
        q0, q1 = self.q[self.tails[e]], self.q[self.heads[e]]
        return len(self.time_scaling.fractions(q0, q1)) - 1

    def _successors(self) -> list[list[tuple[int, int, int]]]:
        edges = range(len(self.heads))
        rows = list(zip(edges, self.heads.tolist(), self.durations, strict=True))
        return [rows[a:b] for a, b in pairwise(self._first_edge.tolist())]

    @cached_property
    def cells(self) -> RoadmapCells:
        """Spatial hash of the vertices and the edges."""
        n = len(self.q)
        vertices = self.motions.center[:n], self.motions.radius[:n]
        return RoadmapCells.from_spheres(vertices, self._edge_spheres(*vertices))

    def _edge_spheres(self, center: Floats, radius: Floats) -> tuple[Floats, Floats]:
        """Spheres that enclose the robot along each edge: centers (m, 3) and radii (m,), meters.

        The mean distance of a point from its first and its last position is at most half of the
        length of its path.
        """
        a, b = self.tails, self.heads
        length = np.zeros(len(a))
        if self._paths is not None:
            length = np.array(
                [self.robot.displacement_bound(p[:-1], p[1:]).sum() for p in self._paths]
            )
        elif len(a):
            length = np.asarray(self.robot.displacement_bound(self.q[a], self.q[b]))
        return 0.5 * (center[a] + center[b]), 0.5 * (radius[a] + radius[b] + length)

    def first_motion(self, e: int) -> int:
        """Number of the first motion of edge e; the rest of the edge's motions follow it."""
        if e not in self._first_motion:
            q0, q1 = self.q[self.tails[e]], self.q[self.heads[e]]
            if self._paths is None:
                fractions = self.time_scaling.fractions(q0, q1)
                path = self.robot.interpolate(q0, q1, fractions, threads=1)
            else:
                path = self._paths[e].copy()
            path[0], path[-1] = q0, q1
            self._first_motion[e] = self.motions.add(path[:-1], path[1:])
        return self._first_motion[e]

    def edge_motions(self, e: int) -> Ints:
        """Numbers of the motions of edge e, (k,)."""
        first = self.first_motion(e)
        return np.arange(first, first + self.durations[e], dtype=np.int64)

    def cost_to_go(self, goal: int) -> list[int]:
        """Least number of steps from each vertex to the goal, (n,); UNREACHABLE without a path."""
        if goal not in self._cost_to_go:
            self._cost_to_go[goal] = self.costs_to_go([goal])[:, 0].tolist()
        return self._cost_to_go[goal]

    def costs_to_go(self, goals: list[int]) -> Ints:
        """Least number of steps from each vertex to each goal, (n, goals): Bellman's equation."""
        cost = np.full((len(self.q), len(goals)), UNREACHABLE, dtype=np.int64)
        cost[goals, range(len(goals))] = 0
        if not len(self.tails):
            return cost
        duration = np.array(self.durations, dtype=np.int64)[:, None]
        left = np.flatnonzero(np.diff(self._first_edge))  # vertices that have successors
        first = self._first_edge[left]
        while True:
            through = np.minimum.reduceat(duration + cost[self.heads], first, axis=0)
            better = np.minimum(cost[left], through)
            if (better == cost[left]).all():
                return np.minimum(cost, UNREACHABLE)
            cost[left] = better

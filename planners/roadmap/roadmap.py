"""A roadmap of one kind of robot: configurations, and timed moves from one to the next."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from fgenv.arrays import Floats, Ints
from fgenv.robots import Robot

from .motion_table import Steps
from .spatial_hash import numbers
from .time_scaling import Pace

INF = FAR = 1 << 40  # steps: for ever, or no way


class Roadmap:
    """Vertices and directed moves, each proved free of all that stands; steps are made on demand.

    Moves begin and end at rest, so they follow each other in any way, and waiting is possible at
    all vertices. The step of waiting at vertex v bears the number v.

    Args:
        robot: any of its kind.
        q: (n, nq), vertices.
        moves: (m, 2), from which to which; their ways are proved free.
        dt: seconds of a step.
        ways: configurations (k+1, nq) at the steps of each move; straight ones if left out.
    """

    def __init__(
        self, robot: Robot, q: Floats, moves: Ints, dt: float, ways: list[Floats] | None = None
    ) -> None:
        order = np.argsort(moves[:, 0], kind="stable")
        self.robot, self.q, self.dt = robot, q, dt
        self._ways = None if ways is None else [ways[i] for i in order]
        self.tails, self.heads = moves[order, 0], moves[order, 1]
        self.begin = np.searchsorted(self.tails, np.arange(len(q) + 1)).tolist()
        self.pace = Pace(robot, dt)
        self.length = np.array([self._steps(e) for e in range(len(moves))], dtype=np.int64)
        self.lengths: list[int] = self.length.tolist()
        self.steps = Steps(robot)
        self.steps.add(q, q)
        self.out = self._out()
        self._first: dict[int, int] = {}
        self._to: dict[int, list[int]] = {}

    def vertex(self, q: Floats) -> int:
        """The vertex at a configuration (nq,), which is one of those that it was made with."""
        return int(np.flatnonzero((self.q == q).all(1))[0])

    def _steps(self, e: int) -> int:
        if self._ways is not None:
            return len(self._ways[e]) - 1
        return len(self.pace.fractions(self.q[self.tails[e]], self.q[self.heads[e]])) - 1

    @cached_property
    def balls(self) -> tuple[Floats, Floats]:
        """Balls that hold all of each move: centers (m, 3) and radii (m,), meters.

        A point that goes D meters is never farther than D / 2 in the mean from where it begins and
        where it ends.
        """
        a, b, n = self.tails, self.heads, len(self.q)
        far = np.zeros(len(a))
        if self._ways is not None:
            far = np.array([self.robot.distance(w[:-1], w[1:]).sum() for w in self._ways])
        elif len(a):
            far = np.asarray(self.robot.distance(self.q[a], self.q[b]))
        center, radius = self.steps.center[:n], self.steps.radius[:n]
        return 0.5 * (center[a] + center[b]), 0.5 * (radius[a] + radius[b] + far)

    @cached_property
    def cells(self) -> tuple[float, list[tuple[int, int]], list[tuple[int, int]]]:
        """Side of a cell (m), and of each vertex and move its cell and its reach, in sides."""
        n = len(self.q)
        side = float(self.steps.radius[:n].max())
        still = numbers(self.steps.center[:n], side).tolist()
        center, radius = self.balls
        reach = np.ceil(radius / side + 1e-6).astype(np.int64).tolist()
        moves = zip(numbers(center, side).tolist(), reach, strict=True)
        return side, [(cell, 1) for cell in still], list(moves)

    def _out(self) -> list[list[tuple[int, int, int]]]:
        """Of each vertex the moves that leave it: number, where to, how many steps."""
        rows = list(
            zip(range(len(self.heads)), self.heads.tolist(), self.length.tolist(), strict=True)
        )
        return [rows[a:b] for a, b in zip(self.begin, self.begin[1:], strict=False)]

    def first(self, e: int) -> int:
        """Number of the first step of move e; the others follow it. It ends at the very vertex."""
        if e not in self._first:
            q0, q1 = self.q[self.tails[e]], self.q[self.heads[e]]
            if self._ways is None:
                way = self.robot.interpolate(q0, q1, self.pace.fractions(q0, q1), threads=1)
            else:
                way = self._ways[e].copy()
            way[0], way[-1] = q0, q1
            self._first[e] = self.steps.add(way[:-1], way[1:])
        return self._first[e]

    def numbers(self, e: int) -> Ints:
        """Numbers of the steps of move e, (k,)."""
        first = self.first(e)
        return np.arange(first, first + self.length[e], dtype=np.int64)

    def to(self, goal: int) -> list[int]:
        """Steps from each vertex to the goal at least, (n,); FAR where there is no way."""
        if goal not in self._to:
            self._to[goal] = self.all_to([goal])[:, 0].tolist()
        return self._to[goal]

    def all_to(self, goals: list[int]) -> Ints:
        """Steps from each vertex to each goal at least, (n, goals): Bellman's equation."""
        cost = np.full((len(self.q), len(goals)), FAR, dtype=np.int64)
        cost[goals, range(len(goals))] = 0
        if not len(self.tails):
            return cost
        some = np.flatnonzero(np.diff(self.begin))
        at = np.array(self.begin)[some]
        while True:
            through = np.minimum.reduceat(self.length[:, None] + cost[self.heads], at, axis=0)
            better = np.minimum(cost[some], through)
            if (better == cost[some]).all():
                return np.minimum(cost, FAR)
            cost[some] = better

"""A roadmap of one kind of robot: configurations, and timed moves from one to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fgenv.robots import Robot

from .moves import Floats, Ints, Steps
from .pace import Pace

FAR = 1 << 40  # steps: no way


@dataclass(frozen=True)
class Leaving:
    """The moves that leave a vertex.

    Attributes:
        moves: their numbers, (m,).
        heads: the vertices that they lead to, (m,).
        first, length: number of the first step of each, and how many steps it takes, (m,).
        steps, move, offset: all their steps, (s,): number, place in `moves`, place in the move.
        centre, reach: a ball (3,), metres, that holds them all.
    """

    moves: list[int]
    heads: list[int]
    first: list[int]
    length: list[int]
    steps: Ints
    move: Ints
    offset: Ints
    centre: Floats
    reach: float


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
        self.steps = Steps(robot)
        self.steps.add(q, q)
        self._leaving: dict[int, Leaving] = {}
        self._to: dict[int, list[int]] = {}

    def vertex(self, q: Floats) -> int:
        """The vertex at a configuration (nq,), which is one of those that it was made with."""
        return int(np.flatnonzero((self.q == q).all(1))[0])

    def _steps(self, e: int) -> int:
        if self._ways is not None:
            return len(self._ways[e]) - 1
        return len(self.pace.fractions(self.q[self.tails[e]], self.q[self.heads[e]])) - 1

    def leaving(self, u: int) -> Leaving:
        """The moves that leave vertex u."""
        if u not in self._leaving:
            self._leaving[u] = self._made(u, range(self.begin[u], self.begin[u + 1]))
        return self._leaving[u]

    def _made(self, u: int, moves: range) -> Leaving:
        lengths = self.length[moves.start : moves.stop]
        rows = self._rows(u, moves)
        first = self.steps.add(*(np.concatenate(r) for r in rows)) if len(moves) else 0
        ends = np.concatenate([[0], np.cumsum(lengths)])
        steps = first + np.arange(ends[-1], dtype=np.int64)
        centre, reach = self.steps.centre[u], float(self.steps.radius[u])
        if len(steps):
            away = self.steps.centre[steps] - centre
            far = np.sqrt((away * away).sum(1)) + self.steps.radius[steps]
            reach = max(reach, float(far.max()))
        return Leaving(
            list(moves),
            self.heads[moves.start : moves.stop].tolist(),
            (first + ends[:-1]).tolist(),
            lengths.tolist(),
            steps,
            np.repeat(np.arange(len(moves)), lengths),
            np.arange(ends[-1]) - np.repeat(ends[:-1], lengths),
            centre,
            reach,
        )

    def _rows(self, u: int, moves: range) -> tuple[list[Floats], list[Floats]]:
        """Where the steps of each move begin and end; moves end at the very vertices."""
        ways = [self._way(u, e) for e in moves]
        return [way[:-1] for way in ways], [way[1:] for way in ways]

    def _way(self, u: int, e: int) -> Floats:
        q0, q1 = self.q[u], self.q[self.heads[e]]
        if self._ways is None:
            way = self.robot.interpolate(q0, q1, self.pace.fractions(q0, q1))
        else:
            way = self._ways[e].copy()
        way[0], way[-1] = q0, q1
        return way

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

"""Safe interval path planning: the soonest timed path of one robot among others that move.

M. Phillips and M. Likhachev, "SIPP: Safe interval path planning for dynamic environments", 2011. A
state is a vertex and one of its safe intervals; of all ways into it the soonest is best, for one
may wait.
"""

from __future__ import annotations

import time
from bisect import bisect_left
from dataclasses import dataclass
from heapq import heappop, heappush
from operator import itemgetter
from typing import NamedTuple, Protocol

import numpy as np

from fgenv.arrays import Ints
from fgenv.planners.roadmap.roadmap import FAR, INF, Roadmap

from .safe_intervals import Range

LOOK = 64  # states between two looks at the clock


class Safe(Protocol):
    """When one may wait at a vertex, and first begin a move; see `Traffic`."""

    def waits(self, v: int) -> list[Range]: ...
    def first(self, e: int, low: int, high: int) -> int: ...


@dataclass(frozen=True)
class Action:
    """A move, or a wait: from vertex `tail` to `head`, its first step's number, when, how long."""

    move: int  # -1: a wait
    tail: int
    head: int
    step: int
    start: int
    length: int


@dataclass(frozen=True, eq=False)
class Track:
    """What one robot does: actions one after the other, and the steps' numbers, (k,)."""

    actions: tuple[Action, ...]
    steps: Ints
    goal: int

    @property
    def arrival(self) -> int:
        """The instant of arrival at the goal, to stay."""
        return len(self.steps)


@dataclass
class Effort:
    """What searches took, and when they have to end."""

    deadline: float = float("inf")
    expanded: int = 0
    searches: int = 0

    def late(self) -> bool:
        """Whether the time is up."""
        return time.monotonic() > self.deadline


class Node(NamedTuple):
    """A state: how it was reached, and when."""

    parent: int
    vertex: int
    move: int
    begin: int  # of the move
    t: int


def sipp(
    roadmap: Roadmap,
    start: int,
    goal: int,
    safe: Safe,
    effort: Effort,
    *,
    park: bool = True,
    release: int = -1,
    most: int = INF,
    states: int = INF,
    greed: float = 1.0,
) -> Track | None:
    """The soonest track from start, at instant 0, to the goal; None where there is none in time.

    Args:
        park: it has to stay at the goal for ever, safely.
        release: it must not arrive, to stay, before the instant after this.
        most: tracks that arrive later than this are of no use.
        states: it gives up after so many.
        greed: over 1: what is nearer to the goal first; the track may take so many times as long.
    """
    to_goal, goal_waits = roadmap.to(goal), safe.waits(goal)
    effort.searches += 1
    first = _interval(safe.waits(start), 0)
    if to_goal[start] >= FAR or first is None or not goal_waits:
        return None
    if park and goal_waits[-1][1] != INF:
        return None
    soonest = max(release + 1, goal_waits[-1][0] if park else 0)
    nodes: list[Node] = []
    best: dict[tuple[int, int], int] = {}
    # f, steps left, node that it comes from, move, where to, its interval (-1: any), begin, end
    left = to_goal[start]
    heap = [(max(greed * left, soonest), left, -1, -1, start, first, 0, 0)]
    while heap:
        _, left, parent, e, v, i, begin, end = heappop(heap)
        length = roadmap.lengths[e] if e >= 0 else 0
        if i < 0:
            there = safe.waits(v)
            for j in range(bisect_left(there, begin + length, key=itemgetter(1)), len(there)):
                a, b = max(begin, there[j][0] - length), min(end, there[j][1] - length)
                if a > end:
                    break
                heappush(
                    heap, (max(a + length + greed * left, soonest), left, parent, e, v, j, a, b)
                )
            continue
        mark = v, (i if v != goal or begin + length <= release else -1 - i)
        if best.get(mark, INF) <= begin + length:
            continue
        soon = safe.first(e, begin, end) if e >= 0 else 0
        if soon != begin:
            if soon > begin and soon + length + left <= most:
                again = max(soon + length + greed * left, soonest)
                heappush(heap, (again, left, parent, e, v, i, soon, end))
            continue
        t = begin + length
        best[mark] = t
        number = len(nodes)
        nodes.append(Node(parent, v, e, begin, t))
        high = safe.waits(v)[i][1]
        if v == goal and t > release and (not park or high == INF):
            return _track(roadmap, nodes, goal)
        effort.expanded += 1
        if number >= states or (number % LOOK == 0 and effort.late()):
            return None
        for e, head, length in roadmap.out[v]:
            left = to_goal[head]
            if t + length + left <= most:
                heappush(
                    heap,
                    (max(t + length + greed * left, soonest), left, number, e, head, -1, t, high),
                )
    return None


def _interval(ranges: list[Range], t: int) -> int | None:
    """Which of the ranges instant t is in."""
    return next((i for i, (a, b) in enumerate(ranges) if a <= t <= b), None)


def _track(roadmap: Roadmap, nodes: list[Node], goal: int) -> Track:
    """What leads to the last node."""
    actions: list[Action] = []
    node = nodes[-1]
    while node.parent >= 0:
        before, length = nodes[node.parent], node.t - node.begin
        step = roadmap.first(node.move)
        actions.append(Action(node.move, before.vertex, node.vertex, step, node.begin, length))
        if node.begin > before.t:
            u, t = before.vertex, before.t
            actions.append(Action(-1, u, u, u, t, node.begin - t))
        node = before
    actions.reverse()
    steps = [
        np.full(a.length, a.step) if a.move < 0 else np.arange(a.step, a.step + a.length)
        for a in actions
    ]
    return Track(tuple(actions), np.concatenate([np.zeros(0, dtype=np.int64), *steps]), goal)

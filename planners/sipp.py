"""Safe interval path planning: the soonest timed path of one robot among others that move.

M. Phillips and M. Likhachev, "SIPP: Safe interval path planning for dynamic environments", 2011. A
state is a vertex and one of its safe intervals; of all ways into it the soonest is best, for one may
wait.
"""

from __future__ import annotations

import time
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from operator import itemgetter
from typing import Protocol

import numpy as np

from .intervals import INF, Range
from .moves import Ints
from .roadmap import FAR, Roadmap

LOOK = 64  # states between two looks at the clock


class Safe(Protocol):
    """When one may wait at a vertex, and begin each move that leaves it."""

    def waits(self, v: int) -> list[Range]: ...
    def starts(self, u: int) -> Sequence[list[Range]]: ...


@dataclass(frozen=True)
class Action:
    """A move, or a wait: from vertex `tail` to `head`, its first step's number, when, how long."""

    move: int  # -1: a wait
    tail: int
    head: int
    step: int
    start: int
    length: int


@dataclass(frozen=True)
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
) -> Track | None:
    """The soonest track from start, at instant 0, to the goal; None where there is none in time.

    Args:
        park: it has to stay at the goal for ever, safely.
        release: it must not arrive, to stay, before the instant after this.
        most: tracks that arrive later than this are of no use.
    """
    to_goal, goal_waits = roadmap.to(goal), safe.waits(goal)
    effort.searches += 1
    first = _interval(safe.waits(start), 0)
    if to_goal[start] >= FAR or first is None or not goal_waits:
        return None
    if park and goal_waits[-1][1] != INF:
        return None
    soonest = max(release + 1, goal_waits[-1][0] if park else 0)
    nodes: list[tuple[int, int, int, int, int]] = [(-1, start, -1, 0, 0)]  # parent, v, move, s, t
    best = {(start, first): 0}
    heap = [(max(to_goal[start], soonest), to_goal[start], 0, first)]
    while heap:
        f, _, number, i = heappop(heap)
        _, u, _, _, t = nodes[number]
        key = u, (i if u != goal or t <= release else -1 - i)
        if best.get(key, t) < t or f > most:
            continue
        low, high = safe.waits(u)[i]
        if u == goal and t > release and (not park or high == INF):
            return _track(roadmap, nodes, number, goal)
        effort.expanded += 1
        if effort.expanded % LOOK == 0 and effort.late():
            return None
        leaving = roadmap.leaving(u)
        starts = safe.starts(u)
        for m, head in enumerate(leaving.heads):
            left = to_goal[head]
            if left >= FAR:
                continue
            length = leaving.length[m]
            there = safe.waits(head)
            for a, b in starts[m]:
                if b < t:
                    continue
                if a > high:
                    break
                soon, late = max(a, t) + length, min(b, high) + length
                for j in range(bisect_left(there, soon, key=itemgetter(1)), len(there)):
                    lo, _ = there[j]
                    if lo > late:
                        break
                    at = max(soon, lo)
                    mark = head, (j if head != goal or at <= release else -1 - j)
                    if best.get(mark, INF) > at:
                        best[mark] = at
                        heappush(heap, (max(at + left, soonest), left, len(nodes), j))
                        nodes.append((number, head, m, at - length, at))
    return None


def _interval(ranges: list[Range], t: int) -> int | None:
    """Which of the ranges instant t is in."""
    return next((i for i, (a, b) in enumerate(ranges) if a <= t <= b), None)


def _track(
    roadmap: Roadmap, nodes: list[tuple[int, int, int, int, int]], number: int, goal: int
) -> Track:
    actions: list[Action] = []
    while number > 0:
        parent, head, m, start, _ = nodes[number]
        tail, at = nodes[parent][1], nodes[parent][4]
        leaving = roadmap.leaving(tail)
        length = leaving.length[m]
        actions.append(Action(leaving.moves[m], tail, head, leaving.first[m], start, length))
        if start > at:
            actions.append(Action(-1, tail, tail, tail, at, start - at))
        number = parent
    actions.reverse()
    steps = [
        np.full(a.length, a.step) if a.move < 0 else np.arange(a.step, a.step + a.length)
        for a in actions
    ]
    return Track(tuple(actions), np.concatenate([np.zeros(0, dtype=np.int64), *steps]), goal)

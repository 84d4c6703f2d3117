"""Safe intervals: when a robot may wait at a vertex, and when it may set out on a move.

Time is counted in steps. At an instant t a robot is somewhere; step t is from instant t to t + 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from .conflicts import Meetings
from .moves import GONE, Floats, Ints
from .roadmap import Leaving, Roadmap

INF = 1 << 40
Range = tuple[int, int]  # first and last instant, both within
ALWAYS: list[Range] = [(0, INF)]


@dataclass(frozen=True)
class Timed:
    """What a robot does in each step, (k,), and then for ever (GONE: it is not there)."""

    kind: int
    steps: Ints
    rest: int


def without(unsafe: Iterable[int], for_ever: int = INF) -> list[Range]:
    """Ranges that hold none of the unsafe instants (rising), nor any from `for_ever` on."""
    ranges, low = [], 0
    for t in unsafe:
        if t >= for_ever:
            break
        if t > low:
            ranges.append((low, t - 1))
        low = t + 1
    last = INF if for_ever == INF else for_ever - 1
    if low <= last:
        ranges.append((low, last))
    return ranges


def stays(unsafe: Iterable[int], for_ever: int = INF, shut: frozenset[int] = frozenset()) -> list[Range]:
    """Intervals of instants that one may wait through, where some steps (rising) are unsafe.

    Instants between two unsafe steps are intervals of their own, but for those that are shut.
    """
    ranges, low = [], 0
    for t in unsafe:
        if t >= for_ever:
            break
        if t > low or t not in shut:
            ranges.append((low, t))
        low = t + 1
    if for_ever == INF:
        ranges.append((low, INF))
    elif low < for_ever or low not in shut:
        ranges.append((low, for_ever))
    return ranges


class Traffic:
    """Other robots' timed paths, as obstacles for a robot of a kind on its roadmap."""

    def __init__(
        self, meetings: Meetings, kind: int, roadmap: Roadmap, others: Sequence[Timed]
    ) -> None:
        self.meetings, self.kind, self.roadmap = meetings, kind, roadmap
        self.last = max((len(o.steps) for o in others), default=0)
        self._groups = [
            _Group.of(meetings, k, [o for o in others if o.kind == k], self.last)
            for k in sorted({o.kind for o in others})
        ]
        self._waits: dict[int, list[Range]] = {}
        self._starts: dict[int, list[list[Range]]] = {}

    def waits(self, v: int) -> list[Range]:
        """Intervals of instants that the robot may wait through at vertex v, rising."""
        if v not in self._waits:
            self._waits[v] = self._found_waits(v)
        return self._waits[v]

    def starts(self, u: int) -> list[list[Range]]:
        """For each move that leaves vertex u, the instants at which it may be begun."""
        if u not in self._starts:
            self._starts[u] = self._found_starts(u, self.roadmap.leaving(u))
        return self._starts[u]

    def _found_waits(self, v: int) -> list[Range]:
        steps = self.roadmap.steps
        times, still = [], []
        for group in self._groups:
            near = group.near(steps.centre[v], float(steps.radius[v]) + self.meetings.margin)
            if len(near):
                mine, theirs = np.full(len(near), v), group.steps[near]
                met = near[self.meetings.meet_near(self.kind, mine, group.kind, theirs)]
                times.append(group.times[met])
                still.append(group.times[met[group.still[met]]])
        if not times:
            return ALWAYS
        unsafe = np.unique(np.concatenate(times))
        shut = {t for s in np.concatenate(still).tolist() for t in (s, s + 1)}
        for_ever = self.last if len(unsafe) and unsafe[-1] == self.last else INF
        return stays(unsafe.tolist(), for_ever, frozenset(shut))

    def _found_starts(self, u: int, leaving: Leaving) -> list[list[Range]]:
        found: list[tuple[Ints, Ints, Ints]] = []
        for group in self._groups:
            found += self._met(group, leaving)
        n = len(leaving.moves)
        if not found:
            return [ALWAYS] * n
        moves, starts, parked = (np.concatenate(rows) for rows in zip(*found, strict=True))
        out = []
        for m in range(n):
            mine = starts[moves == m]
            if not len(mine):
                out.append(ALWAYS)
                continue
            still = mine[parked[moves == m].astype(bool)]
            for_ever = max(0, int(still.min())) if len(still) else INF
            out.append(without(np.unique(mine[mine >= 0]).tolist(), for_ever))
        return out

    def _met(self, group: _Group, leaving: Leaving) -> list[tuple[Ints, Ints, Ints]]:
        """Places of moves, starts at which they meet somebody, and whether he is parked then."""
        near = group.near(leaving.centre, leaving.reach + self.meetings.margin)
        if not len(near) or not len(leaving.steps):
            return []
        one, two = self.meetings.steps[self.kind], self.meetings.steps[group.kind]
        mine, theirs = leaving.steps, group.steps[near]
        reach = one.radius[mine][:, None] + two.radius[theirs] + self.meetings.margin
        a, b = np.nonzero(_squares(one.centre[mine], two.centre[theirs]) <= reach * reach)
        start = group.times[near[b]] - leaving.offset[a]
        parked = group.times[near[b]] == self.last
        some = np.flatnonzero((start >= 0) | parked)
        a, b, start, parked = a[some], b[some], start[some], parked[some]
        if not len(a):
            return []
        met = self.meetings.meet_near(self.kind, mine[a], group.kind, theirs[b])
        return [(leaving.move[a[met]], start[met], parked[met].astype(np.int64))]


@dataclass(frozen=True)
class _Group:
    """Steps of others of one kind: entry e is step `steps[e]` at `times[e]`; the last time is
    that of what they do for ever."""

    kind: int
    steps: Ints
    times: Ints
    still: np.ndarray[tuple[int], np.dtype[np.bool_]]
    centre: Floats
    radius: Floats

    @classmethod
    def of(cls, meetings: Meetings, kind: int, others: list[Timed], last: int) -> _Group:
        table = np.full((len(others), last + 1), GONE, dtype=np.int64)
        for row, other in zip(table, others, strict=True):
            row[: len(other.steps)] = other.steps
            row[len(other.steps) :] = other.rest
        there = np.nonzero(table != GONE)
        steps, all_steps = table[there], meetings.steps[kind]
        still = (all_steps.q0[steps] == all_steps.q1[steps]).all(1)
        return cls(kind, steps, there[1], still, all_steps.centre[steps], all_steps.radius[steps])

    def near(self, centre: Floats, reach: float) -> Ints:
        """Entries whose balls overlap a ball."""
        away = self.centre - centre
        far = self.radius + reach
        return np.flatnonzero((away * away).sum(1) <= far * far)


def _squares(a: Floats, b: Floats) -> Floats:
    """Squared distances (n, m) of points (n, 3) and (m, 3)."""
    away = a[:, None] - b
    return np.asarray((away * away).sum(-1))

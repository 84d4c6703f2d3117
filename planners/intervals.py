"""Safe intervals: when a robot may wait at a vertex, and when it may set out on a move.

Time is counted in steps. At an instant t a robot is somewhere; step t is from instant t to t + 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from .conflicts import Meetings
from .doubts import Doubts, Near
from .moves import Floats, Ints
from .others import Entries, Timed, entries
from .roadmap import INF, Roadmap

Range = tuple[int, int]  # first and last, both within
ALWAYS: list[Range] = [(0, INF)]


def stays(unsafe: Iterable[Range], instants: Iterable[int] = ()) -> list[Range]:
    """Intervals of instants that one may wait through, where some steps are unsafe.

    Args:
        unsafe: ranges of steps.
        instants: between two unsafe steps, at which one may be there nevertheless.
    """
    ranges, low = [(t, t) for t in instants], 0
    for a, b in sorted(unsafe):
        if a > low or a == low == 0:
            ranges.append((low, a))
        low = max(low, b + 1)
    if low < INF:
        ranges.append((low, INF))
    return sorted(ranges)


class Traffic:
    """Other robots' timed paths, as obstacles for a robot of a kind on its roadmap."""

    def __init__(
        self, meetings: Meetings, kind: int, roadmap: Roadmap, others: Sequence[Timed]
    ) -> None:
        self.meetings, self.kind, self.roadmap = meetings, kind, roadmap
        both = [
            entries(meetings, k, [o for o in others if o.kind == k])
            for k in sorted({o.kind for o in others})
        ]
        self._moving = [moving for moving, _ in both if len(moving.steps)]
        self._standing = [standing for _, standing in both if len(standing.steps)]
        self._waits: dict[int, list[Range]] = {}
        self._doubts: dict[int, Doubts | None] = {}

    def waits(self, v: int) -> list[Range]:
        """Intervals of instants that the robot may wait through at vertex v, rising."""
        if v not in self._waits:
            self._waits[v] = self._found_waits(v)
        return self._waits[v]

    def first(self, e: int, low: int, high: int) -> int:
        """The first instant within [low, high] to begin move e; -1: none."""
        if e not in self._doubts:
            self._doubts[e] = self._found_doubts(e)
        doubts = self._doubts[e]
        return low if doubts is None else doubts.first(low, high)

    def _found_waits(self, v: int) -> list[Range]:
        stood = [
            (a, b)
            for group in self._standing
            for at in (self._met(v, group),)
            for a, b in zip(group.first[at].tolist(), group.last[at].tolist(), strict=True)
        ]
        met = [(group, self._met(v, group)) for group in self._moving]
        moved = {t for group, at in met for t in group.first[at].tolist()}
        if not stood and not moved:
            return ALWAYS
        unsafe = stood + [(t, t) for t in moved]
        between = {t for t in moved if t - 1 in moved or any(b == t - 1 for _, b in stood)}
        between = {t for t in between if not any(a <= t <= b + 1 for a, b in stood)}
        for group, at in met:
            between -= self._there(v, group, at, between)
        return stays(unsafe, between)

    def _met(self, v: int, group: Entries) -> Ints:
        """Entries that meet a robot that waits at v."""
        steps = self.roadmap.steps
        near = group.near(steps.centre[v], float(steps.radius[v]) + self.meetings.margin)
        if not len(near):
            return near
        mine = np.full(len(near), v)
        return near[self.meetings.meet_near(self.kind, mine, group.kind, group.steps[near])]

    def _there(self, v: int, group: Entries, met: Ints, instants: set[int]) -> set[int]:
        """Those instants at which one of these entries, as it begins, stands in the way."""
        at = met[np.isin(group.first[met], list(instants))] if instants else met[:0]
        if not len(at):
            return set()
        there = self.meetings.steps[group.kind].q0[group.steps[at]]
        q = np.broadcast_to(self.roadmap.q[v], (len(at), self.roadmap.q.shape[1]))
        hit = self.meetings.ask(self.kind, q, q, group.kind, there, there)
        return set(group.first[at[hit]].tolist())

    def _found_doubts(self, e: int) -> Doubts | None:
        mine, steps = self.roadmap.numbers(e), self.roadmap.steps
        centre, radius = steps.centre[mine], steps.radius[mine]
        middle = 0.5 * (centre.min(0) + centre.max(0))
        away = centre - middle
        reach = float((np.sqrt(np.einsum("ij,ij->i", away, away)) + radius).max())
        ball = middle, reach + self.meetings.margin
        moving = [near for group in self._moving if (near := self._near(mine, ball, group))]
        standing = [near for group in self._standing if (near := self._near(mine, ball, group))]
        if not moving and not standing:
            return None
        return Doubts(self.meetings, self.kind, moving, standing)

    def _near(self, mine: Ints, ball: tuple[Floats, float], group: Entries) -> Near | None:
        """Steps of a move, all in a ball, and entries that are near each other."""
        entries = group.near(*ball)
        if not len(entries):
            return None
        steps = self.roadmap.steps
        at = steps.centre[mine], steps.radius[mine]
        a, b = group.pairs(entries, *at, self.meetings.margin)
        if not len(a):
            return None
        first, last = group.first[b] - a, group.last[b]
        return Near(group.kind, first, np.where(last == INF, INF, last - a), mine[a], group.steps[b])

"""A move that comes near another robot: when it is safe to begin it, found out on demand."""

from __future__ import annotations

from bisect import bisect_left
from operator import itemgetter

import numpy as np

from fgenv.arrays import Ints
from fgenv.planners.multi.pair_cache import Meetings


class Doubts:
    """The instants at which beginning a move may be unsafe.

    Args:
        kinds: of who moves, and of the other.
        blocked: ranges of instants at which it is not safe.
        first, mine, theirs: (n,), rising in `first`, of equal ones the nearest first: if it begins
            then, it makes step `mine` when the other makes `theirs`. The world is asked about
            these as late as can be.
    """

    def __init__(
        self,
        meetings: Meetings,
        kinds: tuple[int, int],
        blocked: list[tuple[int, int]],
        first: Ints,
        mine: Ints,
        theirs: Ints,
    ) -> None:
        self._meetings, self._kinds = meetings, kinds
        self._blocked = merged(blocked)
        self._first, self._mine, self._theirs = first, mine, theirs
        self._starts: list[int] = first.tolist()
        self._known: dict[int, bool] = {}

    def first(self, low: int, high: int) -> int:
        """The first instant within [low, high] at which it is safe to begin; -1: none."""
        known, blocked = self._known, self._blocked
        ahead, k = 1, bisect_left(blocked, low, key=itemgetter(1))
        while low <= high:
            if k < len(blocked) and blocked[k][0] <= low:
                low, k = blocked[k][1] + 1, k + 1
                continue
            if low not in known:
                self._ask(low, min(low + ahead, high + 1))
                ahead *= 2
            if known[low]:
                return low
            low += 1
        return -1

    def _ask(self, low: int, high: int) -> None:
        """Find out about instants low to high - 1: of each its nearest pair of steps first."""
        a, b = bisect_left(self._starts, low), bisect_left(self._starts, high)
        for t in range(low, high):
            self._known.setdefault(t, True)
        if a == b:
            return
        first = self._first[a:b]
        leads = np.diff(first, prepend=-1) != 0
        hit = self._meet(a + np.flatnonzero(leads))
        rest = np.flatnonzero(~leads & ~np.isin(first, hit))
        if len(rest):
            self._meet(a + rest)

    def _meet(self, at: Ints) -> Ints:
        """The instants of those pairs at `at` that meet; they are known then."""
        (kind, other), mine, theirs = self._kinds, self._mine[at], self._theirs[at]
        hit = self._first[at[self._meetings.meet_near(kind, mine, other, theirs)]]
        self._known.update(dict.fromkeys(hit.tolist(), False))
        return hit


def merged(ranges: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Ranges sorted, those that overlap or follow each other joined."""
    out: list[tuple[int, int]] = []
    for a, b in sorted(ranges):
        if out and a <= out[-1][1] + 1:
            out[-1] = out[-1][0], max(b, out[-1][1])
        else:
            out.append((a, b))
    return out

"""Start instants of an edge that are unsafe because of one dynamic obstacle."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable
from operator import itemgetter

import numpy as np

from fgenv.arrays import Ints
from fgenv.planners.roadmap.pair_cache import PairCache

from .intervals import Interval, merged


class UnsafeStarts:
    """Instants at which starting an edge is unsafe, computed lazily.

    If the edge starts at instant `starts[k]`, the robot makes motion `own[k]` in the same step as
    the obstacle makes motion `other[k]`. These pairs are checked as late as possible.

    Args:
        pairs: collision results.
        kinds: kind of the robot and kind of the obstacle.
        blocked: intervals of start instants that are known to be unsafe.
        starts, own, other: (n,), sorted by start, pairs with the nearest spheres first.
    """

    def __init__(
        self,
        pairs: PairCache,
        kinds: tuple[int, int],
        blocked: Iterable[Interval],
        starts: Ints,
        own: Ints,
        other: Ints,
    ) -> None:
        self._pairs, self._kinds = pairs, kinds
        self._blocked = merged(blocked)
        self._starts, self._own, self._other = starts, own, other
        self._sorted_starts: list[int] = starts.tolist()
        self._safe: dict[int, bool] = {}

    def first_safe(self, low: int, high: int) -> int:
        """First instant in [low, high] at which the edge can start; -1 if there is none."""
        safe, blocked = self._safe, self._blocked
        batch, k = 1, bisect_left(blocked, low, key=itemgetter(1))
        while low <= high:
            if k < len(blocked) and blocked[k][0] <= low:
                low, k = blocked[k][1] + 1, k + 1
                continue
            if low not in safe:
                self._check(low, min(low + batch, high + 1))
                batch *= 2
            if safe[low]:
                return low
            low += 1
        return -1

    def _check(self, low: int, high: int) -> None:
        """Check the instants low to high - 1: first the nearest pair of each instant."""
        a, b = bisect_left(self._sorted_starts, low), bisect_left(self._sorted_starts, high)
        for t in range(low, high):
            self._safe.setdefault(t, True)
        if a == b:
            return
        starts = self._starts[a:b]
        nearest = np.diff(starts, prepend=-1) != 0
        unsafe = self._check_pairs(a + np.flatnonzero(nearest))
        rest = np.flatnonzero(~nearest & ~np.isin(starts, unsafe))
        if len(rest):
            self._check_pairs(a + rest)

    def _check_pairs(self, rows: Ints) -> Ints:
        """Check some pairs; mark and return the start instants of those that collide."""
        kind, other_kind = self._kinds
        hit = self._pairs.collide_near(kind, self._own[rows], other_kind, self._other[rows])
        unsafe = self._starts[rows[hit]]
        self._safe.update(dict.fromkeys(unsafe.tolist(), False))
        return unsafe

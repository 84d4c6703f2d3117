"""A move that comes near others: which instants to begin it at are safe, asked one by one."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from .conflicts import Meetings
from .moves import Ints


class Near(NamedTuple):
    """Steps of a move, each near a step of another; arrays (n,).

    If it begins within [first, last], it makes step `mine` when the other makes `theirs`.
    """

    kind: int  # of the others
    first: Ints
    last: Ints
    mine: Ints
    theirs: Ints


class Doubts:
    """The instants at which beginning a move may be unsafe.

    Args:
        moving, standing: near those who move, and near those who stand. Of the former the world is
            asked as late as can be.
    """

    def __init__(
        self, meetings: Meetings, kind: int, moving: Sequence[Near], standing: Sequence[Near]
    ) -> None:
        self._meetings, self._kind = meetings, kind
        self._blocked = merged([r for near in standing for r in self._met(near)])
        self._near = [_sorted(near) for near in moving]
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

    def _met(self, near: Near) -> list[tuple[int, int]]:
        """When beginning it meets one who stands."""
        met = self._meetings.meet_near(self._kind, near.mine, near.kind, near.theirs)
        return [r for r in zip(near.first[met].tolist(), near.last[met].tolist()) if r[1] >= 0]

    def _ask(self, low: int, high: int) -> None:
        """Find out about instants low to high - 1."""
        for t in range(low, high):
            self._known.setdefault(t, True)
        for near in self._near:
            a, b = near.first.searchsorted((low, high)).tolist()
            if a < b:
                pairs = self._kind, near.mine[a:b], near.kind, near.theirs[a:b]
                met = self._meetings.meet_near(*pairs)
                self._known.update(dict.fromkeys(near.first[a:b][met].tolist(), False))


def merged(ranges: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Ranges sorted, those that overlap or follow each other joined."""
    out: list[tuple[int, int]] = []
    for a, b in sorted(ranges):
        if out and a <= out[-1][1] + 1:
            out[-1] = out[-1][0], max(b, out[-1][1])
        else:
            out.append((a, b))
    return out


def _sorted(near: Near) -> Near:
    """By start."""
    at = np.argsort(near.first, kind="stable")
    return Near(near.kind, *(row[at] for row in near[1:]))

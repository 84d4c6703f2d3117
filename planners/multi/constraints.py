"""What a robot must not do: constraints of conflict-based search, laid over safe intervals.

As in A. Andreychuk et al., "Multi-agent pathfinding with continuous time", 2019: a move must not
begin within a range of instants, and a step must not be waited at a vertex. Of a goal also: it must
not be reached, to stay, before an instant (J. Li et al., "Pairwise symmetry reasoning", 2021).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from fgenv.planners.sipp.safe_intervals import Range
from fgenv.planners.sipp.sipp import Safe


@dataclass(frozen=True)
class Ban:
    """Of one robot: move or vertex `what`, in a range of instants (a move) or steps (a wait).

    A `stay` at the goal must begin after the range's first step.
    """

    robot: int
    act: str  # move, wait, stay
    what: int
    range: Range


class Banned:
    """Safe intervals without what is banned of one robot."""

    def __init__(self, safe: Safe, bans: Iterable[Ban]) -> None:
        self._safe = safe
        self._moves: dict[int, list[Range]] = {}
        self._at: dict[int, list[Range]] = {}
        self._waits: dict[int, list[Range]] = {}
        self.release = -1
        for ban in bans:
            if ban.act == "stay":
                self.release = max(self.release, ban.range[0])
            else:
                kept = self._moves if ban.act == "move" else self._at
                kept.setdefault(ban.what, []).append(ban.range)
        for ranges in self._moves.values():
            ranges.sort()

    def waits(self, v: int) -> list[Range]:
        """As `Traffic.waits`."""
        if v not in self._at:
            return self._safe.waits(v)
        if v not in self._waits:
            ranges = self._safe.waits(v)
            for ban in self._at[v]:
                ranges = [part for r in ranges for part in _cut(r, ban)]
            self._waits[v] = ranges
        return self._waits[v]

    def first(self, e: int, low: int, high: int) -> int:
        """As `Traffic.first`."""
        banned = self._moves.get(e, ())
        while low <= high:
            low = self._safe.first(e, low, high)
            if low < 0:
                return -1
            after = max((b + 1 for a, b in banned if a <= low <= b), default=low)
            if after == low:
                return low
            low = after
        return -1


def _cut(whole: Range, steps: Range) -> list[Range]:
    """Parts of an interval of instants where some steps must not be waited; a, b: step a to b.

    The instants between two such steps stay, each for itself, unless there is no end of them.
    """
    (low, high), (a, b) = whole, steps
    if a >= high or b < low:
        return [whole]
    parts = [(low, a)] if a >= low else []
    if b < high:
        parts += [(t, t) for t in range(max(a + 1, low), b + 1)]
        parts.append((max(b + 1, low), high))
    return parts

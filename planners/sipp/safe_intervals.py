"""Safe intervals: when a robot may wait at a vertex, and when it may set out on a move.

Time is counted in steps. At an instant t a robot is somewhere; step t is from instant t to t + 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fgenv.planners.roadmap.roadmap import INF, Roadmap
from fgenv.planners.roadmap.spatial_hash import Cells

from .dynamic_obstacles import Other
from .unsafe_intervals import Doubts

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
    """Other robots' timed paths, as obstacles for a robot on its roadmap."""

    def __init__(self, roadmap: Roadmap, others: Sequence[Other]) -> None:
        self.roadmap, self.others = roadmap, others
        self._near = Cells(roadmap, others)
        self._waits: dict[int, list[Range]] = {}
        self._moves: dict[int, list[Doubts]] = {}

    def waits(self, v: int) -> list[Range]:
        """Intervals of instants that the robot may wait through at vertex v, rising.

        An instant between two steps that are not safe is left out, though one might pass just then.
        """
        if v not in self._waits:
            self._waits[v] = self._found_waits(v)
        return self._waits[v]

    def first(self, e: int, low: int, high: int) -> int:
        """The first instant within [low, high] to begin move e; -1: none."""
        if e not in self._moves:
            near = (other.moves(e) for other in self._near.of_move(e))
            self._moves[e] = [doubts for doubts in near if doubts is not None]
        doubts = self._moves[e]
        sure = 0  # how many have agreed to `low`
        while sure < len(doubts) or not doubts:
            if not doubts:
                return low
            for one in doubts:
                then = one.first(low, high)
                if then < 0:
                    return -1
                sure = sure + 1 if then == low else 1
                low = then
                if sure == len(doubts):
                    break
        return low

    def _found_waits(self, v: int) -> list[Range]:
        found = [unsafe for o in self._near.of_vertex(v) if (unsafe := o.waits(v)) is not None]
        return stays(r for unsafe in found for r in unsafe) if found else ALWAYS

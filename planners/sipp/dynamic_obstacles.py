"""Another robot's timed path, as a robot of a kind meets it on its roadmap; found out on demand."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fgenv.arrays import Flags, Floats, Ints
from fgenv.planners.multi.pair_cache import Meetings
from fgenv.planners.roadmap.motion_table import GONE
from fgenv.planners.roadmap.roadmap import INF, Roadmap
from fgenv.planners.roadmap.spatial_hash import covered

from .unsafe_intervals import Doubts

Range = tuple[int, int]  # first and last, both within


@dataclass(frozen=True, eq=False)
class Timed:
    """What a robot does in each step, (k,), and then for ever (GONE: it is not there)."""

    kind: int
    steps: Ints
    rest: int
    seen: dict[int, Other] = field(default_factory=dict)  # by the kind of who meets it


class Other:
    """Entries: he makes step `steps[n]` in each of the steps `first[n]` to `last[n]` of time."""

    def __init__(self, meetings: Meetings, kind: int, roadmap: Roadmap, timed: Timed) -> None:
        self.meetings, self.kind, self.roadmap, self.timed = meetings, kind, roadmap, timed
        steps = timed.steps if timed.rest == GONE else np.append(timed.steps, timed.rest)
        begin = np.flatnonzero(np.diff(steps, prepend=-1))
        end = np.append(begin, len(steps))[1:] - 1
        if timed.rest != GONE:
            end[-1] = INF
        table = meetings.steps[timed.kind]
        self.steps, self.first, self.last = steps[begin], begin, end
        self.still: Flags = (table.q0[self.steps] == table.q1[self.steps]).all(1)
        self.center, self.radius = table.center[self.steps], table.radius[self.steps]
        self._middle = self.center.mean(0)
        self._at = self.center - self._middle
        self._squares = (self._at**2).sum(1)
        rounding = 1e-6 * (1.0 + float(self.radius.max()))  # meters, of the squares
        self._reach = self.radius + meetings.margin + rounding
        self._cells: dict[tuple[float, float], frozenset[int]] = {}
        self._waits: dict[int, list[Range] | None] = {}
        self._moves: dict[int, Doubts | None] = {}

    def cells(self, side: float, reach: float) -> frozenset[int]:
        """Cells from where a ball of that reach (m) may come near him, some time; see `covered`."""
        key = side, reach
        if key not in self._cells:
            wide = reach + self.meetings.margin
            self._cells[key] = covered(self.center, self.radius, side, wide)
        return self._cells[key]

    def waits(self, v: int) -> list[Range] | None:
        """Ranges of steps in which waiting at vertex v is not safe; None: it always is."""
        if v not in self._waits:
            b = self._near(np.array([v]))[1]
            met = b[self.meetings.meet_near(self.kind, np.full(len(b), v), *self._theirs(b))]
            ranges = zip(self.first[met].tolist(), self.last[met].tolist(), strict=True)
            self._waits[v] = list(ranges) or None
        return self._waits[v]

    def moves(self, e: int) -> Doubts | None:
        """When beginning move e may not be safe; None: it always is."""
        if e not in self._moves:
            self._moves[e] = self._doubts(self.roadmap.numbers(e))
        return self._moves[e]

    def _doubts(self, mine: Ints) -> Doubts | None:
        a, b, squares = self._near(mine)
        if not len(a):
            return None
        first, still = self.first[b] - a, self.still[b]
        pairs = mine[a], *self._theirs(b)
        blocked = []
        if still.any():
            met = still.copy()
            met[still] = self.meetings.meet_near(
                self.kind, pairs[0][still], pairs[1], pairs[2][still]
            )
            last = np.where(self.last[b] == INF, INF, self.last[b] - a)
            ranges = zip(first[met].tolist(), last[met].tolist(), strict=True)
            blocked = [r for r in ranges if r[1] >= 0]
        moving = np.flatnonzero(~still)
        moving = moving[np.lexsort((squares[moving], first[moving]))]
        if not blocked and not len(moving):
            return None
        rows = first[moving], pairs[0][moving], pairs[2][moving]
        return Doubts(self.meetings, (self.kind, self.timed.kind), blocked, *rows)

    def _theirs(self, entries: Ints) -> tuple[int, Ints]:
        return self.timed.kind, self.steps[entries]

    def _near(self, mine: Ints) -> tuple[Ints, Ints, Floats]:
        """Places in `mine`, of steps, and entries, whose balls overlap, and their middles' squared
        distances (m^2): arrays (n,)."""
        table = self.roadmap.steps
        a, b = table.center[mine] - self._middle, self._at
        squares = (a * a).sum(1)[:, None] + self._squares
        squares -= 2.0 * (a @ b.T)
        reach = table.radius[mine][:, None] + self._reach
        one, two = np.nonzero(squares <= reach * reach)
        return one, two, squares[one, two]

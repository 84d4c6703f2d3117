"""One robot after another, each among the tracks of those before; who finds no way rips others up.

Who rips another's track up goes before him from then on, as in H. Ma et al., "Searching with
consistent prioritization for multi-agent path finding", 2019, but without going back on it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from fgenv.planners.roadmap.motion_table import GONE
from fgenv.planners.sipp.dynamic_obstacles import Timed
from fgenv.planners.sipp.sipp import Effort, Track, sipp

from .conflicts import Clashes
from .constraints import Ban, Banned
from .roadmap_set import Tables

HOLDS = (1.0, 2.0, 0.0, 4.0)  # seconds that who is not planned yet is left at his start: by order
STATES = 3000  # of one robot's search
RIPS = 4  # for each robot, in the mean


class Priorities:
    """Plans robots in an order.

    Args:
        given: timed paths that are kept.
        bans: what robots must not do.
        greed: of `sipp`.
    """

    def __init__(
        self,
        tables: Tables,
        effort: Effort,
        given: Mapping[int, Timed],
        bans: Mapping[int, Sequence[Ban]],
        greed: float = 1.0,
    ) -> None:
        self.tables, self.effort, self.given, self.bans = tables, effort, given, bans
        self.clashes, self.greed = Clashes(tables), greed

    def attempt(self, order: Sequence[int], hold: int) -> tuple[dict[int, Track], int | None]:
        """Tracks by this order, and the robot at which it failed, if it did.

        Robots still to come are left in peace at their starts for `hold` steps: they need time to
        get out of the way.
        """
        line, tracks = list(order), dict[int, Track]()
        before: dict[int, set[int]] = {i: set() for i in order}  # who goes before whom
        rips = RIPS * len(line)
        while line:
            i = line.pop(0)
            waiting = [self._waiting(j, hold) for j in line] if hold else []
            track = self.track(i, tracks, waiting)
            if track is None and rips > 0:
                kept = {j: tracks[j] for j in _all_before(i, before) if j in tracks}
                track = self.track(i, kept, waiting) or self.track(i, kept, [])
                if track is not None:
                    ripped = self._ripped(i, track, tracks)
                    rips -= len(ripped)
                    for j in ripped:
                        before[j].add(i)
                        del tracks[j]
                    line = ripped + line
            if track is None:
                return tracks, i
            tracks[i] = track
        return tracks, None

    def order(self) -> list[int]:
        """First those whose goals are in nobody's way, and whose starts are in many's; then those
        with long ways."""
        tables = self.tables
        robots = [i for i in range(len(tables.kinds)) if i not in self.given]
        free = {i: t for i in robots if (t := self.track(i, {})) is not None}
        in_way = {i: self._in_way(tables.goals[i], i, free) for i in robots if tables.park}
        out_of = {i: self._in_way(tables.starts[i], i, free) for i in robots}
        score = {i: in_way.get(i, 0) - out_of[i] for i in robots}
        return sorted(robots, key=lambda i: (score[i], -tables.least(i), i))

    def _in_way(self, v: int, i: int, tracks: Mapping[int, Track]) -> int:
        """How many of the tracks robot i meets if it stays at vertex v."""
        kinds, meet = self.tables.kinds, self.tables.meetings.meet
        others = [(kinds[j], t.steps) for j, t in tracks.items() if j != i]
        return sum(bool(meet(kinds[i], np.full(len(s), v), k, s).any()) for k, s in others)

    def track(
        self, i: int, others: Mapping[int, Track], waiting: Iterable[Timed] = ()
    ) -> Track | None:
        """Robot i's soonest track among others."""
        tables = self.tables
        seen = [*self.given.values(), *(tables.timed(j, t) for j, t in others.items()), *waiting]
        safe = Banned(tables.traffic(i, seen), self.bans.get(i, ()))
        return sipp(
            tables.roadmap(i),
            tables.starts[i],
            tables.goals[i],
            safe,
            self.effort,
            park=tables.park,
            release=safe.release,
            states=STATES,
            greed=self.greed,
        )

    def _ripped(self, i: int, track: Track, tracks: Mapping[int, Track]) -> list[int]:
        met = self.clashes.among(i, {**tracks, i: track})
        return sorted({j for pair in met for j in pair if j != i})

    def _waiting(self, j: int, steps: int) -> Timed:
        key = j, steps
        if key not in self.tables.waiting:
            start = np.full(steps, self.tables.starts[j], dtype=np.int64)
            self.tables.waiting[key] = Timed(self.tables.kinds[j], start, GONE)
        return self.tables.waiting[key]


def _all_before(i: int, before: Mapping[int, set[int]]) -> list[int]:
    """Those that go before robot i, and before those."""
    found: set[int] = set()
    todo = [i]
    while todo:
        new = before.get(todo.pop(), set()) - found
        found |= new
        todo += new
    return sorted(found)

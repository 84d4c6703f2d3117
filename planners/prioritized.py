"""Prioritized planning: one robot after another, among the timed paths of those before.

M. Erdmann and T. Lozano-Perez, "On multiple moving objects", 1987; on roadmaps, by safe intervals.
Where a robot finds no way, it goes to the front and all is planned anew.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .errors import PlanningError
from .many import Tables, Timetable
from .moves import GONE, Floats
from .others import Timed
from .sipp import Effort, Track, sipp

if TYPE_CHECKING:
    from .problem import Problem

HOLDS = (
    0.0,
    1.0,
    2.0,
    4.0,
)  # seconds that robots which are not yet planned are left at their starts


def prioritized(
    problem: Problem,
    time_limit: float = 10.0,
    *,
    order: Sequence[int] | None = None,
    restarts: int | None = None,
    fixed: dict[int, Floats] | None = None,
    tables: Tables | None = None,
) -> Timetable:
    """Timed paths for all robots, planned one after another.

    Same problem, same result, unless the time limit cuts the search short.

    Args:
        time_limit: seconds.
        order: robots, first to last; those with the longest ways first if left out.
        restarts: orders to try beside the first; as many as there is time for if left out.
        fixed: timed paths (k + 1, nq) of robots that keep them; they are met as they move.
        tables: of this problem, of an earlier search.

    Raises:
        PlanningError: no way found in time: `best` is a Timetable, of those that have one in the
            best order, for others to go on from. Or starts or goals are in collision.
    """
    effort = Effort(time.monotonic() + time_limit)
    tables = tables or Tables(problem)
    tables.check()
    kept = {i: tables.given(i, path) for i, path in (fixed or {}).items()}
    search = _Search(tables, effort, kept)
    line = list(order) if order is not None else search.longest_first()
    best, tried = search.run(line, restarts)
    paths = tuple(tables.path(i, best[i]) if i in best else None for i in range(len(tables.kinds)))
    found = Timetable(paths, tables.stats(effort, restarts=tried))
    if not found.complete:
        raise PlanningError(_reason(problem, found, time_limit, effort.late()), found)
    return found


class _Search:
    """Orders tried one after the other."""

    def __init__(self, tables: Tables, effort: Effort, kept: dict[int, Timed]) -> None:
        self.tables, self.effort, self.kept = tables, effort, kept
        self.robots = [i for i in range(len(tables.kinds)) if i not in kept]

    def longest_first(self) -> list[int]:
        """Robots by the length of their way."""
        return sorted(self.robots, key=lambda i: -self.tables.least(i))

    def run(self, line: list[int], restarts: int | None) -> tuple[dict[int, Timed], int]:
        """The best that any order gave, and how many were tried beside the first."""
        rng = np.random.default_rng(self.tables.problem.seed)
        best: dict[int, Timed] = {}
        seen, tried = set(), 0
        while True:
            hold = HOLDS[tried % len(HOLDS)] if tried else HOLDS[1]
            done, failed = self.attempt(line, hold)
            if len(done) > len(best):
                best = done
            if failed is None or self.effort.late() or tried == restarts:
                return best, tried
            tried += 1
            seen.add(tuple(line))
            line = [failed, *(i for i in line if i != failed)]
            if tuple(line) in seen:
                line = [int(i) for i in rng.permutation(line)]

    def attempt(self, line: list[int], hold: float) -> tuple[dict[int, Timed], int | None]:
        """Timed paths by this order, up to the first robot that finds none, and which that is.

        Those still to come are left in peace at their starts for some seconds: they need time to
        get out of the way.
        """
        tables, done = self.tables, dict(self.kept)
        steps = round(hold / tables.problem.dt)
        for place, i in enumerate(line):
            waiting = [self._waiting(j, steps) for j in line[place + 1 :]] if steps else []
            track = self.alone(i, [*done.values(), *waiting])
            if track is None:
                return done, i
            done[i] = tables.timed(i, track)
        return done, None

    def alone(self, i: int, others: Sequence[Timed]) -> Track | None:
        """Robot i's soonest track among others."""
        tables, roadmap = self.tables, self.tables.roadmap(i)
        ends = tables.starts[i], tables.goals[i]
        return sipp(roadmap, *ends, tables.traffic(i, others), self.effort, park=tables.park)

    def _waiting(self, j: int, steps: int) -> Timed:
        start = np.full(steps, self.tables.starts[j], dtype=np.int64)
        return Timed(self.tables.kinds[j], start, GONE)


def _reason(problem: Problem, found: Timetable, time_limit: float, late: bool) -> str:
    missing = ", ".join(problem.names[i] for i in found.missing)
    why = f"within {time_limit:g} s" if late else f"in {found.stats.restarts + 1} orders"
    done = len(found.paths) - len(found.missing)
    return (
        f"prioritized: no way for all {len(found.paths)} robots {why}; the best order left {missing}"
        f" without one, {done} have theirs; give more time, or take conflict_based or composite"
    )

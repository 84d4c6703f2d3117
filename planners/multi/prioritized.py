"""Prioritized planning: one robot after another, among the timed paths of those before.

M. Erdmann and T. Lozano-Perez, "On multiple moving objects", 1987; on roadmaps, by safe intervals.
Who finds no way rips others' paths up; where that does not help, all is planned anew, in another
order.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats
from fgenv.planners.errors import PlanningError
from fgenv.planners.sipp.sipp import Effort, Track

from .priorities import HOLDS, Priorities
from .roadmap_set import Tables
from .timetable import Timetable

if TYPE_CHECKING:
    from fgenv.planners.problem import Problem

GREED = 1.5  # of single robots' searches


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
        order: robots, first to last; if left out, those in nobody's way at their goals first.
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
    tracks, tried = _tried(tables, Priorities(tables, effort, kept, {}, GREED), order, restarts)
    best = kept | {i: tables.timed(i, track) for i, track in tracks.items()}
    paths = tuple(tables.path(i, best[i]) if i in best else None for i in range(len(tables.kinds)))
    found = Timetable(paths, tables.stats(effort, restarts=tried))
    if not found.complete:
        raise PlanningError(_reason(problem, found, time_limit, effort.late()), found)
    return found


def _tried(
    tables: Tables, search: Priorities, order: Sequence[int] | None, restarts: int | None
) -> tuple[dict[int, Track], int]:
    """The best that any order gave, and how many were tried beside the first."""
    rng = np.random.default_rng(tables.problem.seed)
    line = search.order() if order is None else list(order)
    best: dict[int, Track] = {}
    seen, tried = set(), 0
    while True:
        hold = HOLDS[tried % len(HOLDS)]
        tracks, failed = search.attempt(line, round(hold / tables.problem.dt))
        if len(tracks) > len(best):
            best = tracks
        if failed is None or search.effort.late() or tried == restarts:
            return best, tried
        tried += 1
        seen.add(tuple(line))
        line = [failed, *(i for i in line if i != failed)]
        if tuple(line) in seen:
            line = [int(i) for i in rng.permutation(line)]


def _reason(problem: Problem, found: Timetable, time_limit: float, late: bool) -> str:
    missing = ", ".join(problem.names[i] for i in found.missing)
    why = f"within {time_limit:g} s" if late else f"in {found.stats.restarts + 1} orders"
    done = len(found.paths) - len(found.missing)
    return (
        f"prioritized: no way for all {len(found.paths)} robots {why}; the best order left"
        f" {missing} without one, {done} have theirs; give more time, or take conflict_based or"
        " composite"
    )

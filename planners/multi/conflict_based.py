"""Conflict-based search on roadmaps: paths for each alone, and bans where two of them meet.

G. Sharon et al., "Conflict-based search for optimal multi-agent pathfinding", 2015, with the
constraints of A. Andreychuk et al., 2019, in whole steps; bounded suboptimality as in J. Li et al.,
"EECBS", 2021; bypasses as in E. Boyarski et al., "Don't split, try to work it out", 2015. No
maintained library of multi-agent path finding takes roadmaps with moving geometry: they want grids.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from fgenv.arrays import Floats
from fgenv.planners.errors import PlanningError
from fgenv.planners.sipp.dynamic_obstacles import Timed
from fgenv.planners.sipp.sipp import Effort

from .conflict_tree import Node, Search
from .roadmap_set import Tables
from .timetable import Timetable

if TYPE_CHECKING:
    from fgenv.planners.problem import Problem

Knot = Callable[[tuple[int, ...], float], Sequence[Floats]]
KNOT = 20  # so often do two robots meet in the search before they are solved jointly
SHARE = 0.3  # of the time that is left, for a knot


def conflict_based(
    problem: Problem,
    time_limit: float = 10.0,
    *,
    suboptimality: float = 2.0,
    knot: Knot | None = None,
    tables: Tables | None = None,
) -> Timetable:
    """Timed paths for all robots; the sum of their arrival times is bounded.

    Same problem, same result, unless the time limit cuts the search short.

    Args:
        time_limit: seconds.
        suboptimality: how many times the best cost on the roadmaps the sum of arrivals may be; 1:
            optimal. Where a knot was solved jointly, that holds for the others alone. If time runs
            out, the best that there is may cost more.
        knot: joint timed paths (k + 1, nq) of some robots, given a time limit, for those that meet
            again and again; the others then go around them. It may raise PlanningError.
        tables: of this problem, of an earlier search.

    Raises:
        PlanningError: no way found in time: `best` is a Timetable of those robots that do not meet
            in the best node, for others to go on from. Or starts or goals are in collision.
    """
    if not suboptimality >= 1.0:
        raise ValueError(f"suboptimality: got {suboptimality}, expected 1 or more")
    effort = Effort(time.monotonic() + time_limit)
    tables = tables or Tables(problem)
    tables.check()
    tied = _Tied(tables, effort, suboptimality, knot)
    node = tied.run()
    found = tied.timetable(node)
    if not found.complete:
        raise PlanningError(_reason(problem, found, time_limit, effort.late()), found)
    return found


class _Tied:
    """Searches, and knots in between, until there are no more."""

    def __init__(
        self, tables: Tables, effort: Effort, suboptimality: float, knot: Knot | None
    ) -> None:
        self.tables, self.effort, self.knot = tables, effort, knot
        self.suboptimality = suboptimality
        self.paths: dict[int, Floats] = {}  # of robots in knots
        self.groups: list[tuple[int, ...]] = []
        self.nodes = 0

    def run(self) -> Node | None:
        """The best node."""
        given: dict[int, Timed] = {}
        while True:
            limit = KNOT if self.knot is not None else 0
            search = Search(self.tables, self.effort, self.suboptimality, given, limit)
            node = search.run()
            self.nodes += search.nodes
            if search.knotted is None or not self._joined(search.knotted):
                return node
            given = {i: self.tables.given(i, path) for i, path in self.paths.items()}

    def _joined(self, robots: tuple[int, ...]) -> bool:
        """Whether these, with all of the knots that they are in, have joint paths now."""
        assert self.knot is not None
        touched = [g for g in self.groups if set(g) & set(robots)]
        group = tuple(sorted(set(robots).union(*touched)))
        left = self.effort.deadline - time.monotonic()
        if left <= 0:
            return False
        try:
            paths = self.knot(
                group, left * (1.0 if len(group) == len(self.tables.kinds) else SHARE)
            )
        except PlanningError:
            return False
        self.paths.update(zip(group, paths, strict=True))
        self.groups = [g for g in self.groups if g not in touched] + [group]
        return True

    def timetable(self, node: Node | None) -> Timetable:
        """Paths of a node; of robots that meet others as few as can be are left out."""
        out: set[int] = set()
        if node is not None:
            for pair in node.clashes:
                if not out & set(pair):
                    out.add(max(pair, key=lambda i: sum(i in p for p in node.clashes)))
        tracks = {} if node is None else node.tracks
        paths = tuple(
            self.paths[i]
            if i in self.paths
            else self.tables.path(i, self.tables.timed(i, tracks[i]))
            if i in tracks and i not in out
            else None
            for i in range(len(self.tables.kinds))
        )
        stats = self.tables.stats(self.effort, nodes=self.nodes, knots=tuple(self.groups))
        return Timetable(paths, stats)


def _reason(problem: Problem, found: Timetable, time_limit: float, late: bool) -> str:
    missing = ", ".join(problem.names[i] for i in found.missing)
    why = f"within {time_limit:g} s" if late else "on these roadmaps"
    done = len(found.paths) - len(found.missing)
    return (
        f"conflict_based: no way for all {len(found.paths)} robots {why}"
        f" ({found.stats.nodes} nodes); without {missing} the others, {done}, do not meet;"
        " give more time, a greater suboptimality, or take composite"
    )

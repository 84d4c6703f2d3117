"""Planning in a priority order: each robot among the paths of the robots before it.

A robot without a path replaces the paths of robots that conflict with it (rip-up and reroute), and
has priority over them from then on, as in H. Ma et al., "Searching with consistent prioritization
for multi-agent path finding" (PBS), AAAI 2019, but without backtracking.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fgenv.planners.sipp.dynamic_obstacles import TimedPath
from fgenv.planners.sipp.sipp import RoadmapPath, SearchBudget

from .conflicts import conflicts_of
from .constraints import Constraint
from .roadmap_set import RoadmapSet

HOLD_TIMES = (1.0, 2.0, 0.0, 4.0)  # s; robots not yet planned block their starts for so long
MAX_STATES = 3000  # of a single-robot search
RIP_UPS = 4  # per robot, on average


@dataclass(eq=False)
class PriorityPlanner:
    """Plans robots in a priority order.

    Args:
        fixed: timed paths of robots that keep them.
        constraints: constraints of each robot.
        weight: of the heuristic, see `sipp`.
    """

    roadmaps: RoadmapSet
    budget: SearchBudget
    fixed: Mapping[int, TimedPath]
    constraints: Mapping[int, Sequence[Constraint]]
    weight: float = 1.0

    def plan(self, order: Sequence[int], hold: float) -> tuple[dict[int, RoadmapPath], int | None]:
        """Plan robots in an order.

        Args:
            order: robots, highest priority first.
            hold: seconds for which robots not yet planned block their starts, so that they have
                time to leave.

        Returns:
            Paths by robot, and the robot that has no path, or None.
        """
        steps = round(hold / self.roadmaps.problem.dt)
        queue, paths = list(order), dict[int, RoadmapPath]()
        above: dict[int, set[int]] = {i: set() for i in order}  # robots with priority over i
        rip_ups = RIP_UPS * len(queue)
        while queue:
            i = queue.pop(0)
            waiting = [self.roadmaps.waiting(j, steps) for j in queue] if steps else []
            path = self.plan_robot(i, paths, waiting)
            if path is None and rip_ups > 0:
                kept = {j: paths[j] for j in _closure(i, above) if j in paths}
                path = self.plan_robot(i, kept, waiting) or self.plan_robot(i, kept)
                if path is not None:
                    ripped = self._conflicting(i, {**paths, i: path})
                    rip_ups -= len(ripped)
                    for j in ripped:
                        above[j].add(i)
                        del paths[j]
                    queue = ripped + queue
            if path is None:
                return paths, i
            paths[i] = path
        return paths, None

    def initial_order(self) -> list[int]:
        """Order by robots blocked at the goal minus those blocked at the start, then by length."""
        roadmaps = self.roadmaps
        robots = [i for i in range(len(roadmaps.kinds)) if i not in self.fixed]
        alone = {i: path for i in robots if (path := self.plan_robot(i, {})) is not None}
        at_goal = {i: self._blocked(roadmaps.goals[i], i, alone) for i in robots if roadmaps.stay}
        at_start = {i: self._blocked(roadmaps.starts[i], i, alone) for i in robots}
        score = {i: at_goal.get(i, 0) - at_start[i] for i in robots}
        return sorted(robots, key=lambda i: (score[i], -roadmaps.shortest(i), i))

    def _blocked(self, v: int, i: int, paths: Mapping[int, RoadmapPath]) -> int:
        """Number of paths that collide with robot i if it stays at vertex v."""
        kinds, collide = self.roadmaps.kinds, self.roadmaps.pairs.collide
        others = [(kinds[j], path.motions) for j, path in paths.items() if j != i]
        return sum(bool(collide(kinds[i], np.full(len(m), v), k, m).any()) for k, m in others)

    def plan_robot(
        self, i: int, paths: Mapping[int, RoadmapPath], waiting: Iterable[TimedPath] = ()
    ) -> RoadmapPath | None:
        """Earliest path of robot i among the fixed paths, other paths and waiting robots."""
        timed = (self.roadmaps.timed(j, path) for j, path in paths.items())
        obstacles = self.roadmaps.intervals(i, [*self.fixed.values(), *timed, *waiting])
        options = {"max_states": MAX_STATES, "weight": self.weight}
        constraints = self.constraints.get(i, ())
        return self.roadmaps.plan(i, obstacles, constraints, self.budget, **options)

    def _conflicting(self, i: int, paths: Mapping[int, RoadmapPath]) -> list[int]:
        """Robots with paths that conflict with that of robot i."""
        return sorted({j for pair in conflicts_of(self.roadmaps, i, paths) for j in pair if j != i})


def _closure(i: int, above: Mapping[int, set[int]]) -> list[int]:
    """Robots with direct or indirect priority over robot i."""
    closure: set[int] = set()
    todo = [i]
    while todo:
        new = above.get(todo.pop(), set()) - closure
        closure |= new
        todo += new
    return sorted(closure)

"""Prioritized planning: one robot after another, among the timed paths of those before.

M. Erdmann and T. Lozano-Perez, "On multiple moving objects", Algorithmica 1987; here on roadmaps,
by safe intervals, with rip-up and with restarts in other priority orders.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.planners.deadline import Deadline
from fgenv.planners.problem import Problem
from fgenv.planners.sipp.sipp import RoadmapPath, SearchBudget

from .priorities import HOLD_TIMES, PriorityPlanner
from .roadmap_set import RoadmapSet
from .solution import Solution

WEIGHT = 1.5  # of the heuristic of single-robot searches


def plan_prioritized(
    problem: Problem,
    time_limit: float = 10.0,
    *,
    order: Sequence[int] | None = None,
    restarts: int | None = None,
    fixed: dict[int, Floats] | None = None,
    roadmaps: RoadmapSet | None = None,
) -> Solution:
    """Plan timed paths for all robots, one after another.

    The same problem gives the same result, unless the time limit ends the search.

    Args:
        time_limit: seconds.
        order: robots, highest priority first; see `PriorityPlanner.initial_order` for the default.
        restarts: number of orders after the first; unlimited by default.
        fixed: timed paths (k + 1, nq) of robots that keep them, as dynamic obstacles.
        roadmaps: of the same problem, from an earlier search.

    Raises:
        PlanningError: starts or goals collide, or no solution is found. In the second case `best`
            is the Solution of the best order.
    """
    budget = SearchBudget(Deadline.after(time_limit))
    roadmaps = roadmaps or RoadmapSet(problem, budget.deadline)
    roadmaps.check()
    timed = {i: roadmaps.add_path(i, path) for i, path in (fixed or {}).items()}
    planner = PriorityPlanner(roadmaps, budget, timed, {}, WEIGHT)
    paths, tried = _best_order(planner, order, restarts)
    timed |= {i: roadmaps.timed(i, path) for i, path in paths.items()}
    solution = Solution(
        tuple(
            roadmaps.configurations(i, timed[i]) if i in timed else None
            for i in range(len(problem.names))
        ),
        roadmaps.stats(budget, restarts=tried),
    )
    if not solution.complete:
        effort = f"within {time_limit:g} s" if budget.expired() else f"in {tried + 1} orders"
        remedy = "conflict_based or composite"
        raise solution.error(problem.names, "prioritized", effort, remedy)
    return solution


def _best_order(
    planner: PriorityPlanner, order: Sequence[int] | None, restarts: int | None
) -> tuple[dict[int, RoadmapPath], int]:
    """Paths of the order that plans most robots, and the number of restarts.

    The robot that failed comes first in the next order; an order that was tried before is
    replaced by a random one.
    """
    rng = np.random.default_rng(planner.roadmaps.problem.seed)
    queue = planner.initial_order() if order is None else list(order)
    best: dict[int, RoadmapPath] = {}
    seen, tried = set(), 0
    while True:
        paths, failed = planner.plan(queue, HOLD_TIMES[tried % len(HOLD_TIMES)])
        if len(paths) > len(best):
            best = paths
        if failed is None or planner.budget.expired() or tried == restarts:
            return best, tried
        tried += 1
        seen.add(tuple(queue))
        queue = [failed, *(i for i in queue if i != failed)]
        if tuple(queue) in seen:
            queue = [int(i) for i in rng.permutation(queue)]

"""Conflict-based search (CBS) on roadmaps.

G. Sharon et al., "Conflict-based search for optimal multi-agent pathfinding", Artificial
Intelligence 2015, with the constraints of A. Andreychuk et al., "Multi-agent pathfinding with
continuous time", IJCAI 2019, in whole steps. Libraries for multi-agent path finding are not used
since they need grids; roadmaps with moving geometry are not supported by any maintained one.
"""

from __future__ import annotations

from fgenv.planners.deadline import Deadline
from fgenv.planners.problem import Problem
from fgenv.planners.sipp.sipp import SearchBudget

from .meta_agents import JointPlanner, MetaAgentSearch
from .roadmap_set import RoadmapSet
from .solution import Solution


def plan_conflict_based(
    problem: Problem,
    time_limit: float = 10.0,
    *,
    suboptimality: float = 2.0,
    joint_planner: JointPlanner | None = None,
    roadmaps: RoadmapSet | None = None,
) -> Solution:
    """Plan timed paths for all robots with a bounded sum of costs.

    The same problem gives the same result, unless the time limit ends the search.

    Args:
        time_limit: seconds.
        suboptimality: bound on the sum of costs, relative to the optimum on the roadmaps; 1:
            optimal. With meta-agents the bound holds for the other robots. If time runs out, the
            best solution so far may cost more.
        joint_planner: returns joint timed paths (k + 1, nq) of a meta-agent's robots, given a time
            limit in seconds; it may raise PlanningError. The other robots then avoid the
            meta-agent.
        roadmaps: of the same problem, from an earlier search.

    Raises:
        PlanningError: starts or goals collide, or no solution is found. In the second case `best`
            is a Solution of robots without conflicts.
    """
    if not suboptimality >= 1.0:
        raise ValueError(f"suboptimality: got {suboptimality}, expected 1 or more")
    budget = SearchBudget(Deadline.after(time_limit))
    roadmaps = roadmaps or RoadmapSet(problem, budget.deadline)
    roadmaps.check()
    solution = MetaAgentSearch(roadmaps, budget, suboptimality, joint_planner).run()
    if not solution.complete:
        effort = f"within {time_limit:g} s" if budget.expired() else "on these roadmaps"
        effort += f" ({solution.stats.nodes} nodes)"
        remedy = "a greater suboptimality or composite"
        raise solution.error(problem.names, "conflict_based", effort, remedy)
    return solution

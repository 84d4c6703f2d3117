"""Planning methods: how the timed paths of a problem's robots are found."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from typing import Any, NamedTuple

import numpy as np

from fgenv.arrays import Floats

from .deadline import Deadline
from .errors import PlanningError
from .multi.composite import plan_composite
from .multi.conflict_based import plan_conflict_based
from .multi.prioritized import plan_prioritized
from .multi.roadmap_set import RoadmapSet
from .multi.solution import Solution
from .problem import Problem
from .timing import steps_together

STRAIGHT = 1e-6  # m or rad; changes of consecutive steps that differ less are equal
PRIORITIZED_SHARE = 0.85  # of the time left, before robots without a path are planned jointly
LEAST_TIME = 0.01  # s


class TimedPaths(NamedTuple):
    """Result of a method.

    Attributes:
        configurations: of each robot at each step, (k + 1, nq).
        waypoints: of each robot's path before timing, (m, nq).
        facts: plain values about the search.
    """

    configurations: Sequence[Floats]
    waypoints: Sequence[Floats]
    facts: dict[str, Any]


def composite(problem: Problem, time_limit: float, options: dict[str, Any]) -> TimedPaths:
    """Search in the joint space of all robots."""
    route = plan_composite(problem, time_limit=time_limit, **options)
    timed = steps_together(problem.models, route.paths, problem.dt)
    return TimedPaths(timed, route.paths, dict(route.facts))


def prioritized(problem: Problem, time_limit: float, options: dict[str, Any]) -> TimedPaths:
    """Plan one robot after another; robots without a path are planned jointly, before the others.

    Robots that then have no path join the group, until it contains all robots.
    """
    deadline = Deadline.after(time_limit)
    group: set[int] = set()
    fixed: dict[int, Floats] = {}
    roadmaps = RoadmapSet(problem, deadline)
    while True:
        share = PRIORITIZED_SHARE * _time_left(deadline)
        try:
            solution = plan_prioritized(problem, share, fixed=fixed, roadmaps=roadmaps)
            break
        except PlanningError as error:
            missing = () if error.best is None else error.best.missing
            if not missing or deadline.left < 0:
                raise
            group |= set(missing)
        paths = _plan_jointly(problem, group, _time_left(deadline), options)
        fixed = dict(zip(sorted(group), paths, strict=True))
    together = [problem.names[i] for i in sorted(group)]
    return _timed_paths(solution, together=together)


def conflict_based(problem: Problem, time_limit: float, options: dict[str, Any]) -> TimedPaths:
    """Conflict-based search; robots with many conflicts are planned jointly."""

    def joint_planner(group: tuple[int, ...], limit: float) -> Sequence[Floats]:
        return _plan_jointly(problem, group, limit, options)

    return _timed_paths(plan_conflict_based(problem, time_limit, joint_planner=joint_planner))


# By name. Options are keyword arguments of `plan_composite`.
METHODS: dict[str, Callable[[Problem, float, dict[str, Any]], TimedPaths]] = {
    "composite": composite,
    "prioritized": prioritized,
    "conflict_based": conflict_based,
}


def _time_left(deadline: Deadline) -> float:
    return max(deadline.left, LEAST_TIME)


def _plan_jointly(
    problem: Problem, group: Iterable[int], time_limit: float, options: dict[str, Any]
) -> list[Floats]:
    """Timed paths of a group of robots in their joint space, without the other robots."""
    robots = sorted(group)
    world = problem.world_with(*robots)
    route = plan_composite(problem, robots, time_limit=time_limit, world=world, **options)
    return steps_together([problem.models[i] for i in robots], route.paths, problem.dt)


def _timed_paths(solution: Solution, **facts: Any) -> TimedPaths:
    paths = [path for path in solution.paths if path is not None]
    return TimedPaths(paths, [corners(path) for path in paths], {**asdict(solution.stats), **facts})


def corners(q: Floats) -> Floats:
    """Rows of configurations at steps (k + 1, nq) at which the velocity changes, and both ends."""
    change = np.diff(q, axis=0)
    turns = (np.abs(np.diff(change, axis=0)) > STRAIGHT).any(axis=1)
    return q[np.concatenate([[True], turns, [True]])] if len(q) > 1 else q

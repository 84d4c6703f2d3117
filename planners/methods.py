"""Plans for scenarios: by a method and a planner, timed, and proved."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.scenarios import Scenario
from fgenv.scenarios.errors import near

from .certificate import certify
from .errors import PlanningError
from .limits import wrong_with
from .plan import Plan, padded
from .problem import Problem
from .timing import steps_together

STRAIGHT = 1e-6  # m or rad, of two steps that are alike
EXTRA = (0.0, 0.005, 0.02)  # meters of margin while planning, where the timed path is not proved


def plan(
    scenario: str | Path | Scenario | Problem,
    planner: str = "RRTConnect",
    time_limit: float = 10.0,
    seed: int = 0,
    simplify: bool = True,
    *,
    method: str | None = None,
    margin: float = 0.0,
    objective: str | None = None,
    **overrides: Any,
) -> Plan:
    """Plan all robots of a scenario from their starts to their goals, and prove the plan.

    The timed motion of all robots at once, as it will be executed, is proved free with `margin`
    meters to spare; `plan.certificate` says so, and how near they come.

    Args:
        scenario: a name, a file, a Scenario.
        planner: of OMPL, see `fgenv.planners.PLANNERS`; of the methods that search by one.
        time_limit: seconds.
        seed: of all that is random, also of a built-in scenario that is given by its name. The
            same seed gives the same plan, unless time runs out.
        simplify: shorten what the planner found, and prove it again.
        method: see `fgenv.planners.METHODS`: `composite`, `prioritized`, `conflict_based`; if left
            out composite for one robot, prioritized for more.
        margin: meters that are kept from everything.
        objective: `length`, `clearance` or `time`, of a planner that looks for the best path.
        overrides: for `Scenario.load`.

    Raises:
        PlanningError: no plan: why, and the best so far where there is something to show.
        ValueError: an argument makes no sense.
    """
    problem = Problem.of(scenario, margin, seed, **overrides)
    if method is None:
        method = "composite" if len(problem.names) == 1 else "prioritized"
    if method not in METHODS:
        raise ValueError(f"method: {method!r} is not known; {near(method, METHODS)}")
    if not 0 < time_limit < math.inf:
        raise ValueError(f"time_limit: got {time_limit}, expected finite seconds over 0")
    problem.check()
    began = time.perf_counter()
    for extra in EXTRA:
        left = time_limit - (time.perf_counter() - began)
        careful = replace(problem, margin=problem.margin + extra)
        options = {"planner": planner, "simplify": simplify, "objective": objective}
        paths, way_points, facts = METHODS[method](careful, max(left, 0.01), options)
        configurations = padded(paths)
        certificate = certify(problem, configurations)
        if certificate:
            break
    else:
        raise PlanningError(
            f"the timed paths found are not free at step {certificate.failed}: give more margin"
        )
    for i, q in enumerate(configurations):
        wrong = wrong_with(problem, i, q)
        if wrong is not None:
            raise PlanningError(f"{problem.names[i]!r} {wrong}: what was found cannot be driven")
    facts = json.loads(json.dumps({**facts, "seconds": time.perf_counter() - began}))
    return Plan(
        problem.scenario,
        configurations,
        tuple(way_points),
        method,
        planner,
        problem.seed,
        certificate,
        facts,
    )


Found = tuple[Sequence[Floats], Sequence[Floats], dict[str, Any]]  # steps, way points, facts
SHARE = 0.85  # of the time, for robots one by one before some are taken together


def by_composite(problem: Problem, time_limit: float, options: dict[str, Any]) -> Found:
    """One search in the joint space of all robots."""
    from fgenv.planners.multi.composite import composite

    route = composite(problem, time_limit=time_limit, **options)
    return steps_together(problem.models, route.paths, problem.dt), route.paths, dict(route.facts)


def by_prioritized(problem: Problem, time_limit: float, options: dict[str, Any]) -> Found:
    """One robot after another; those that find no way are planned together, and before the rest.

    Who finds none then joins them, until all go together.
    """
    from fgenv.planners.multi.prioritized import prioritized
    from fgenv.planners.multi.roadmap_set import Tables

    end = time.monotonic() + time_limit
    together: set[int] = set()
    fixed: dict[int, Floats] = {}
    tables = Tables(problem)
    while True:
        left = max(end - time.monotonic(), 0.01)
        try:
            found = prioritized(problem, SHARE * left, fixed=fixed, tables=tables)
            break
        except PlanningError as error:
            missing = () if error.best is None else error.best.missing
            if not missing or time.monotonic() > end:
                raise
            together |= set(missing)
        left = max(end - time.monotonic(), 0.01)
        fixed = dict(zip(sorted(together), _joint(problem, together, left, options), strict=True))
    facts = {**asdict(found.stats), "together": [problem.names[i] for i in sorted(together)]}
    return *_timetable(found.paths), facts


def by_conflicts(problem: Problem, time_limit: float, options: dict[str, Any]) -> Found:
    """Conflict-based search; robots that stay in each other's way are planned together."""
    from fgenv.planners.multi.conflict_based import conflict_based

    def knot(group: tuple[int, ...], limit: float) -> Sequence[Floats]:
        return _joint(problem, group, limit, options)

    found = conflict_based(problem, time_limit, knot=knot)
    return *_timetable(found.paths), asdict(found.stats)


def _joint(
    problem: Problem, group: Iterable[int], time_limit: float, options: dict[str, Any]
) -> list[Floats]:
    """Timed paths of some robots in their joint space, as if there were no others."""
    from fgenv.planners.multi.composite import composite

    which = sorted(group)
    world = problem.alone(*which)
    route = composite(problem, which, time_limit=time_limit, world=world, **options)
    return steps_together([problem.models[i] for i in which], route.paths, problem.dt)


def _timetable(paths: Sequence[Floats | None]) -> tuple[list[Floats], list[Floats]]:
    steps = [path for path in paths if path is not None]
    return steps, [corners(path) for path in steps]


def corners(q: Floats) -> Floats:
    """Of configurations at steps (k + 1, nq) those at which the motion changes, ends included."""
    change = np.diff(q, axis=0)
    turns = (np.abs(np.diff(change, axis=0)) > STRAIGHT).any(axis=1)
    return q[np.concatenate([[True], turns, [True]])] if len(q) > 1 else q


METHODS: dict[str, Callable[[Problem, float, dict[str, Any]], Found]] = {
    "composite": by_composite,
    "prioritized": by_prioritized,
    "conflict_based": by_conflicts,
}

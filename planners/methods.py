"""Plans for scenarios: by a method and a planner, timed, and proved."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv.scenarios import Scenario
from fgenv.scenarios.trouble import near

from .certificate import certify
from .errors import PlanningError
from .plans import Plan, padded
from .problem import Problem
from .timing import steps_together

Floats = NDArray[np.float64]

EXTRA = (0.0, 0.005, 0.02)  # metres of margin while planning, where the timed path is not proved


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
    metres to spare; `plan.certificate` says so, and how near they come.

    Args:
        scenario: a name, a file, a Scenario.
        planner: of OMPL, see `fgenv.planners.PLANNERS`; of the methods that search by one.
        time_limit: seconds.
        seed: of all that is random. The same seed gives the same plan, unless time runs out.
        simplify: shorten what the planner found, and prove it again.
        method: see `fgenv.planners.METHODS`: `composite`, `prioritized`, `conflict_based`; if left
            out composite for one robot, prioritized for more.
        margin: metres that are kept from everything.
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
    if not time_limit > 0:
        raise ValueError(f"time_limit: {time_limit}, wanted seconds over 0")
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
    facts["seconds"] = time.perf_counter() - began
    return Plan(
        problem.scenario,
        configurations,
        tuple(way_points),
        method,
        planner,
        seed,
        certificate,
        facts,
    )


Found = tuple[Sequence[Floats], Sequence[Floats], dict[str, Any]]  # steps, way points, facts


def by_composite(problem: Problem, time_limit: float, options: dict[str, Any]) -> Found:
    """One search in the joint space of all robots."""
    from .solve import composite

    route = composite(problem, time_limit=time_limit, **options)
    return steps_together(problem.models, route.paths, problem.dt), route.paths, dict(route.facts)


METHODS: dict[str, Callable[[Problem, float, dict[str, Any]], Found]] = {
    "composite": by_composite,
}

"""Planning of scenarios: a method finds timed paths, which are then certified."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from fgenv.arrays import Floats
from fgenv.robots.links_joints import number_of
from fgenv.scenarios import Scenario
from fgenv.scenarios.errors import near

from .certificate import Certificate, certify
from .errors import PlanningError
from .limits import path_fault
from .methods import LEAST_TIME, METHODS, TimedPaths
from .multi.composite import PLANNERS
from .plan import Plan, padded
from .problem import Problem

EXTRA_MARGINS = (0.0, 0.005, 0.02)  # m; added in later attempts if the timed paths are not free


def plan(
    scenario: str | Path | Scenario | Problem,
    planner: str | None = None,
    time_limit: float = 10.0,
    seed: int = 0,
    simplify: bool = True,
    *,
    method: str | None = None,
    margin: float = 0.0,
    objective: str | None = None,
    **overrides: Any,
) -> Plan:
    """Plan all robots of a scenario from their starts to their goals, and certify the plan.

    The certificate is of the timed motion of all robots at once, as it is executed; see
    `Plan.certificate`.

    Args:
        scenario: a Scenario, its name or its file.
        planner: OMPL planner of the method `composite`, see `fgenv.planners.PLANNERS`; RRTConnect
            by default. The other methods search roadmaps of their own.
        time_limit: seconds.
        seed: of the search, and of a built-in scenario that is given by its name. The same seed
            gives the same plan, unless time runs out.
        simplify: shorten the planner's path, and check it again; False only with `composite`.
        method: `composite`, `prioritized` or `conflict_based`; by default composite for one robot,
            prioritized for more.
        margin: meters that robots keep from all bodies and from each other.
        objective: `length`, `clearance` or `time`, for an optimizing planner of `composite`.
        overrides: for `Scenario.load`.

    Raises:
        PlanningError: no plan was found; `best` is a partial result where there is one.
        ValueError: invalid argument.
    """
    problem = Problem.from_scenario(scenario, margin, seed, **overrides)
    if method is None:
        method = "composite" if len(problem.names) == 1 else "prioritized"
    if method not in METHODS:
        raise ValueError(f"method: got {method!r}, which is unknown; {near(method, METHODS)}")
    if number_of(time_limit, "time_limit", finite=True) <= 0:
        raise ValueError(f"time_limit: got {time_limit}, expected finite seconds over 0")
    options = _search_options(method, planner, simplify, objective)
    problem.check()
    began = time.perf_counter()
    found, configurations, certificate = _certified(problem, method, time_limit, options)
    for i, q in enumerate(configurations):
        wrong = path_fault(problem, i, q)
        if wrong is not None:
            raise PlanningError(f"{problem.names[i]!r} {wrong}: the path cannot be driven")
    return Plan(
        problem.scenario,
        configurations,
        tuple(found.waypoints),
        method,
        options["planner"],
        problem.seed,
        certificate,
        json.loads(json.dumps({**found.facts, "seconds": time.perf_counter() - began})),
    )


def _search_options(
    method: str, planner: str | None, simplify: bool, objective: str | None
) -> dict[str, Any]:
    """Return the options of `plan_composite`; raise ValueError for one without effect."""
    if method != "composite":
        options = (("planner", planner, None), ("simplify", simplify, True))
        for name, value, default in (*options, ("objective", objective, None)):
            if value != default:
                raise ValueError(
                    f"{name}: got {value!r} with the method {method!r}, which does not use it;"
                    " leave it out, or use method='composite'"
                )
    if planner is not None and planner not in PLANNERS:
        raise ValueError(f"planner: got {planner!r}, which is unknown; {near(planner, PLANNERS)}")
    return {"planner": planner or "RRTConnect", "simplify": simplify, "objective": objective}


def _certified(
    problem: Problem, method: str, time_limit: float, options: dict[str, Any]
) -> tuple[TimedPaths, tuple[Floats, ...], Certificate]:
    """Result of the method with configurations that are certified; else PlanningError."""
    end = time.perf_counter() + time_limit
    for extra in EXTRA_MARGINS:
        left = max(end - time.perf_counter(), LEAST_TIME)
        found = METHODS[method](replace(problem, margin=problem.margin + extra), left, options)
        configurations = padded(found.configurations)
        certificate = certify(problem, configurations)
        if certificate:
            return found, configurations, certificate
    raise PlanningError(
        f"the timed paths are not free at step {certificate.failed_step}; use a larger margin"
    )

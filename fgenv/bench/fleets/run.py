"""Plans all cases of a frozen set."""

from __future__ import annotations

from collections.abc import Iterator
from time import process_time
from typing import Any

import numpy as np

from fgenv.planners import PlanningError, Problem
from fgenv.planners.planning import plan
from fgenv.scenarios import FrozenSet, Scenario, frozen

from .sets import Fleet

Record = dict[str, Any]


def bench_fleets(fleets: tuple[Fleet, ...], cases: int) -> Iterator[Record]:
    """One record for each fleet and method."""
    for fleet in fleets:
        chosen = frozen(fleet.scenario, cases=cases, **fleet.overrides)
        for method in fleet.methods:
            yield row(fleet, method, chosen)


def row(fleet: Fleet, method: str, cases: FrozenSet) -> Record:
    """Results of one method: share of solved cases, CPU seconds, makespan, reasons of failures."""
    done = [attempt(case, method, fleet.limit) for case in cases]
    solved = [one for one in done if one["solved"]]
    middle = {
        name: median([one[name] for one in solved])
        for name in ("seconds", "search", "makespan", "sum_of_costs", "least")
    }
    return {
        "fleet": fleet.name,
        "method": method,
        "set": cases.id,
        "cases": len(cases),
        "limit": fleet.limit,
        "solved": len(solved),
        **middle,
        "p95": float(np.quantile([one["seconds"] for one in done], 0.95)),
        "failed": [one["why"] for one in done if not one["solved"]],
    }


def median(values: list[float | None]) -> float | None:
    """Of those that were measured."""
    known = [value for value in values if value is not None]
    return float(np.median(known)) if known else None


def attempt(case: Scenario, method: str, limit: float) -> Record:
    """One case. What reads the scenario is not counted; timing and the proof of the plan are."""
    problem = Problem.from_scenario(case)
    began = process_time()
    try:
        found = plan(problem, time_limit=limit, method=method)
    except PlanningError as error:
        return {"solved": False, "seconds": process_time() - began, "why": str(error)}
    return {
        "solved": bool(found.certificate),
        "seconds": process_time() - began,
        "search": found.facts.get("search"),
        "makespan": found.makespan,
        "sum_of_costs": found.sum_of_costs,
        "least": found.certificate.clearance,
    }

"""Plans for all cases of the frozen sets."""

from __future__ import annotations

from collections.abc import Iterator
from time import process_time

import numpy as np

from fgenv.bench.common.records import Record
from fgenv.planners import PlanningError, Problem
from fgenv.planners.planning import plan
from fgenv.scenarios import FrozenSet, Scenario, frozen

from .sets import Fleet


def bench_fleets(fleets: tuple[Fleet, ...], cases: int) -> Iterator[Record]:
    """Yield one record per fleet and method."""
    for fleet in fleets:
        frozen_set = frozen(fleet.scenario, cases=cases, **fleet.overrides)
        for method in fleet.methods:
            yield row(fleet, method, frozen_set)


def row(fleet: Fleet, method: str, cases: FrozenSet) -> Record:
    """Return the results of one method: solved cases, medians, reasons of failures."""
    attempts = [attempt(case, method, fleet.limit) for case in cases]
    solved = [result for result in attempts if result["solved"]]
    medians = {
        name: median([result[name] for result in solved])
        for name in ("seconds", "search", "makespan", "sum_of_costs", "least")
    }
    return {
        "fleet": fleet.name,
        "method": method,
        "set": cases.id,
        "cases": len(cases),
        "limit": fleet.limit,
        "solved": len(solved),
        **medians,
        "p95": float(np.quantile([result["seconds"] for result in attempts], 0.95)),
        "failed": [result["why"] for result in attempts if not result["solved"]],
    }


def median(values: list[float | None]) -> float | None:
    """Return the median of the measured values; None if there are none."""
    known = [value for value in values if value is not None]
    return float(np.median(known)) if known else None


def attempt(case: Scenario, method: str, limit: float) -> Record:
    """Return the result of one case.

    The time includes timing and certification of the plan, not the reading of the scenario.
    """
    problem = Problem.from_scenario(case)
    began = process_time()
    try:
        result = plan(problem, time_limit=limit, method=method)
    except PlanningError as error:
        return {"solved": False, "seconds": process_time() - began, "why": str(error)}
    return {
        "solved": bool(result.certificate),
        "seconds": process_time() - began,
        "search": result.facts.get("search"),
        "makespan": result.makespan,
        "sum_of_costs": result.sum_of_costs,
        "least": result.certificate.clearance,
    }

"""MotionBenchMaker's problems for the Panda: fgenv certified against pinocchio and coal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

import numpy as np

from fgenv.bench.common.records import Record
from fgenv.bench.common.timing import rotated
from fgenv.planners.problem import Problem
from fgenv.scenarios.library.mbm import Family

from .methods import ARM, CERTIFIED, plugin, python_checker
from .search import Progress, SearchResult, path_check, run, seeded, warm_up

FAMILIES: tuple[str, ...] = get_args(Family)
LIMIT = 20.0  # seconds


def race_family(
    family: str, numbers: Sequence[int], seed: int, limit: float, report_progress: Progress
) -> Record:
    """Return the record of a family: one search per problem; the order of checkers rotates."""
    from .arm import ArmTask, arm_bodies  # needs pinocchio and coal

    results: dict[str, list[SearchResult]] = {ARM: [], CERTIFIED: []}
    hidden = dict.fromkeys(results, 0)
    for turn, number in enumerate(numbers):
        name = f"{family} {number}"
        task = ArmTask(name, Problem.from_scenario("mbm", family=family, problem=number))
        bind = arm_bodies(task)
        methods = {ARM: python_checker(task, bind), CERTIFIED: plugin(task.problem)}
        collides = path_check(task, bind)
        for checker in rotated(list(methods), turn):
            report_progress(f"{name}, {checker}")
            warm_up(methods[checker], seed, 1e-3)
            result = run(seeded(methods[checker], seed), limit)
            results[checker].append(result)
            hidden[checker] += result.path is not None and collides(result.path)
    records = {name: record_of(results[name], hidden[name]) for name in (CERTIFIED, ARM)}
    return {"family": family, "limit": limit, "ways": records}


def record_of(results: Sequence[SearchResult], hidden: int) -> Record:
    """Return the searches of one method, a problem each."""
    return {
        "seconds": [result.seconds for result in results],
        "solved": [result.path is not None for result in results],
        "motions": [result.motions for result in results],
        "hidden": int(hidden),
    }


def family_statistics(records: Sequence[Record]) -> dict[str, Record]:
    """Return statistics by method over the problems of some families.

    `solved` is a share; `median` and `p95` are seconds, where a failed search took for ever: None.
    """
    statistics = {}
    for name in records[0]["ways"]:
        methods = [record["ways"][name] for record in records]
        solved, seconds, motions = (
            np.concatenate([method[key] for method in methods])
            for key in ("solved", "seconds", "motions")
        )
        quantiles = np.quantile(np.where(solved, seconds, np.inf), (0.5, 0.95), method="higher")
        median, p95 = (float(q) if np.isfinite(q) else None for q in quantiles)
        statistics[name] = {
            "problems": len(solved),
            "solved": float(solved.mean()),
            "median": median,
            "p95": p95,
            "motions": float(np.median(motions)),
            "hidden": sum(method["hidden"] for method in methods),
        }
    return statistics

"""One problem of free bodies, all methods, all seeds: a record for JSON, times in seconds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fgenv.bench.common.records import Record
from fgenv.bench.common.timing import rotated

from .fcl_ import fcl_bodies
from .methods import CERTIFIED, DISCRETE, FCL, Method, methods_of
from .recording import record_checks, run_floor
from .replay import replay
from .search import Progress, SearchResult, path_check, run, seeded, warm_up
from .task import Task

RECORDED = 3  # searches with edges that are checked again


def race_task(
    task: Task,
    peers: Sequence[str],
    seeds: Sequence[int],
    limit: float,
    report_progress: Progress,
) -> Record:
    """Return all measurements of one problem; `report_progress` receives progress messages."""
    methods = methods_of(task, peers)
    results = solve_all(methods, seeds, limit, report_progress)
    record = task_record(task, limit, results)
    own = {s: r for s, r in zip(seeds, results[CERTIFIED], strict=True) if r.path is not None}
    if own:
        report_progress("cost of OMPL itself")
        method = methods[CERTIFIED]
        recordings = {seed: record_checks(method, seed, limit) for seed in own}
        floors = [run_floor(method, seed, limit, r) for seed, r in recordings.items()]
        record["floor"] = floor_record(list(own.values()), floors)
        report_progress("the same edges")
        record["edges"] = replay(methods, list(recordings.values())[:RECORDED], seeds[0])
    record["ratio"] = ratios(record)
    return record


def race_trap(task: Task, seeds: Sequence[int], limit: float, report_progress: Progress) -> Record:
    """Return the searches of a hard problem: certified, and by python-fcl."""
    methods = methods_of(task, [FCL])
    del methods[DISCRETE]
    return task_record(task, limit, solve_all(methods, seeds, limit, report_progress))


def task_record(task: Task, limit: float, results: Mapping[str, Sequence[SearchResult]]) -> Record:
    """Return the problem and the statistics of each method."""
    collides = path_check(task, fcl_bodies(task))
    return {
        "problem": task.name,
        "robots": len(task.movers),
        "triangles": [len(task.movers[0].faces), sum(len(m.faces) for m in task.obstacles)],
        "resolution": task.resolution,
        "limit": limit,
        "ways": {name: statistics(runs, collides) for name, runs in results.items()},
    }


def solve_all(
    methods: Mapping[str, Method], seeds: Sequence[int], limit: float, report_progress: Progress
) -> dict[str, list[SearchResult]]:
    """Search with all methods on each seed; their order rotates."""
    results: dict[str, list[SearchResult]] = {name: [] for name in methods}
    for method in methods.values():
        warm_up(method, seeds[0], 0.02)
    for turn, seed in enumerate(seeds):
        for name in rotated(list(methods), turn):
            report_progress(f"seed {seed}, {name}")
            results[name].append(run(seeded(methods[name], seed), limit))
    return results


def statistics(results: Sequence[SearchResult], collides: Callable[[Any], bool]) -> Record:
    """Return medians over seeds (a failed search took for ever), and hidden collisions."""
    paths = [result.path for result in results if result.path is not None]
    seconds = [result.seconds for result in results]
    motions, states = ([getattr(r, key) for r in results] for key in ("motions", "states"))
    solved = [r.seconds if r.path is not None else np.inf for r in results]
    median = float(np.median(solved))
    return {
        "solved": len(paths),
        "of": len(results),
        "seconds": median if np.isfinite(median) else None,
        "all_seconds": seconds,
        "motions": float(np.median(motions)),
        "states": float(np.median(states)),
        "motions_per_second": sum(motions) / sum(seconds),
        "states_per_second": sum(states) / sum(seconds),
        "hidden": sum(collides(path) for path in paths),
    }


def floor_record(own: Sequence[SearchResult], floors: Sequence[SearchResult]) -> Record:
    """Return the cost of the searches with known verdicts, and of the checks above it."""
    motions = sum(result.motions for result in own)
    seconds, least = (np.array([r.seconds for r in results]) for results in (own, floors))
    return {
        "seconds": float(np.median(least)),
        "per_motion": float(least.sum() / motions),
        "times": float(np.median(seconds / least)),
        "check": float((seconds.sum() - least.sum()) / motions),
    }


def ratios(record: Record) -> dict[str, float]:
    """Return speed-ups over python-fcl: to the first solution, and for equal edges."""
    own, fcl = (record["ways"].get(name) for name in (CERTIFIED, FCL))
    result: dict[str, float] = {}
    if fcl and fcl["seconds"] and own["seconds"]:
        result["solution"] = fcl["seconds"] / own["seconds"]
    kinds = {"all": "check_all", "free": "check_free", "hit": "check_hit", "states": "states"}
    for kind, key in kinds.items():
        seconds = record.get("edges", {}).get(kind)
        if fcl and seconds:
            result[key] = seconds[FCL] / seconds[DISCRETE]
    return result

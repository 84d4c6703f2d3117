"""One problem of free bodies, every way, all seeds: a record for JSON, times in seconds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from .edges import floor, recorded
from .fcl_ import fcl_bodies
from .replay import replay
from .search import Found, judge_of, run, seeded
from .task import Task
from .ways import CERTIFIED, DISCRETE, FCL, Way, ways_of

Record = dict[str, Any]
RECORDED = 3  # searches with edges that are checked again
Told = Callable[[str], None]


def race_task(
    task: Task, peers: Sequence[str], seeds: Sequence[int], limit: float, report_progress: Told
) -> Record:
    """All measurements of one problem; `report_progress` receives progress messages."""
    ways = ways_of(task, list(peers))
    found = solve_all(task, ways, seeds, limit, report_progress)
    judge = judge_of(task, fcl_bodies(task))
    record = about(task, limit)
    record["ways"] = {name: summed(runs, judge) for name, runs in found.items()}
    certified = found[CERTIFIED]
    solved = [seed for seed, one in zip(seeds, certified, strict=True) if one.path is not None]
    if solved:
        report_progress("the floor")
        known = [recorded(ways[CERTIFIED], seed, limit) for seed in solved]
        least = [floor(ways[CERTIFIED], s, limit, k) for s, k in zip(solved, known, strict=True)]
        own = [one for one in certified if one.path is not None]
        record["floor"] = floored(own, least)
        report_progress("edges once more")
        record["edges"] = replay(ways, known[:RECORDED], seeds[0])
    record["ratio"] = ratios(record)
    return record


def race_trap(task: Task, seeds: Sequence[int], limit: float, report_progress: Told) -> Record:
    """How many seeds solve it: certified, and by python-fcl."""
    ways = {k: way for k, way in ways_of(task, [FCL]).items() if k != DISCRETE}
    found = solve_all(task, ways, seeds, limit, report_progress)
    judge = judge_of(task, fcl_bodies(task))
    return about(task, limit) | {
        "ways": {name: summed(runs, judge) for name, runs in found.items()}
    }


def about(task: Task, limit: float) -> Record:
    """The problem."""
    return {
        "problem": task.name,
        "robots": len(task.movers),
        "triangles": [len(task.movers[0].faces), sum(len(m.faces) for m in task.standing)],
        "resolution": task.resolution,
        "limit": limit,
    }


def solve_all(
    task: Task, ways: Mapping[str, Way], seeds: Sequence[int], limit: float, report_progress: Told
) -> dict[str, list[Found]]:
    """All checkers on each seed; their order rotates."""
    found: dict[str, list[Found]] = {name: [] for name in ways}
    names = list(ways)
    for way in ways.values():
        run(seeded(way, seeds[0]), 0.02, shorten=False)  # the first touch pays for caches
    for k, seed in enumerate(seeds):
        for name in names[k % len(names) :] + names[: k % len(names)]:
            report_progress(f"seed {seed}, {name}")
            found[name].append(run(seeded(ways[name], seed), limit))
    return found


def summed(runs: Sequence[Found], judge: Callable[[Any], bool]) -> Record:
    """Medians over seeds (a search that failed took for ever), and what the judge sees."""
    paths = [one.path for one in runs if one.path is not None]
    seconds = [one.seconds if one.path is not None else np.inf for one in runs]
    spent = sum(one.seconds for one in runs)
    middle = float(np.median(seconds))
    return {
        "solved": len(paths),
        "of": len(runs),
        "seconds": middle if np.isfinite(middle) else None,
        "all_seconds": [one.seconds for one in runs],
        "motions": float(np.median([one.motions for one in runs])),
        "states": float(np.median([one.states for one in runs])),
        "motions_per_second": sum(one.motions for one in runs) / spent,
        "states_per_second": sum(one.states for one in runs) / spent,
        "hidden": sum(judge(path) for path in paths),
    }


def floored(own: Sequence[Found], least: Sequence[Found]) -> Record:
    """The same searches with their answers known, and what a motion took of the real ones."""
    motions = sum(one.motions for one in own)
    both = [sum(one.seconds for one in some) for some in (own, least)]
    return {
        "seconds": float(np.median([one.seconds for one in least])),
        "per_motion": both[1] / motions,
        "times": float(np.median([a.seconds / b.seconds for a, b in zip(own, least, strict=True)])),
        "check": (both[0] - both[1]) / motions,
    }


def ratios(record: Record) -> dict[str, float]:
    """How many times less CPU than python-fcl: to the first solution, and for equal edges."""
    own, other = (record["ways"].get(name) for name in (CERTIFIED, FCL))
    out: dict[str, float] = {}
    if other and other["seconds"] and own["seconds"]:
        out["solution"] = other["seconds"] / own["seconds"]
    if other and "edges" in record:
        for kind in ("all", "free", "hit"):
            if kind in record["edges"]:
                took = record["edges"][kind]
                out[f"check_{kind}"] = took[FCL] / took[DISCRETE]
        took = record["edges"]["states"]
        out["states"] = took[FCL] / took[DISCRETE]
    return out

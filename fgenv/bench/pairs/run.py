"""``fgenv bench pairs``: fgenv against its peers on pairs of real meshes."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator, Sequence
from time import perf_counter
from typing import Any

import numpy as np

from fgenv.bench.common.poses import NEAR, USUAL
from fgenv.bench.common.timing import race
from fgenv.bench.pairs.catalog import chosen
from fgenv.bench.pairs.race import PairRace, Record
from fgenv.bench.peers import peer

REFERENCE = "python-fcl"


def bench_pairs(
    *,
    which: str = "all",
    peers: Sequence[str],
    poses: int = 4000,
    seed: int = 0,
    near: bool = False,
    threads: bool = True,
) -> Iterator[Record]:
    """Yield one record a pair, times in seconds.

    `which`: all, quick or part of a name; `near`: only poses within a tenth of the size from
    contact, down to a ten-millionth; `threads`: also race two threads against one.
    """
    racing = [peer(name) for name in peers]
    for index, pair in enumerate(chosen(which)):
        rng = np.random.default_rng([seed, index])
        at = PairRace(pair, racing, poses, rng, NEAR if near else USUAL)
        record = at.run()
        if "fgenv" in peers and threads:
            record["threads_2"] = _two_threads(at)
        if "fgenv" in peers:
            record["ratio"] = ratios(record)
        yield record


def ratios(record: Record, reference: str = REFERENCE) -> dict[str, float]:
    """How many times fgenv is faster (for build: how many times as long, so under 1 is good)."""
    own, other = record["peers"]["fgenv"], record["peers"].get(reference)
    if other is None:
        return {}
    found = {kind: other["batch"][kind] / own["batch"][kind] for kind in own["batch"]}
    # One call from a NumPy pose against one call from a NumPy pose, loop of Python and all.
    found["call"] = other["call"]["mean"] / own["call"]["mean"]
    found["p99"] = other["call"]["p99"] / own["call"]["p99"]
    found["build"] = own["build"] / other["build"]
    if "distance" in own and "distance" in other:
        found["distance"] = other["distance"] / own["distance"]
    return found


def _two_threads(at: PairRace) -> float:
    """How many times two threads are faster than one on a large batch."""
    from fgenv.collision import collide

    a, b = at.models["fgenv"]
    poses = np.tile(at.poses, (-(-20_000 // len(at.poses)), 1, 1))
    jobs = {str(n): (lambda some, n=n: collide(a, at.pose_a, b, some, threads=n)) for n in (1, 2)}
    chunks = race(jobs, poses, rounds=5, budget=30.0, chunk=20_000, clock=perf_counter)
    return chunks["1"] / chunks["2"]


def summary(records: list[Record]) -> dict[str, dict[str, float]]:
    """Geometric mean and worst of every ratio over the pairs."""
    kinds = sorted({kind for record in records for kind in record.get("ratio", {})})
    found = {}
    for kind in kinds:
        values = [record["ratio"][kind] for record in records if kind in record["ratio"]]
        worst = max(values) if kind == "build" else min(values)
        found[kind] = {"mean": float(np.exp(np.mean(np.log(values)))), "worst": worst}
    return found


def machine() -> dict[str, Any]:
    """What the numbers were taken on."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "numpy": np.__version__,
    }


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            return next(line.split(":", 1)[1].strip() for line in lines if "model name" in line)
    except (OSError, StopIteration):
        return platform.processor() or "unknown"

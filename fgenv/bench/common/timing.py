"""Timing on a machine that others use as well: small chunks, peers in turn, medians over rounds.

Batches are timed in CPU seconds of the process, which leave out what other programs took away.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Mapping
from time import perf_counter_ns, process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Poses

Job = Callable[[Poses], Any]
Clock = Callable[[], float]  # seconds
CHUNK = 250  # poses; a chunk is short beside what the scheduler grants


def race(
    jobs: Mapping[str, Job],
    poses: Poses,
    rounds: int = 5,
    budget: float = 4.0,
    *,
    chunk: int = CHUNK,
    clock: Clock = process_time,
) -> dict[str, float]:
    """Mean seconds a pose of each job, on the same poses (n, 4, 4).

    Each `chunk` of poses is timed `rounds` times, jobs alternating and their order turning; its
    median stands for it. A job that would take over `budget` seconds gets only the first poses.
    """
    share = {name: _affordable(job, poses, budget / rounds, clock) for name, job in jobs.items()}
    medians: dict[str, list[float]] = {name: [] for name in jobs}
    sizes: dict[str, list[int]] = {name: [] for name in jobs}
    for start in range(0, len(poses), chunk):
        some = poses[start : start + chunk]
        racing = [name for name in jobs if share[name] > start]
        runs: dict[str, list[float]] = {name: [] for name in racing}
        for turn in range(rounds):
            for name in racing[turn % len(racing) :] + racing[: turn % len(racing)]:
                runs[name].append(_once(jobs[name], some[: share[name] - start], clock))
        for name in racing:
            medians[name].append(float(np.median(runs[name])))
            sizes[name].append(min(len(some), share[name] - start))
    return {name: float(np.average(medians[name], weights=sizes[name])) for name in jobs}


def _affordable(job: Job, poses: Poses, budget: float, clock: Clock) -> int:
    few = poses[:5]
    _once(job, few, clock)  # the first touch pays for caches and lazy set-up
    return int(np.clip(budget / (_once(job, few, clock) + 1e-12), 10, len(poses)))


def _once(job: Job, some: Poses, clock: Clock) -> float:
    began = clock()
    job(some)
    return (clock() - began) / len(some)


def each_call(call: Job, poses: Poses) -> NDArray[np.float64]:
    """Seconds of every single call (n,), less what an empty call costs; the least of three runs."""
    gc.disable()  # a collection inside a call would be charged to it
    try:
        least = np.min([_stamps(call, poses) for _ in range(3)], axis=0)
        empty = np.median(_stamps(lambda _: False, poses))
    finally:
        gc.enable()
    return np.asarray(np.maximum(least - empty, 0.0) * 1e-9)


def _stamps(call: Job, poses: Poses) -> NDArray[np.int64]:
    stamps = np.empty(len(poses), np.int64)
    for i, pose in enumerate(poses):
        began = perf_counter_ns()
        call(pose)
        stamps[i] = perf_counter_ns() - began
    return stamps


def build_seconds(builds: Mapping[str, Callable[[], Any]], rounds: int = 5) -> dict[str, float]:
    """Median CPU seconds of each build, builds alternating."""
    runs: dict[str, list[float]] = {name: [] for name in builds}
    for _ in range(rounds):
        for name, build in builds.items():
            began = process_time()
            build()
            runs[name].append(process_time() - began)
    return {name: float(np.median(times)) for name, times in runs.items()}

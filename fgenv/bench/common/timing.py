"""Timing on a machine with other load: short runs, methods in turn, medians over rounds.

Runs are timed in CPU seconds of the process, which exclude the time of other programs.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from functools import partial
from time import perf_counter_ns, process_time
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats, Poses

Key = TypeVar("Key", bound=Hashable)
Job = Callable[[Poses], Any]
Clock = Callable[[], float]  # seconds
CHUNK = 250  # poses; a chunk takes less time than a slice of the scheduler


def rotated(names: Sequence[Key], turn: int) -> list[Key]:
    """Return the names in the order of a turn: each turn starts one name later."""
    first = turn % max(len(names), 1)
    return [*names[first:], *names[:first]]


def take_turns(names: Sequence[Key], rounds: int) -> Iterator[Key]:
    """Yield each name once per round; the order rotates from round to round."""
    for turn in range(rounds):
        yield from rotated(names, turn)


def timed(job: Callable[[], object], clock: Clock = process_time) -> float:
    """Return the seconds of a call, without garbage collection."""
    gc.disable()  # a collection would be charged to the current job
    try:
        began = clock()
        job()
        return clock() - began
    finally:
        gc.enable()


def round_seconds(
    jobs: Mapping[Key, Callable[[], object]], rounds: int, *, clock: Clock = process_time
) -> dict[Key, Floats]:
    """Return the seconds of each job in each round, (rounds,); jobs take turns."""
    seconds: dict[Key, list[float]] = {name: [] for name in jobs}
    for name in take_turns(list(jobs), rounds):
        seconds[name].append(timed(jobs[name], clock))
    return {name: np.array(times) for name, times in seconds.items()}


def median_seconds(
    jobs: Mapping[Key, Callable[[], object]], rounds: int = 5, *, clock: Clock = process_time
) -> dict[Key, float]:
    """Return the median seconds of each job over the rounds."""
    seconds = round_seconds(jobs, rounds, clock=clock)
    return {name: float(np.median(times)) for name, times in seconds.items()}


def race(
    jobs: Mapping[str, Job],
    poses: Poses,
    rounds: int = 5,
    budget: float = 4.0,
    *,
    chunk: int = CHUNK,
    clock: Clock = process_time,
) -> dict[str, float]:
    """Return the mean seconds per pose of each job, on the same poses (n, 4, 4).

    Each `chunk` of poses is timed `rounds` times with the jobs in turn, and counts with its
    median. A job that would take over `budget` seconds gets only the first poses.
    """
    share = {
        name: affordable(job, poses, budget / rounds, least=10, trial=5, clock=clock)
        for name, job in jobs.items()
    }
    medians: dict[str, list[float]] = {name: [] for name in jobs}
    for start in range(0, len(poses), chunk):
        parts = {
            name: poses[start : min(start + chunk, last)]
            for name, last in share.items()
            if last > start
        }
        chunk_jobs = {name: partial(jobs[name], part) for name, part in parts.items()}
        for name, seconds in median_seconds(chunk_jobs, rounds, clock=clock).items():
            medians[name].append(seconds)
    return {name: sum(medians[name]) / share[name] for name in jobs}


def affordable(
    job: Callable[[NDArray[Any]], object],
    cases: NDArray[Any],
    budget: float,
    *,
    least: int,
    trial: int,
    clock: Clock = process_time,
) -> int:
    """Return how many of the cases (n, ...) a job does in `budget` seconds, at least `least`."""
    first = cases[:trial]
    job(first)  # the first call pays for caches and lazy set-up
    each = timed(lambda: job(first), clock) / max(len(first), 1)
    return int(np.clip(budget / (each + 1e-12), min(least, len(cases)), len(cases)))


def each_call(call: Job, poses: Poses) -> NDArray[np.float64]:
    """Return the seconds of each single call (n,), minimum of three runs.

    The cost of an empty call is subtracted.
    """
    gc.disable()  # a collection would be charged to the current call
    try:
        fastest = np.min([_call_times(call, poses) for _ in range(3)], axis=0)
        empty = np.median(_call_times(lambda _: False, poses))
    finally:
        gc.enable()
    return np.asarray(np.maximum(fastest - empty, 0.0) * 1e-9)


def _call_times(call: Job, poses: Poses) -> NDArray[np.int64]:
    times = np.empty(len(poses), np.int64)
    for i, pose in enumerate(poses):
        began = perf_counter_ns()
        call(pose)
        times[i] = perf_counter_ns() - began
    return times

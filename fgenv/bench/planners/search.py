"""One search by one method; its path is shortened and checked independently."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from time import process_time
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from fgenv.arrays import Floats

from .methods import Method, Search
from .rigid import Bind, verdicts
from .task import DiscreteTask

WALL = 20.0  # wall-clock limit over the CPU limit, for a loaded machine
ROUNDS = 4  # of shortening
FINER = 100  # factor of the resolution in the check of paths
Progress = Callable[[str], None]  # receives messages


@dataclass(frozen=True)
class SearchResult:
    """Result of a search.

    Attributes:
        seconds: CPU seconds of the process until the first solution, or the time limit.
        states, motions: numbers of checks. A certified motion counts no states.
        path: states (m, size) of the shortened solution, or None.
    """

    seconds: float
    states: int
    motions: int
    path: Floats | None


def seeded(method: Method, seed: int) -> Search:
    """Return a new search with seeded random numbers; OMPL ignores a seed of 0."""
    ou.RNG.setSeed(seed + 1)
    return method()


def warm_up(method: Method, seed: int, limit: float) -> None:
    """Run a first search, which pays for caches and lazy set-up."""
    run(seeded(method, seed), limit, shorten=False)


def run(search: Search, limit: float, shorten: bool = True) -> SearchResult:
    """Solve within `limit` CPU seconds of the process; OMPL's set-up is not timed."""
    search.simple.setup()
    before = search.validity.checks, search.motions
    with within(limit) as condition:
        began = process_time()
        search.simple.solve(condition)
        seconds = process_time() - began
    states, motions = search.validity.checks - before[0], search.motions - before[1]
    solved = search.simple.haveExactSolutionPath()
    return SearchResult(seconds, states, motions, shortened(search) if solved and shorten else None)


@contextmanager
def within(seconds: float) -> Iterator[Any]:
    """Provide a termination condition that holds after CPU seconds of the process.

    A signal sets it: polling a clock would be part of the measurement, and a timer of CPU time
    makes that clock coarse. Python code and fgenv's checks handle the signal. Main thread only.
    """
    condition = ob.timedPlannerTerminationCondition(WALL * seconds)
    began = process_time()

    def check_time(*_: object) -> None:
        left = began + seconds - process_time()
        if left > 0:
            signal.setitimer(signal.ITIMER_REAL, max(left, 1e-3))
        else:
            condition.terminate()

    before = signal.signal(signal.SIGALRM, check_time)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield condition
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def shortened(search: Search) -> Floats:
    """Return the solution, shortened by OMPL with the same steps for all methods."""
    path, simplifier = search.simple.getSolutionPath(), og.PathSimplifier(search.si)
    for _ in range(ROUNDS):
        simplifier.ropeShortcutPath(path)
        simplifier.reduceVertices(path)
        simplifier.partialShortcutPath(path)
    simplifier.reduceVertices(path)
    return states_of(search, path)


def states_of(search: Search, path: Any) -> Floats:
    """Return a path's states, (m, size)."""
    count = path.getStateCount()
    return np.array([search.buffer.read(path.getState(k)) for k in range(count)])


def path_check(task: DiscreteTask, bind: Bind) -> Callable[[Floats], bool]:
    """Return an independent check of paths (m, size), FINER times finer than the resolution."""
    row = np.empty(task.samples.shape[1])
    collides = bind(row)

    def path_collides(path: Floats) -> bool:
        for q0, q1 in pairwise(path):
            n = task.steps(q0, q1, task.resolution / FINER)
            if any(verdicts(collides, row, task.between(q0, q1, np.arange(n + 1) / n))):
                return True
        return False

    return path_collides

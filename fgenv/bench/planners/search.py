"""One search by one way, its path shortened and looked at by an independent judge."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from time import process_time
from typing import Any, Protocol

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from fgenv.arrays import Floats

from .rigid import Bind, asked
from .ways import Search, Way

WALL = 20.0  # times the limit by the wall's clock, where others load the machine
ROUNDS = 4  # of shortening
FINER = 100  # times, the judge's steps


@dataclass(frozen=True)
class Found:
    """What a search came to.

    Attributes:
        seconds: of CPU of the process until the first solution, or the end of time.
        states, motions: asked for. A motion certified counts no states.
        path: the shortened solution's states (m, size), or None.
    """

    seconds: float
    states: int
    motions: int
    path: Floats | None


def seeded(way: Way, seed: int) -> Search:
    """A new search with seeded random numbers; OMPL ignores a seed of 0."""
    ou.RNG.setSeed(seed + 1)
    return way()


def run(search: Search, limit: float, shorten: bool = True) -> Found:
    """Solve within `limit` CPU seconds of the process; OMPL's set-up is not timed, the rest is."""
    search.simple.setup()
    before = search.validity.checks, search.motions
    with within(limit) as condition:
        began = process_time()
        search.simple.solve(condition)
        seconds = process_time() - began
    states, motions = search.validity.checks - before[0], search.motions - before[1]
    solved = search.simple.haveExactSolutionPath()
    return Found(seconds, states, motions, shortened(search) if solved and shorten else None)


@contextmanager
def within(seconds: float) -> Iterator[Any]:
    """A termination condition that says so after CPU seconds of the process.

    A signal ends it: a clock that is polled would be part of the measurement, and a timer of
    CPU time makes that clock coarse. The signal is heard where Python code runs, and in fgenv's
    checks now and then. In the main thread only.
    """
    condition = ob.timedPlannerTerminationCondition(WALL * seconds)
    began = process_time()

    def look(*_: object) -> None:
        left = began + seconds - process_time()
        if left > 0:
            signal.setitimer(signal.ITIMER_REAL, max(left, 1e-3))
        else:
            condition.terminate()

    before = signal.signal(signal.SIGALRM, look)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield condition
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def shortened(search: Search) -> Floats:
    """The solution by OMPL's simplifier: counted steps, the same for all ways."""
    path, simplifier = search.simple.getSolutionPath(), og.PathSimplifier(search.si)
    for _ in range(ROUNDS):
        simplifier.ropeShortcutPath(path)
        simplifier.reduceVertices(path)
        simplifier.partialShortcutPath(path)
    simplifier.reduceVertices(path)
    return states_of(search, path)


def states_of(search: Search, path: Any) -> Floats:
    """A path's states, (m, size)."""
    count = path.getStateCount()
    return np.array([search.buffer.read(path.getState(k)) for k in range(count)])


Judge = Callable[[Floats], bool]  # whether a path (m, size) has a state that collides


class Moves(Protocol):
    """Data of a task for the independent judge."""

    @property
    def resolution(self) -> float:
        """Resolution of discrete checks, see `steps`."""

    @property
    def samples(self) -> Floats:
        """Some states, (k, size)."""

    def steps(self, q0: Floats, q1: Floats, step: float) -> int:
        """Steps of a motion between states (size,) that are no longer."""

    def between(self, q0: Floats, q1: Floats, t: Floats) -> Floats:
        """States (k, size) at fractions t (k,) of a motion."""


def judge_of(task: Moves, bind: Bind) -> Judge:
    """A library's look at a path, FINER times closer than the resolution."""
    row = np.empty(task.samples.shape[1])
    collides = bind(row)

    def judge(path: Floats) -> bool:
        for q0, q1 in pairwise(path):
            n = task.steps(q0, q1, task.resolution / FINER)
            if any(asked(collides, row, task.between(q0, q1, np.arange(n + 1) / n))):
                return True
        return False

    return judge

"""Batches of worlds that step together, with actions drawn beforehand."""

from __future__ import annotations

import gc
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.bench.common.timing import Clock

Record = dict[str, Any]  # for JSON
Step = Callable[[int], object]
ACTIONS = 64  # sets of actions drawn beforehand, used in turn


def nothing() -> None:
    """Worlds that start their episodes anew by themselves need no restart."""


@dataclass(frozen=True)
class Batch:
    """Worlds that step at once.

    Attributes:
        robots: in each world.
        worlds: how many.
        step: does step k, with set k of the actions; observations, rewards and ends come out.
        restart: starts all episodes anew; not timed.
    """

    robots: int
    worlds: int
    step: Step
    restart: Callable[[], object] = nothing

    @property
    def size(self) -> int:
        """Robot-steps in a step."""
        return self.robots * self.worlds


@dataclass(frozen=True)
class Peer:
    """A library that steps robots: `make(robots, worlds, seed)`.

    `needs`: its module; `batched`: whether it steps several worlds at once; `package`: its name
    for pip.
    """

    name: str
    package: str
    needs: str
    batched: bool
    make: Callable[[int, int, int], Batch]


def race(
    batches: Mapping[str, Batch],
    rounds: int = 9,
    seconds: float = 0.8,
    *,
    clock: Clock = process_time,
) -> dict[str, Floats]:
    """Seconds per robot-step of each batch in each round, (rounds,).

    A round has as many steps as take about `seconds`, at least one. Batches take turns, and their
    order rotates. Compare values of the same round: they were measured under the same load of the
    machine, which may double the time of a step.
    """
    steps = {name: _affordable(batch, seconds, clock) for name, batch in batches.items()}
    taken: dict[str, list[float]] = {name: [] for name in batches}
    names = list(batches)
    for turn in range(rounds):
        first = turn % len(names)
        for name in names[first:] + names[:first]:
            taken[name].append(_round(batches[name], steps[name], clock))
    return {name: np.array(times) for name, times in taken.items()}


def _affordable(batch: Batch, seconds: float, clock: Clock) -> int:
    """Number of steps that take `seconds`; doubles a trial until it can be timed."""
    _round(batch, 1, clock)  # the first touch pays for caches and lazy set-up
    steps = 1
    while (each := _round(batch, steps, clock) * batch.size) * steps < 0.1 * seconds:
        steps *= 2
    return max(1, round(seconds / each))


def _round(batch: Batch, steps: int, clock: Clock) -> float:
    batch.restart()
    gc.disable()  # a collection would be charged to the current batch
    try:
        began = clock()
        for k in range(steps):
            batch.step(k)
        return (clock() - began) / (steps * batch.size)
    finally:
        gc.enable()

"""Batches of worlds that step together, with actions drawn beforehand, and their timing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.bench.common.timing import Clock, take_turns, timed

Step = Callable[[int], object]
ACTIONS = 64  # sets of actions, used in turn


def no_restart() -> None:
    """Do nothing: the worlds restart their episodes by themselves."""


@dataclass(frozen=True)
class Batch:
    """Worlds that step at once.

    Attributes:
        robots: number of robots per world.
        worlds: number of worlds.
        step: runs step k with set k of the actions; returns observations, rewards and ends.
        restart: restarts all episodes; not timed.
    """

    robots: int
    worlds: int
    step: Step
    restart: Callable[[], object] = no_restart

    @property
    def size(self) -> int:
        """Robot-steps per step."""
        return self.robots * self.worlds


@dataclass(frozen=True)
class Library:
    """A library that steps robots.

    Attributes:
        name: of the row.
        package, module: names for pip and for `import`.
        batched: whether it steps several worlds at once.
        make: returns a batch for robots, worlds and a seed.
    """

    name: str
    package: str
    module: str
    batched: bool
    make: Callable[[int, int, int], Batch]


def race(
    batches: Mapping[str, Batch],
    rounds: int = 9,
    seconds: float = 0.8,
    *,
    clock: Clock = process_time,
) -> dict[str, Floats]:
    """Return the seconds per robot-step of each batch in each round, (rounds,).

    A round has as many steps as take about `seconds`, at least one. Batches take turns, and their
    order rotates. Compare values of the same round: they have the same load of the machine, which
    may double the time of a step.
    """
    steps = {name: _steps_in(batch, seconds, clock) for name, batch in batches.items()}
    times: dict[str, list[float]] = {name: [] for name in batches}
    for name in take_turns(list(batches), rounds):
        times[name].append(_round(batches[name], steps[name], clock))
    return {name: np.array(rows) for name, rows in times.items()}


def _steps_in(batch: Batch, seconds: float, clock: Clock) -> int:
    """Return the number of steps that take `seconds`; a trial doubles until it can be timed."""
    _round(batch, 1, clock)  # the first step pays for caches and lazy set-up
    steps = 1
    while (each := _round(batch, steps, clock) * batch.size) * steps < 0.1 * seconds:
        steps *= 2
    return max(1, round(seconds / each))


def _round(batch: Batch, steps: int, clock: Clock) -> float:
    """Return the seconds per robot-step."""

    def run() -> None:
        for k in range(steps):
            batch.step(k)

    batch.restart()
    return timed(run, clock) / (steps * batch.size)


def parallel_batch(env: Any, seed: int) -> Batch:
    """Return a `ParallelEnv` as a batch of one world.

    The episode restarts, which is timed, as soon as one of its agents is gone.
    """
    env.reset(seed=seed)
    agents = list(env.agents)
    for k, agent in enumerate(agents):
        env.action_space(agent).seed(seed + k)
    actions = [
        {agent: env.action_space(agent).sample() for agent in agents} for _ in range(ACTIONS)
    ]

    def step(k: int) -> object:
        result = env.step(actions[k % ACTIONS])
        if len(env.agents) < len(agents):
            env.reset()
        return result

    return Batch(len(agents), 1, step, lambda: env.reset(seed=seed))

"""The contract of a simulator."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from fgenv.envs import Simulator
from fgenv.envs.spaces import observation_box, state_box, state_of

from .laws import copies, equal, require, require_error

SEED = 7


class MakeSimulator(Protocol):
    """Makes a simulator with autoreset of given numbers of worlds and threads."""

    def __call__(self, *, worlds: int, threads: int) -> Simulator: ...


def simulator_test(make: MakeSimulator, steps: int = 60) -> None:
    """Test the contract of a simulator.

    - Equal seeds give equal episodes, bit for bit, for any number of threads.
    - World k of reset(seed=s) equals the single world of reset(seed=s + k).
    - Every observation and state is in its space; rewards are finite.
    - Copies in mid-episode continue identically, by copy, deepcopy and pickle.
    - An invalid action raises an error, and the state is unchanged.

    Args:
        make: called with worlds= and threads=.
        steps: of each rollout, which may contain several episodes.

    Raises:
        AssertionError: with the violated law.
    """
    one, two = make(worlds=3, threads=1), make(worlds=3, threads=2)
    rows = rollout(one, steps)
    require(equal(rows, rollout(one, steps)), "the same seed gave another rollout the second time")
    require(equal(rows, rollout(two, steps)), "two threads gave another rollout than one")
    for k in range(3):
        alone = rollout(make(worlds=1, threads=1), steps, SEED + k, world=k)
        part = [[x[k : k + 1] for x in step] for step in rows]
        require(equal(alone, part), f"world {k} is not the single world of seed + {k}")
    check_spaces(one, steps)
    check_copies(one)
    check_invalid_actions(one)


def action(simulator: Simulator, step: int, worlds: int = 3, world: int | None = None) -> Any:
    """Return random actions of a step; those of a world do not depend on the other worlds."""
    shape = (worlds, simulator.n_robots, simulator.action_size)
    drawn = np.random.default_rng(step // 8).uniform(-1.5, 1.5, shape)
    return drawn if world is None else drawn[world : world + 1]


def rollout(
    simulator: Simulator, steps: int, seed: int = SEED, world: int | None = None
) -> list[list[Any]]:
    """Return all arrays of a rollout."""
    arrays: list[list[Any]] = [[simulator.reset(seed=seed)]]
    for k in range(steps):
        done = simulator.step(action(simulator, k, world=world))
        arrays.append([*done, simulator.configurations, simulator.hits, simulator.checks])
    return arrays


def check_spaces(simulator: Simulator, steps: int) -> None:
    """Require each observation and state to be in its space."""
    boxes = [observation_box(simulator, i) for i in range(simulator.n_robots)]
    rows = simulator.reset(seed=SEED)
    for k in range(steps + 1):
        for (w, i), _ in np.ndenumerate(rows[..., 0]):
            row = rows[w, i, : simulator.observation_sizes[i]]
            name = simulator.names[i]
            require(boxes[i].contains(row), f"an observation of {name!r} is not in its space")
        require(state_box(simulator).contains(state_of(simulator)), "a state is not in its space")
        rows, rewards, *_ = simulator.step(action(simulator, k))
        require(bool(np.isfinite(rewards).all()), "a reward is not finite")


def check_copies(simulator: Simulator) -> None:
    """Require copies in mid-episode to continue identically, independent of the original."""
    simulator.reset(seed=SEED)
    for k in range(5):
        simulator.step(action(simulator, k))
    made = list(copies(simulator))
    steps = [simulator.step(action(simulator, 5 + k)) for k in range(10)]
    for name, other in made:
        again = [other.step(action(simulator, 5 + k)) for k in range(10)]
        require(equal(steps, again), f"a {name} in mid-episode continues differently")


def check_invalid_actions(simulator: Simulator) -> None:
    """Require invalid actions to raise an error and leave the state unchanged."""
    simulator.reset(seed=SEED)
    good, before = action(simulator, 0), simulator.state()
    for value in (np.nan, np.inf):
        bad = good.copy()
        bad[-1, -1, -1] = value
        require_error(lambda: simulator.step(bad), ValueError, f"an action of {value}")  # noqa: B023
    require_error(lambda: simulator.step(good[:, :, :-1]), ValueError, "actions of another shape")
    require_error(lambda: simulator.step(good[0]), ValueError, "actions of one world for all")
    require(simulator.state() == before, "an invalid action has changed the simulator")

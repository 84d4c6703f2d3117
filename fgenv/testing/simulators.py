"""The contract of a simulator."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from fgenv.envs import Simulator
from fgenv.envs.spaces import observation_box, state_box, state_of

from .laws import copies, refuses, require, same

SEED = 7


class MakeSimulator(Protocol):
    """Makes one of so many worlds that steps with so many threads, with autoreset."""

    def __call__(self, *, worlds: int, threads: int) -> Simulator: ...


def simulator_test(make: MakeSimulator, steps: int = 60) -> None:
    """Whether a simulator keeps its laws.

    - The same seed gives the same episodes, bit for bit, for any number of threads.
    - World k of reset(seed=s) is a single world of reset(seed=s + k).
    - Every observation and state is in its space; rewards are finite.
    - A copy in mid-episode goes on identically, by copy, deepcopy and pickle.
    - A bad action is refused, and nothing has changed.

    Args:
        make: called with worlds= and threads=.
        steps: of each rollout, over ends of episodes.

    Raises:
        AssertionError: naming the law that does not hold.
    """
    one, two = make(worlds=3, threads=1), make(worlds=3, threads=2)
    rows = rollout(one, steps)
    require(same(rows, rollout(one, steps)), "the same seed gave another rollout the second time")
    require(same(rows, rollout(two, steps)), "two threads gave another rollout than one")
    for k in range(3):
        alone = rollout(make(worlds=1, threads=1), steps, SEED + k, world=k)
        part = [[x[k : k + 1] for x in step] for step in rows]
        require(same(alone, part), f"world {k} is not the single world of seed + {k}")
    spaces_hold(one, steps)
    copies_go_on(one)
    bad_is_refused(one)


def action(simulator: Simulator, step: int, worlds: int = 3, world: int | None = None) -> Any:
    """Random actions of a step, the same for a world whether it is alone or not."""
    shape = (worlds, simulator.n_robots, simulator.action_size)
    drawn = np.random.default_rng(step // 8).uniform(-1.5, 1.5, shape)
    return drawn if world is None else drawn[world : world + 1]


def rollout(
    simulator: Simulator, steps: int, seed: int = SEED, world: int | None = None
) -> list[list[Any]]:
    """All arrays of a rollout."""
    found: list[list[Any]] = [[simulator.reset(seed=seed)]]
    for k in range(steps):
        done = simulator.step(action(simulator, k, world=world))
        found.append([*done, simulator.configurations, simulator.hits, simulator.checks])
    return found


def spaces_hold(simulator: Simulator, steps: int) -> None:
    """Each observation and state is in its space."""
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


def copies_go_on(simulator: Simulator) -> None:
    """A copy in mid-episode goes on identically, and the first is not touched."""
    simulator.reset(seed=SEED)
    for k in range(5):
        simulator.step(action(simulator, k))
    made = list(copies(simulator))
    steps = [simulator.step(action(simulator, 5 + k)) for k in range(10)]
    for name, other in made:
        again = [other.step(action(simulator, 5 + k)) for k in range(10)]
        require(same(steps, again), f"a {name} in mid-episode goes on differently")


def bad_is_refused(simulator: Simulator) -> None:
    """A bad action changes nothing."""
    simulator.reset(seed=SEED)
    good, before = action(simulator, 0), simulator.state()
    for value in (np.nan, np.inf):
        bad = good.copy()
        bad[-1, -1, -1] = value
        refuses(lambda: simulator.step(bad), ValueError, f"an action of {value}")  # noqa: B023
    refuses(lambda: simulator.step(good[:, :, :-1]), ValueError, "actions of another shape")
    refuses(lambda: simulator.step(good[0]), ValueError, "actions of one world for all")
    require(simulator.state() == before, "a bad action has changed the simulator")

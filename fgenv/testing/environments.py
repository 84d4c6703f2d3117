"""The contract of an environment with PettingZoo's or Gymnasium's face."""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import parallel_api_test
from pettingzoo.utils import ParallelEnv

from .laws import copies, refuses, require, same

SEED = 7


def environment_test(make: Callable[[], Any], steps: int = 60) -> None:
    """Whether an environment keeps its laws; PettingZoo's ParallelEnv or gymnasium.Env.

    - It passes the official test of its kind.
    - The same seed gives the same rollout, bit for bit, and so does reset() after it.
    - Every observation is in its space; an agent that is gone does not come back.
    - A copy in mid-episode goes on identically, by copy, deepcopy and pickle.
    - A bad action, and a step after the end, are refused, and nothing has changed.

    Args:
        make: makes it, the same each time.
        steps: of a rollout, or to the end of the episode.

    Raises:
        AssertionError: naming the law that does not hold.
    """
    env = make()
    official(make(), steps)
    first, second = rollout(env, steps, SEED), rollout(env, steps, None)
    require(same(first, rollout(env, steps, SEED)), "the same seed gave another rollout")
    require(same(second, rollout(env, steps, None)), "reset() after the seed gave another rollout")
    require(same(first, rollout(make(), steps, SEED)), "another one gave another rollout")
    copies_go_on(env)
    bad_is_refused(env)
    end_is_told(env)


def official(env: Any, steps: int) -> None:
    """PettingZoo's or Gymnasium's own test."""
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        if isinstance(env, ParallelEnv):
            parallel_api_test(env, steps)
        elif isinstance(env, gymnasium.Env):
            check_env(env.unwrapped, skip_render_check=True)
        else:
            kind = type(env).__name__
            raise TypeError(f"make: made a {kind}, expected a ParallelEnv or a gymnasium.Env")


def action(env: Any, rng: np.random.Generator) -> Any:
    """Random, of all who act."""
    if isinstance(env, ParallelEnv):
        return {name: drawn(env.action_space(name), rng) for name in env.agents}
    return drawn(env.action_space, rng)


def drawn(space: Any, rng: np.random.Generator) -> Any:
    """A number of a space, by our own dice."""
    return rng.uniform(space.low, space.high).astype(space.dtype)


def is_over(env: Any, step: Any) -> bool:
    """Whether the episode is, after a step."""
    return not env.agents if isinstance(env, ParallelEnv) else bool(step[2] or step[3])


def rollout(env: Any, steps: int, seed: int | None) -> list[Any]:
    """What reset and step give, to the end of the episode at most."""
    rng = np.random.default_rng(SEED)
    found: list[Any] = [env.reset(seed=seed)]
    check(env, found[0][0])
    for _ in range(steps):
        acting = set(getattr(env, "agents", ()))
        found.append(env.step(action(env, rng)))
        check(env, found[-1][0])
        require(set(getattr(env, "agents", ())) <= acting, "an agent that was gone came back")
        if is_over(env, found[-1]):
            break
    return found


def check(env: Any, observations: Any) -> None:
    """Each observation is in its space."""
    if not isinstance(env, ParallelEnv):
        require(env.observation_space.contains(observations), "an observation is not in its space")
        return
    for name, row in observations.items():
        inside = env.observation_space(name).contains(row)
        require(inside, f"an observation of {name!r} is not in its space")


def copies_go_on(env: Any) -> None:
    """A copy in mid-episode goes on identically."""
    env.reset(seed=SEED)
    rng = np.random.default_rng(SEED)
    env.step(action(env, rng))
    made = dict(copies(env))
    if env.unwrapped is not env:
        del made["copy"]  # of a wrapper: it shares what it wraps
    actions = action(env, rng)
    first = env.step(actions)
    for name, other in made.items():
        require(same(first, other.step(actions)), f"a {name} in mid-episode goes on differently")


def bad_is_refused(env: Any) -> None:
    """A bad action is told, and the next good one does as if it had not been."""
    rng = np.random.default_rng(SEED)
    env.reset(seed=SEED)
    good = action(env, rng)
    expected = env.step(good)
    env.reset(seed=SEED)
    for what, bad in bad_ones(good):
        refuses(lambda: env.step(bad), ValueError, what)  # noqa: B023
    require(same(expected, env.step(good)), "a bad action has changed the environment")


def bad_ones(good: Any) -> list[tuple[str, Any]]:
    """What has to be refused, by name."""
    if not isinstance(good, dict):
        return [("an action of NaN", good * np.nan), ("an action too long", np.append(good, 0))]
    last = list(good)[-1]
    return [
        ("an action of NaN", {**good, last: good[last] * np.nan}),
        ("an action too long", {**good, last: np.append(good[last], 0)}),
        ("an unknown agent", {**good, "nobody": good[last]}),
        ("no action of an agent", {name: good[name] for name in good if name != last}),
    ]


def end_is_told(env: Any, most: int = 10_000) -> None:
    """A step after the end is refused."""
    rng = np.random.default_rng(SEED)
    env.reset(seed=SEED)
    for _ in range(most):
        last = action(env, rng)
        if is_over(env, env.step(last)):
            refuses(lambda: env.step(last), RuntimeError, "a step after the end")  # noqa: B023
            return
    raise AssertionError(f"the episode does not end within {most} steps")

"""The contract of PettingZoo and Gymnasium environments."""

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

from .laws import copies, equal, require, require_error

SEED = 7


def environment_test(make: Callable[[], Any], steps: int = 60) -> None:
    """Test the contract of a PettingZoo ParallelEnv or a gymnasium.Env.

    - The official test of PettingZoo or Gymnasium passes.
    - Equal seeds give equal rollouts, bit for bit, and so do the resets after them.
    - Every observation is in its space; a removed agent does not return.
    - Copies in mid-episode continue identically, by copy, deepcopy and pickle.
    - An invalid action raises an error; the state is unchanged.
    - After the end, a step of a gymnasium.Env raises an error; one of a ParallelEnv, which then has
      no agents, returns five empty dicts.

    Args:
        make: returns a new, equal environment.
        steps: of a rollout, unless the episode ends before.

    Raises:
        AssertionError: with the violated law.
    """
    env = make()
    official_test(make(), steps)
    first, second = rollout(env, steps, SEED), rollout(env, steps, None)
    require(equal(first, rollout(env, steps, SEED)), "the same seed gave another rollout")
    require(equal(second, rollout(env, steps, None)), "reset() after the seed gave another rollout")
    require(equal(first, rollout(make(), steps, SEED)), "another one gave another rollout")
    check_copies(env)
    check_invalid_actions(env)
    check_end(env)


def official_test(env: Any, steps: int) -> None:
    """Run the official test of PettingZoo or Gymnasium."""
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        if isinstance(env, ParallelEnv):
            parallel_api_test(env, steps)
        elif isinstance(env, gymnasium.Env):
            check_env(env.unwrapped, skip_render_check=True)
        else:
            kind = type(env).__name__
            raise TypeError(f"make: got a {kind}, expected a ParallelEnv or a gymnasium.Env")


def action(env: Any, rng: np.random.Generator) -> Any:
    """Return random actions of all agents."""
    if isinstance(env, ParallelEnv):
        return {name: random_action(env.action_space(name), rng) for name in env.agents}
    return random_action(env.action_space, rng)


def random_action(space: Any, rng: np.random.Generator) -> Any:
    """Return a random action of a space, independent of its own generator."""
    return rng.uniform(space.low, space.high).astype(space.dtype)


def is_over(env: Any, step: Any) -> bool:
    """Whether the episode is over after a step."""
    return not env.agents if isinstance(env, ParallelEnv) else bool(step[2] or step[3])


def rollout(env: Any, steps: int, seed: int | None) -> list[Any]:
    """Return the results of reset and steps, at most to the end of the episode."""
    rng = np.random.default_rng(SEED)
    results: list[Any] = [env.reset(seed=seed)]
    check_observations(env, results[0][0])
    for _ in range(steps):
        acting = set(getattr(env, "agents", ()))
        results.append(env.step(action(env, rng)))
        check_observations(env, results[-1][0])
        require(set(getattr(env, "agents", ())) <= acting, "a removed agent returned")
        if is_over(env, results[-1]):
            break
    return results


def check_observations(env: Any, observations: Any) -> None:
    """Require each observation to be in its space."""
    if not isinstance(env, ParallelEnv):
        require(env.observation_space.contains(observations), "an observation is not in its space")
        return
    for name, row in observations.items():
        inside = env.observation_space(name).contains(row)
        require(inside, f"an observation of {name!r} is not in its space")


def check_copies(env: Any) -> None:
    """Require copies in mid-episode to continue identically."""
    env.reset(seed=SEED)
    rng = np.random.default_rng(SEED)
    env.step(action(env, rng))
    made = dict(copies(env))
    if env.unwrapped is not env:
        del made["copy"]  # a copied wrapper shares its environment
    actions = action(env, rng)
    first = env.step(actions)
    for name, other in made.items():
        require(equal(first, other.step(actions)), f"a {name} in mid-episode continues differently")


def check_invalid_actions(env: Any) -> None:
    """Require invalid actions to raise an error and leave the state unchanged."""
    rng = np.random.default_rng(SEED)
    env.reset(seed=SEED)
    good = action(env, rng)
    expected = env.step(good)
    env.reset(seed=SEED)
    for name, invalid in invalid_actions(good):
        require_error(lambda: env.step(invalid), ValueError, name)  # noqa: B023
    require(equal(expected, env.step(good)), "an invalid action has changed the environment")


def invalid_actions(good: Any) -> list[tuple[str, Any]]:
    """Return invalid actions by name."""
    if not isinstance(good, dict):
        return [
            ("an action of NaN", good * np.nan),
            ("an action that is too long", np.append(good, 0)),
        ]
    last = list(good)[-1]
    return [
        ("an action of NaN", {**good, last: good[last] * np.nan}),
        ("an action that is too long", {**good, last: np.append(good[last], 0)}),
        ("an unknown agent", {**good, "unknown": good[last]}),
        ("no action of an agent", {name: good[name] for name in good if name != last}),
    ]


def check_end(env: Any, max_steps: int = 10_000) -> None:
    """Require a step after the end to raise an error, or to return empty dicts without agents."""
    rng = np.random.default_rng(SEED)
    env.reset(seed=SEED)
    for _ in range(max_steps):
        last = action(env, rng)
        if is_over(env, env.step(last)):
            if isinstance(last, dict):
                assert env.step({}) == ({}, {}, {}, {}, {}), "a step after the end: got results"
            else:
                require_error(lambda: env.step(last), RuntimeError, "a step after the end")  # noqa: B023
            return
    raise AssertionError(f"the episode does not end within {max_steps} steps")

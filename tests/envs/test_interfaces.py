"""Rules that hold on every interface: seeds, the keys of infos, the modes of autoreset."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
import supersuit
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import fgenv
from fgenv.agents import FleetVecEnv
from fgenv.envs import FleetEnv, FleetVectorEnv
from fgenv.envs.infos import info_arrays

WAYS: dict[str, Any] = {"n": 3, "starts": "random", "threads": 1}


def first_rows(kind: str, **options: Any) -> np.ndarray:
    """Return the first observations of an interface."""
    if kind == "single":
        return np.asarray(gymnasium.make("fgenv/random-v0", **WAYS).reset(**options)[0])
    if kind == "vector":
        return FleetVectorEnv("random", 2, **WAYS).reset(**options)[0]
    rows = fgenv.parallel_env("random", **WAYS).reset(**options)[0]
    return np.stack(list(rows.values()))


@pytest.mark.parametrize("kind", ["single", "vector", "parallel"])
def test_environments_without_a_seed_begin_apart(kind: str) -> None:
    assert not np.array_equal(first_rows(kind), first_rows(kind))
    assert np.array_equal(first_rows(kind, seed=7), first_rows(kind, seed=7))


def test_fresh_entropy_is_reported_and_reproduces_the_episode() -> None:
    env = FleetEnv("random", **WAYS)
    rows, _ = env.reset()
    seed = env.np_random_seed
    assert np.array_equal(FleetEnv("random", **WAYS).reset(seed=seed)[0], rows)
    both = fgenv.parallel_env("random", **WAYS), fgenv.parallel_env("random", **WAYS)
    first = both[0].reset()[0]
    again = both[1].reset(seed=both[0].np_random_seed)[0]
    assert all(np.array_equal(first[name], again[name]) for name in first)


@pytest.mark.parametrize("clearance", [False, True])
def test_infos_are_numbers_with_fixed_keys(clearance: bool) -> None:
    options: dict[str, Any] = {"clearance": clearance, "on_collision": "pass", "n": 6}
    env = fgenv.parallel_env("swap", **options)
    single = FleetEnv("swap", robot=1, others="goto", **options)
    many = FleetVectorEnv("swap", 2, robot=1, others="goto", **options)
    every = [*env.reset(seed=0)[1].values(), single.reset(seed=0)[1]]
    keys, met = set(every[0]), 0
    vectors = many.reset(seed=0)[1]
    for _ in range(40):
        goals = env.simulator.toward(env.simulator.goals)[0]
        actions = {name: goals[i] for i, name in enumerate(env.possible_agents)}
        rows = env.step(actions)[-1]
        every += [*rows.values(), single.step(goals[1])[-1]]
        arrays = info_arrays(env.simulator)
        for name, info in rows.items():
            i = env.possible_agents.index(name)
            assert info == {key: values[0, i].item() for key, values in arrays.items()}
        vectors = many.step(np.stack([goals[1]] * 2))[-1]
    for info in every:
        assert set(info) == keys
        assert all(type(value) in (bool, int, float) for value in info.values())
        assert info["collision"] == (info["collision_time"] >= 0)
        met += info["collision"]
    assert met > 0
    assert keys == {name for name in vectors if name[0] != "_" and not name.startswith("final")}


def test_black_death_runs_to_the_end() -> None:
    env = supersuit.black_death_v3(fgenv.parallel_env("random", n=3, horizon=2.0))
    env.reset(seed=1)
    for _ in range(40):
        env.step({agent: env.action_space(agent).sample() for agent in env.agents})
    assert env.agents == []


def test_spaces_by_agent_and_a_generator_are_attributes() -> None:
    env = fgenv.parallel_env("cell")
    assert env.observation_spaces == {a: env.observation_space(a) for a in env.possible_agents}
    assert env.action_spaces == {a: env.action_space(a) for a in env.possible_agents}
    assert isinstance(env.np_random, np.random.Generator)


@pytest.mark.parametrize("make", [FleetEnv, fgenv.parallel_env])
def test_options_of_a_reset_are_a_dict(make: Callable[..., Any]) -> None:
    with pytest.raises(TypeError, match="options: got 'x', expected a dict or None"):
        make("swap").reset(options="x")


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_modes_of_autoreset_equal_those_of_gymnasium(mode: AutoresetMode) -> None:
    options: dict[str, Any] = {"n": 3, "starts": "random", "threads": 1, "others": "goto"}
    envs = FleetVectorEnv("swap", 4, max_episode_steps=5, autoreset_mode=mode, **options)

    def make() -> FleetEnv:
        return FleetEnv("swap", max_steps=5, **options)

    expected = SyncVectorEnv([make] * 4, autoreset_mode=mode)
    assert envs.metadata["autoreset_mode"] == expected.metadata["autoreset_mode"] == mode
    assert np.array_equal(envs.reset(seed=5)[0], expected.reset(seed=5)[0])
    rng, ends = np.random.default_rng(0), 0
    for _ in range(23):
        actions = rng.uniform(-1, 1, (4, 2)).astype(np.float32)
        mine, theirs = envs.step(actions), expected.step(actions)
        for k in range(4):
            assert np.array_equal(np.asarray(mine[k]), np.asarray(theirs[k]))
        ends += int(mine[3].sum())
    assert ends >= 12


def test_without_autoreset_worlds_are_reset_by_a_mask() -> None:
    envs = FleetVectorEnv("swap", 2, max_episode_steps=2, autoreset_mode="DISABLED", n=2)
    envs.reset(seed=0)
    for _ in range(2):
        late = envs.step(np.zeros((2, 2)))[3]
    assert late.all()
    with pytest.raises(RuntimeError, match="call reset"):
        envs.step(np.zeros((2, 2)))
    envs.reset(options={"reset_mask": late})
    envs.step(np.zeros((2, 2)))
    with pytest.raises(ValueError, match="autoreset_mode: got 'SOON', expected one of NEXT_STEP"):
        FleetVectorEnv("swap", 2, autoreset_mode="SOON")


def test_rows_of_stable_baselines_begin_apart() -> None:
    first, second = (FleetVecEnv("random", **WAYS).reset() for _ in range(2))
    assert not np.array_equal(first, second)


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (np.zeros((1, 2)), r"action of 'robot 1': got shape \(1, 2\), expected \(2,\)"),
        ([1j, 0], "action of 'robot 1': got .*1j.*, expected real numbers"),
        (["a", "b"], "action of 'robot 1': got .*, expected real numbers"),
        ([np.nan, 0], r"action of 'robot 1': got \[nan, 0.0\], expected finite numbers"),
    ],
)
def test_invalid_actions_have_the_same_error_on_each_interface(action: Any, message: str) -> None:
    env = fgenv.parallel_env("swap", n=2)
    env.reset(seed=0)
    single = FleetEnv("swap", n=2)
    single.reset(seed=0)
    with pytest.raises(ValueError, match=message):
        env.step({"robot 1": action, "robot 2": np.zeros(2)})
    with pytest.raises(ValueError, match=message):
        single.step(action)


def test_the_largest_seed_is_accepted() -> None:
    FleetEnv("swap", n=2).reset(seed=2**63 - 1)
    with pytest.raises(ValueError, match=r"seed: got 9223372036854775807, expected 0 to 2\^63 - 2"):
        FleetVectorEnv("swap", 2, n=2).reset(seed=2**63 - 1)

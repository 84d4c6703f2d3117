"""Gymnasium environments: one robot learns, in one world or in each of many."""

from __future__ import annotations

import copy
import importlib
import pickle
import subprocess
import sys
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import fgenv
from fgenv.envs import FleetEnv, FleetVectorEnv, View
from fgenv.scenarios import Scenario
from fgenv.scenarios.library import ENTRIES

DRIVEN = [name for name in ENTRIES if Scenario.load(name).build().robots[0].drive is not None]
WAYS: dict[str, Any] = {"n": 4, "starts": "random", "threads": 1}


def single(**options: Any) -> FleetEnv:
    return FleetEnv("swap", **WAYS | options)


def vector(num_envs: int, **options: Any) -> FleetVectorEnv:
    return FleetVectorEnv("swap", num_envs, **WAYS | options)


class Straight:
    """Drives every robot straight to its goal."""

    def reset(self, view: View) -> None:
        self.view = view

    def act(self, observations: Any) -> Any:
        assert observations.shape[:2] == (self.view.n_worlds, self.view.n_robots)
        return self.view.toward(self.view.goals)


@pytest.mark.parametrize("others", ["rest", Straight()])
def test_official(others: Any) -> None:
    env = gymnasium.make("fgenv/swap-v0", **WAYS, others=others).unwrapped
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env)


def test_all_scenarios_are_registered() -> None:
    for name in DRIVEN:
        assert gymnasium.spec(f"fgenv/{name}-v0").vector_entry_point


def test_scenarios_for_planners_are_not_registered() -> None:
    """Their robots have no drive: an environment could not be made."""
    assert {name for name, entry in ENTRIES.items() if entry.driven} == set(DRIVEN)
    for name in set(ENTRIES) - set(DRIVEN):
        with pytest.raises(gymnasium.error.NameNotFound):
            gymnasium.make(f"fgenv/{name}-v0")
        with pytest.raises(ValueError, match="without a drive, expected one"):
            FleetEnv(name)


def test_an_unknown_keyword_is_a_type_error() -> None:
    """TorchRL probes `frameskip=` and reads Python's wording."""
    with pytest.raises(TypeError, match="got an unexpected keyword argument 'frameskip'"):
        gymnasium.make("fgenv/swap-v0", frameskip=4)
    with pytest.raises(TypeError, match="did you mean 'jitter'"):
        fgenv.parallel_env("swap", jiter=0.1)


def test_a_module_in_the_name_imports_it() -> None:
    """The form MODULE:ID of Gymnasium."""
    code = "import gymnasium as g; print(g.make('fgenv.envs:fgenv/swap-v0', n=2).unwrapped)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "FleetEnv" in done.stdout, done.stderr


def test_importing_fgenv_stays_light() -> None:
    code = "import sys, fgenv; print({'numpy', 'gymnasium', 'pydantic', 'ompl'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip() == "set()", done.stderr


def test_other_robots_follow_their_policy() -> None:
    rest, go = single(), single(others=Straight())
    for env in (rest, go):
        env.reset(seed=1)
    before = rest.simulator.configurations
    for env in (rest, go):
        env.step(np.zeros(2))
    assert np.array_equal(rest.simulator.configurations, before)
    moved = np.abs(go.simulator.configurations - before).max(axis=-1)[0] > 0
    assert moved.tolist() == [False, True, True, True]


def test_rest_differs_from_zero_actions() -> None:
    for name in DRIVEN:
        env = FleetEnv(name, others="rest", threads=1)
        env.reset(seed=0)
        before = env.simulator.configurations
        env.step(np.zeros(env.action_space.shape or 0))
        for i, robot in enumerate(env.simulator.robots[1:], 1):
            q, then = env.simulator.configurations[0, i], before[0, i]
            assert robot.displacement_bound(q[: robot.nq], then[: robot.nq]) < 1e-5, name


def test_the_episode_ends_with_that_of_the_robot() -> None:
    env = single(others=lambda rows: np.zeros((1, 4, 2)), robot="robot 2")
    env.reset(seed=0)
    goal = env.simulator.goals[0, 1]
    env.simulator.place(0, 1, goal, goal)
    _, reward, ended, late, info = env.step(np.zeros(2))
    assert (ended, late, info["success"]) == (True, False, True)
    assert reward > 5
    with pytest.raises(RuntimeError, match="call reset"):
        env.step(np.zeros(2))
    env.reset()
    env.step(np.zeros(2))


def test_worlds_equal_single_environments() -> None:
    """Equal to Gymnasium's SyncVectorEnv, bit for bit, ends of episodes included."""
    one = vector(5, max_episode_steps=6, others=Straight(), clearance=True)

    def make() -> FleetEnv:
        return single(max_steps=6, others=Straight(), clearance=True)

    other = SyncVectorEnv([make] * 5, autoreset_mode=AutoresetMode.SAME_STEP)
    rng = np.random.default_rng(0)
    rows, infos = one.reset(seed=11)
    assert np.array_equal(rows, other.reset(seed=11)[0])
    ends = 0
    mine: list[Any]
    for _ in range(20):
        actions = rng.uniform(-1, 1, (5, 2)).astype(np.float32)
        *mine, infos = one.step(actions)
        *theirs, expected = other.step(actions)
        for a, b in zip(mine, theirs, strict=True):
            assert np.array_equal(a, b)
        assert np.array_equal(infos["clearance"], expected["clearance"])
        assert ("final_obs" in infos) == ("final_obs" in expected)
        if "final_obs" in infos:
            ends += 1
            mask = infos["_final_obs"]
            assert np.array_equal(mask, expected["_final_obs"])
            for a, b in zip(infos["final_obs"][mask], expected["final_obs"][mask], strict=True):
                assert np.array_equal(a, b)
            for name in ("masked", "checks", "success", "clearance"):
                pair = infos["final_info"][name], expected["final_info"][name]
                assert np.array_equal(pair[0][mask], pair[1][mask])
    assert ends >= 3


def test_reset_of_some_worlds() -> None:
    envs = vector(3)
    first, _ = envs.reset(seed=[4, 5, 6])
    for _ in range(3):
        rows, *_ = envs.step(np.ones((3, 2)))
    again, _ = envs.reset(seed=[4, 5, 6], options={"reset_mask": np.array([True, False, False])})
    assert np.array_equal(again[0], first[0])
    assert np.array_equal(again[1:], rows[1:])
    with pytest.raises(ValueError, match="reset_mask"):
        envs.reset(options={"reset_mask": np.zeros(3, dtype=bool)})


def test_metadata_has_the_autoreset_mode() -> None:
    envs = gymnasium.make_vec("fgenv/swap-v0", num_envs=3, **WAYS, max_episode_steps=4)
    assert envs.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP
    rows, _ = envs.reset(seed=0)
    assert envs.observation_space.contains(rows)
    for _ in range(4):
        *_, late, infos = envs.step(envs.action_space.sample())
    assert late.all()
    assert infos["_final_obs"].all()
    assert infos["final_info"]["success"].dtype == bool


def test_copies_continue_identically() -> None:
    """The policy of a copy has a view of the copied simulator."""
    env = vector(3, max_episode_steps=5, others=Straight())
    env.reset(seed=0)
    env.step(np.ones((3, 2)))
    made = [copy.copy(env), copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    steps: list[Any] = [env.step(np.full((3, 2), 0.5)) for _ in range(8)]
    for other in made:
        for expected in steps:
            for a, b in zip(expected[:4], other.step(np.full((3, 2), 0.5))[:4], strict=True):
                assert np.array_equal(a, b)


def test_invalid_arguments_raise() -> None:
    with pytest.raises(ValueError, match="robot: got 'robot 9', expected robot 1"):
        single(robot="robot 9")
    with pytest.raises(ValueError, match="robot: got 4, expected 0 to 3"):
        single(robot=4)
    with pytest.raises(TypeError, match="policy: got int, expected a name"):
        single(others=3)
    with pytest.raises(TypeError, match="jiter"):
        gymnasium.make("fgenv/swap-v0", jiter=1)
    with pytest.raises(TypeError, match="autoreset"):
        vector(2, autoreset=True)
    env = single(others=lambda rows: np.zeros((1, 3, 2)))
    env.reset(seed=0)
    before = env.simulator.state()
    with pytest.raises(ValueError, match=r"got actions of shape \(1, 3, 2\), expected \(1, 4, 2\)"):
        env.step(np.zeros(2))
    with pytest.raises(ValueError, match="action of 'robot 1': got shape"):
        env.step(np.zeros(3))
    with pytest.raises(ValueError, match="action of 'robot 1': got"):
        env.step(np.array([0, np.nan]))
    assert env.simulator.state() == before


@pytest.mark.parametrize(
    "imports", ["fgenv, gymnasium, pettingzoo", "gymnasium, pettingzoo, fgenv"]
)
def test_importing_fgenv_registers_the_ids(imports: str) -> None:
    code = (
        f"import {imports}\n"
        "gymnasium.make('fgenv/doorway-v0', n=2)\n"
        "pettingzoo.make('aec', 'fgenv/doorway-v0', n=2)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("package", ["fgenv", "fgenv.envs", "fgenv.agents"])
def test_dir_lists_public_names_that_exist(package: str) -> None:
    module = importlib.import_module(package)
    assert dir(module) == sorted(module.__all__)
    for name in dir(module):
        assert getattr(module, name) is not None

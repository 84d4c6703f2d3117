"""The environment of Stable-Baselines3, with a row per world and robot."""

from __future__ import annotations

import copy
import functools
import pickle
import warnings

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from fgenv.agents import FleetVecEnv
from fgenv.envs import FleetEnv, Simulator
from fgenv.scenarios import Scenario

fleet = functools.partial(FleetVecEnv, "swap", n=3, starts="random", threads=1)


def test_official() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(FleetEnv("swap", n=3, threads=1))


def test_rows_equal_the_simulator() -> None:
    """Includes ends of episodes and their infos."""
    envs = fleet(4, max_steps=6)
    simulator = Simulator("swap", 4, n=3, starts="random", threads=1, max_steps=6)
    envs.seed(9)
    assert np.array_equal(np.asarray(envs.reset()), simulator.reset(seed=9).reshape(12, -1))
    rng = np.random.default_rng(0)
    returns = np.zeros(12)
    for k in range(13):
        actions = rng.uniform(-1, 1, (12, 2))
        rows, rewards, dones, infos = envs.step(actions.astype(np.float32))
        done = simulator.step(actions.astype(np.float32).reshape(4, 3, 2))
        assert np.array_equal(np.asarray(rows), done.observations.reshape(12, -1))
        assert np.array_equal(rewards, done.rewards.astype(np.float32).reshape(-1))
        assert rewards.dtype == np.float32
        assert dones.tolist() == np.repeat(done.terminated | done.truncated, 3).tolist()
        returns += rewards
        if k % 6 == 5:
            assert [info["episode"]["l"] for info in infos] == [6] * 12
            assert np.allclose([info["episode"]["r"] for info in infos], returns)
            returns[:] = 0
            last = simulator.final_observations
            assert last is not None
            for info, row in zip(infos, last.reshape(12, -1), strict=True):
                assert np.array_equal(info["terminal_observation"], row)
                assert info["TimeLimit.truncated"]
                assert not info["is_success"]
        else:
            assert infos == [{"TimeLimit.truncated": False}] * 12


def test_final_infos_have_success() -> None:
    envs = fleet(2)
    envs.reset()
    for i, goal in enumerate(envs.simulator.goals[1]):
        envs.simulator.place(1, i, goal, goal)
    _, rewards, dones, infos = envs.step(np.zeros((6, 2)))
    assert dones.tolist() == [False] * 3 + [True] * 3
    assert (rewards[3:] > 5).all()
    assert infos[4]["is_success"]
    assert not infos[4]["TimeLimit.truncated"]
    assert infos[4]["steps_in_contact"] == 0
    episode = infos[4]["episode"]
    assert (episode["r"], episode["l"]) == (pytest.approx(rewards[4]), 1)


def test_seeds() -> None:
    envs = fleet(2)
    assert envs.seed(5) == [5, 5, 5, 6, 6, 6]
    first = envs.reset()
    assert envs.get_attr("seed") == [5, 5, 5, 6, 6, 6]
    second = envs.reset()
    assert not np.array_equal(first, second)
    envs.seed(5)
    assert np.array_equal(np.asarray(envs.reset()), first)
    assert np.array_equal(np.asarray(envs.reset()), second)
    assert len(set(map(str, envs.seed()))) == 2


def test_attributes() -> None:
    envs = fleet(2)
    assert envs.get_attr("name", [0, 4]) == ["robot 1", "robot 2"]
    assert envs.get_attr("world") == [0, 0, 0, 1, 1, 1]
    assert envs.get_attr("dt", 0) == [0.1]
    assert envs.get_attr("render_mode") == [None] * 6
    assert envs.has_attr("horizon")
    assert not envs.has_attr("nothing")
    envs.set_attr("tag", 3)
    assert envs.get_attr("tag") == [3] * 6
    with pytest.raises(ValueError, match="rows share 'tag'"):
        envs.set_attr("tag", 4, 0)
    assert envs.env_is_wrapped(VecMonitor) == [False] * 6


def test_frames_per_world() -> None:
    envs = fleet(2, render_mode="rgb_array")
    envs.reset()
    assert [np.asarray(image).shape for image in envs.get_images()] == [(360, 480, 3)] * 2
    assert np.shape(envs.env_method("render", indices=3)) == (1, 360, 480, 3)
    tiled = envs.render()
    assert tiled is not None
    assert tiled.ndim == 3


def test_copies_continue_identically() -> None:
    envs = fleet(2, max_steps=4)
    envs.reset()
    envs.step(np.ones((6, 2)))
    made = [copy.copy(envs), copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))]
    steps = [envs.step(np.ones((6, 2))) for _ in range(6)]
    for other in made:
        for expected in steps:
            for a, b in zip(expected[:3], other.step(np.ones((6, 2)))[:3], strict=True):
                assert np.array_equal(np.asarray(a), b)


def test_invalid_arguments_raise() -> None:
    envs = fleet(2)
    envs.reset()
    before = envs.simulator.state()
    with pytest.raises(ValueError, match=r"actions: got shape \(2, 3, 2\), expected \(6, 2\)"):
        envs.step(np.zeros((2, 3, 2)))
    with pytest.raises(ValueError, match=r"actions\[1, 2, 1\]: got nan"):
        envs.step(np.array([[0.0, 0.0]] * 5 + [[0.0, np.nan]]))
    assert envs.simulator.state() == before
    with pytest.raises(ValueError, match="autoreset=True, expected False"):
        FleetVecEnv(Simulator("swap", n=2))
    two = Scenario.load("swap", n=2)
    plain = next(iter(two.models.values())).model_copy(update={"lidar": None})
    robots = (two.robots[0], two.robots[1].model_copy(update={"model": "other"}))
    unlike = two.replace(models={**two.models, "other": plain}, robots=robots)
    with pytest.raises(ValueError, match="'robot 1' and 'robot 2' with different spaces"):
        FleetVecEnv(unlike)


def test_a_policy_learns_on_it() -> None:
    """Two runs of one seed end with equal weights; wrappers work."""

    def weights() -> list[np.ndarray]:
        torch.set_num_threads(1)
        envs = VecNormalize(VecMonitor(fleet(2, max_steps=5)))
        model = PPO("MlpPolicy", envs, n_steps=8, batch_size=48, n_epochs=1, seed=3, device="cpu")
        model.learn(96)
        assert len(model.ep_info_buffer or ()) > 0
        return [p.detach().numpy() for p in model.policy.parameters()]

    for a, b in zip(weights(), weights(), strict=True):
        assert np.array_equal(a, b)

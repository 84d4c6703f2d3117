"""PettingZoo environments: official tests, agents, infos and errors."""

from __future__ import annotations

import contextlib
import copy
import functools
import io
import pickle
import types
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import pettingzoo
import pytest
from pettingzoo.test import (
    api_test,
    max_cycles_test,
    parallel_api_test,
    parallel_seed_test,
    render_test,
    seed_test,
    state_test,
)
from pettingzoo.test.save_obs_test import test_save_obs as save_obs

import fgenv
from fgenv.envs import Collision, FleetParallelEnv, Observation, Reward, Simulator
from fgenv.scenarios import Scenario, ScenarioError

parallel = functools.partial(fgenv.parallel_env, "swap", n=4, jitter=0.5, threads=1)
turns = functools.partial(fgenv.env, "swap", n=4, jitter=0.5, threads=1)


@pytest.fixture
def _quiet() -> Iterator[None]:
    """The official tests print, and warn about names."""
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message="We recommend agents to be named")
        yield


@pytest.mark.usefixtures("_quiet")
class TestOfficial:
    """PettingZoo's tests, with warnings as errors except for names of agents."""

    @pytest.mark.parametrize("name", ["swap", "cell"])
    def test_parallel_api(self, name: str) -> None:
        parallel_api_test(fgenv.parallel_env(name, n=2, max_cycles=40), num_cycles=50)

    @pytest.mark.parametrize("name", ["swap", "cell"])
    def test_api(self, name: str) -> None:
        api_test(fgenv.env(name, n=2, max_cycles=40), num_cycles=50)

    def test_seeds(self) -> None:
        parallel_seed_test(parallel, num_cycles=20)
        seed_test(turns, num_cycles=20)

    def test_max_cycles(self) -> None:
        max_cycles_test(types.SimpleNamespace(parallel_env=parallel, env=turns))

    def test_state(self) -> None:
        state_test(turns(), parallel())

    def test_render(self) -> None:
        render_test(turns)

    def test_save_obs(self) -> None:
        save_obs(turns())


@pytest.mark.skipif(not hasattr(pettingzoo, "register"), reason="PettingZoo before 1.27")
def test_both_are_registered() -> None:
    assert pettingzoo.make("parallel", "fgenv/swap-v0", n=3).num_agents == 0
    assert len(pettingzoo.make("aec", "fgenv/swap-v0", n=3).possible_agents) == 3


def test_results_equal_the_simulator() -> None:
    """Observations, rewards and ends are the arrays of the simulator."""
    env, simulator = parallel(), Simulator("swap", n=4, jitter=0.5, threads=1)
    rows, _ = env.reset(seed=3)
    assert np.array_equal(np.array([*rows.values()]), simulator.reset(seed=3)[0])
    for _ in range(20):
        actions = simulator.sample(np.random.default_rng(1))
        done = simulator.step(actions)
        rows, rewards, *_ = env.step(dict(zip(env.agents, actions[0], strict=True)))
        assert np.array_equal(np.array([*rows.values()]), done.observations[0])
        assert [*rewards.values()] == done.rewards[0].tolist()


def one_is_near() -> FleetParallelEnv:
    """Robot 1 is near its goal, the others are far from theirs."""
    env = parallel(max_cycles=9)
    env.reset(seed=0)
    start = env.simulator.goals[0, 0] + [-0.2, 0, 0]
    env.simulator.place(0, 0, start, env.simulator.goals[0, 0] + [-0.15, 0, 0])
    return env


def still(env: FleetParallelEnv) -> dict[str, Any]:
    return {name: np.zeros(2) for name in env.agents}


def test_robots_leave_on_arrival() -> None:
    env = one_is_near()
    _, rewards, ended, late, infos = env.step(still(env))
    assert ended == {"robot 1": True, "robot 2": False, "robot 3": False, "robot 4": False}
    assert not any(late.values())
    assert infos["robot 1"]["success"]
    assert rewards["robot 1"] > 5
    assert env.agents == ["robot 2", "robot 3", "robot 4"]
    rows, *_ = env.step(still(env))
    assert [*rows] == ["robot 2", "robot 3", "robot 4"]


def test_remaining_robots_are_truncated_at_the_horizon() -> None:
    env = one_is_near()
    for _ in range(9):
        _, _, ended, late, _ = env.step(still(env))
    assert env.agents == []
    assert not any(ended.values())
    assert late == {"robot 2": True, "robot 3": True, "robot 4": True}


def test_a_collision_is_in_infos_and_may_end_the_episode() -> None:
    env = parallel(on_collision="terminate", n=2, reward=Reward({"collision": -7.0}))
    env.reset(seed=0)
    goals = env.simulator.goals[0]
    env.simulator.place(0, 0, [-0.6, 0, 0], goals[0])
    env.simulator.place(0, 1, [0.1, 0, 0], goals[1])
    for _ in range(5):
        _, rewards, ended, _, infos = env.step({"robot 1": [1.0, 0.0], "robot 2": [0.0, 0.0]})
        if not env.agents:
            break
    info = infos["robot 1"]
    assert info["collision"] is True
    assert info["other"] == 1
    assert 0 <= info["collision_time"] <= env.simulator.dt
    (met,) = env.simulator.collisions()
    assert isinstance(met, Collision)
    assert (met.other, met.with_robot, met.time) == ("robot 2", True, info["collision_time"])
    assert met.point.tolist() == [info[f"collision_{axis}"] for axis in "xyz"]
    assert rewards["robot 1"] == -7
    assert ended == {"robot 1": True, "robot 2": True}


def test_infos_have_measured_clearances() -> None:
    assert "clearance" not in parallel().reset()[1]["robot 1"]
    env = parallel(clearance=True)
    env.reset()
    infos = env.step(still(env))[-1]
    assert 0 < infos["robot 1"]["clearance"] < 10


def test_robots_may_differ() -> None:
    """Spaces have a size per robot."""
    two = Scenario.load("swap", n=2)
    models = dict(two.models)
    name, model = next(iter(models.items()))
    models["other"] = model.model_copy(update={"lidar": None})
    robots = (two.robots[0], two.robots[1].model_copy(update={"model": "other"}))
    env = fgenv.parallel_env(two.replace(models=models, robots=robots))
    sizes = [env.observation_space(agent).shape[0] for agent in env.possible_agents]
    assert sizes[0] > sizes[1]
    rows, _ = env.reset(seed=0)
    assert [len(row) for row in rows.values()] == sizes
    assert name != "other"


BAD = [
    ({"robot 1": [0.0, np.nan]}, "action of 'robot 1'"),
    ({"robot 1": [0.0, np.inf]}, "finite"),
    ({"robot 1": [0.0, 0.0, 0.0]}, r"shape \(3,\), expected \(2,\)"),
    ({"robot 1": "left"}, "expected real numbers"),
    ({"robot 1": None}, "action of 'robot 1'"),
    ({"robot 9": [0.0, 0.0]}, "robot: got 'robot 9', expected robot 1"),
]


@pytest.mark.parametrize(("bad", "message"), BAD)
def test_invalid_actions_change_nothing(bad: dict[str, Any], message: str) -> None:
    env = parallel()
    env.reset(seed=0)
    before = env.simulator.state()
    with pytest.raises(ValueError, match=message):
        env.step({**still(env), **bad})
    assert env.simulator.state() == before
    env.step(still(env))


def test_missing_robots_are_named_and_actions_of_arrived_ones_ignored() -> None:
    env = one_is_near()
    with pytest.raises(ValueError, match="got none for 'robot 4'"):
        env.step({name: np.zeros(2) for name in env.agents[:-1]})
    with pytest.raises(TypeError, match="expected a dict"):
        env.step(np.zeros((4, 2)))  # type: ignore[arg-type]
    every = still(env)
    env.step(every)
    assert "robot 1" not in env.agents
    again = copy.deepcopy(env)
    rows = env.step(every)[0]  # TorchRL and skrl send actions of robots that have left
    expected = again.step({name: every[name] for name in again.agents})[0]
    assert rows.keys() == expected.keys()
    assert all(np.array_equal(rows[name], expected[name]) for name in rows)
    with pytest.raises(ValueError, match="robot: got 'robot 9'"):
        env.step({**every, "robot 9": np.zeros(2)})


def test_invalid_aec_actions_raise_at_their_turn() -> None:
    env = turns()
    env.reset(seed=0)
    for bad in (np.full(2, np.nan), np.zeros(3), None):
        with pytest.raises(ValueError, match="action of 'robot 1'"):
            env.step(bad)
    env.step(np.zeros(2))
    assert env.agent_selection == "robot 2"


def test_aec_copies_in_mid_cycle() -> None:
    env = turns()
    env.reset(seed=0)
    env.step(np.ones(2))
    made = [copy.copy(env), copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    for other in [env, *made]:
        for _ in range(9):
            other.step(np.full(2, 0.5))
    for other in made:
        assert other.agent_selection == env.agent_selection
        assert np.array_equal(other.state(), env.state())
        assert np.array_equal(other.last()[0], env.last()[0])


def test_before_and_after() -> None:
    env = parallel(max_cycles=1, render_mode="rgb_array")
    for call in (lambda: env.step({}), env.render, env.state):
        with pytest.raises(RuntimeError, match="call reset"):
            call()
    env.reset()
    env.step(still(env))
    assert env.step({}) == ({}, {}, {}, {}, {})  # as SuperSuit's black_death needs it


def test_unknown_names_raise() -> None:
    with pytest.raises(ScenarioError, match=r"swop.*swap"):
        fgenv.parallel_env("swop")
    with pytest.raises(TypeError, match=r"unexpected keyword argument 'jiter'.*jitter"):
        fgenv.parallel_env("swap", jiter=0.1)
    with pytest.raises(ValueError, match="render_mode: got 'ansi'"):
        fgenv.parallel_env("swap", render_mode="ansi")
    with pytest.raises(ValueError, match="max_cycles: got 0"):
        fgenv.parallel_env("swap", max_cycles=0)
    with pytest.raises(TypeError, match="worlds: got 3, which parallel_env does not take"):
        fgenv.parallel_env("swap", worlds=3)
    with pytest.raises(ValueError, match="robot: got 'robot 9', expected robot 1"):
        parallel().observation_space("robot 9")
    with pytest.raises(AttributeError, match="no attribute 'parallel'"):
        _ = fgenv.parallel


def test_options_reach_the_simulator() -> None:
    env = parallel(observation=Observation(lidar=False, neighbors=1), actions="way_points")
    assert env.observation_space("robot 1").shape == (4 + 2 + 7,)
    assert env.action_space("robot 1").shape == (3,)
    assert env.metadata["render_fps"] == 1 / env.simulator.dt


def test_pictures() -> None:
    env = parallel(render_mode="rgb_array")
    env.reset(seed=0)
    frame = env.render()
    assert frame is not None
    assert frame.shape == (360, 480, 3)
    assert frame.dtype == np.uint8
    assert np.ptp(frame) > 100
    other = parallel()
    other.reset()
    with pytest.warns(UserWarning, match="'rgb_array' for frames"):
        assert other.render() is None

"""Contract tests of simulators and environments; they detect violations."""

from __future__ import annotations

import copy
import functools
import hashlib
import os
import subprocess
import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import TESTS

import fgenv
from fgenv.envs import FleetParallelEnv, Observation, Reward, Simulator
from fgenv.testing import environment_test, scenario_test, simulator_test

ALL = Observation(configuration=True, path_hint=True)
WAYS: dict[str, dict[str, Any]] = {
    "random starts": {"scenario": "swap", "n": 4, "starts": "random"},
    "cases": {"scenario": "random", "n": 3, "cases": 4},
    "way points": {"scenario": "doorway", "n": 4, "actions": "way_points"},
    "vanish": {"scenario": "swap", "n": 4, "at_goal": "vanish", "starts": "random"},
    "pass": {"scenario": "swap", "n": 6, "on_collision": "pass"},
    "terminate": {"scenario": "swap", "n": 6, "starts": "random", "on_collision": "terminate"},
    "arms": {"scenario": "cell", "n": 2},
    "drones": {"scenario": "forest", "n": 3, "starts": "random"},
}


@pytest.mark.parametrize("name", WAYS)
def test_simulators(name: str) -> None:
    options = {"observation": ALL, "max_steps": 25, **WAYS[name]}

    def make(*, worlds: int, threads: int) -> Simulator:
        return Simulator(worlds=worlds, threads=threads, **options)

    simulator_test(make, steps=40)


@pytest.mark.parametrize("name", WAYS)
def test_environments(name: str) -> None:
    options = {"max_cycles": 20, "threads": 1, **WAYS[name]}
    environment_test(functools.partial(fgenv.parallel_env, **options), steps=25)


def test_learning_robots() -> None:
    make = functools.partial(gymnasium.make, "fgenv/swap-v0", n=3, starts="random", max_steps=20)
    environment_test(make, steps=25)
    environment_test(lambda: make().unwrapped, steps=25)


@pytest.mark.parametrize("name", ["three_tanks", "intersection"])
def test_scenarios(name: str) -> None:
    scenario_test(name, steps=12)


def digest(threads: int) -> str:
    """Return a hash of the results of long rollouts over several episodes."""
    rng, found = np.random.default_rng(0), hashlib.sha256()
    for name, worlds, starts in (("swap", 5, "random"), ("forest", 2, "random"), ("cell", 2, "")):
        ways: dict[str, Any] = {"n": 3, "clearance": True, "starts": starts or "scenario"}
        simulator = Simulator(name, worlds, threads=threads, max_steps=30, **ways)
        found.update(simulator.reset(seed=1).tobytes())
        for _ in range(45):
            arrays: list[Any] = [*simulator.step(simulator.sample(rng)), simulator.hit_points]
            for array in [*arrays, simulator.clearances, simulator.configurations]:
                found.update(array.tobytes())
    env = fgenv.parallel_env("swap", n=4, jitter=0.5, max_cycles=30, threads=threads)
    env.reset(seed=2)
    while env.agents:
        rows, rewards, *_ = env.step({name: rng.uniform(-1, 1, 2) for name in env.agents})
        found.update(np.array([*rewards.values()]).tobytes())
        found.update(b"".join(row.tobytes() for row in rows.values()))
    return found.hexdigest()


def test_rollouts_are_equal_for_all_threads_and_instruction_sets() -> None:
    """The default set is the best of the processor; the other one is the baseline."""
    code = "from envs.test_envs_contract import digest; print(digest(1))"
    env = {**os.environ, "FGENV_ISA": "baseline", "PYTHONPATH": str(TESTS)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=env)
    assert [digest(1), digest(2)] == [done.stdout.strip()] * 2, done.stderr


@settings(max_examples=15)
@given(st.lists(st.tuples(st.sampled_from("rsncm"), st.integers(0, 5)), max_size=12))
def test_any_order_of_calls_is_repeatable(calls: list[tuple[str, int]]) -> None:
    """Resets with and without a seed or of some worlds, steps and copies, in any order."""

    def play(through_copies: bool) -> list[bytes]:
        simulator = Simulator("swap", 3, n=3, starts="random", threads=1, max_steps=4)
        simulator.reset(seed=0)
        states = []
        for what, k in calls:
            if what == "r":
                simulator.reset(seed=k)
            elif what == "n":
                simulator.reset()
            elif what == "m":
                simulator.reset(worlds=[k % 3])
            elif what == "c" and through_copies:
                simulator = copy.deepcopy(simulator)
            elif what == "s":
                simulator.step(np.full((3, 3, 2), k / 5))
            states.append(simulator.observe().tobytes() + simulator.state())
        return states

    assert play(False) == play(True)


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("step", [np.zeros((1, 2, 2))]),
        ("observe", []),
        ("toward", [np.zeros((1, 2, 3))]),
        ("place", [0, 0, np.zeros(3), np.zeros(3)]),
        ("set_path", [0, 0, np.zeros((2, 3))]),
        ("state", []),
        ("world", []),
    ],
)
def test_before_the_first_reset_there_is_no_state(name: str, arguments: list[Any]) -> None:
    """Regression: reading a state before the first reset returned uninitialized memory."""
    simulator = Simulator("swap", n=2)
    for one in (simulator, copy.copy(simulator)):
        with pytest.raises(RuntimeError, match=f"{name}: before the first reset, call reset"):
            getattr(one, name)(*arguments)


class Drifting(FleetParallelEnv):
    """A simulator with rewards that depend on the number of steps of all instances."""

    count = 0

    def step(self, actions: Any) -> Any:
        rows, rewards, *rest = super().step(actions)
        Drifting.count += 1
        return rows, {name: r + Drifting.count for name, r in rewards.items()}, *rest


def test_violations_are_detected() -> None:
    make = functools.partial(Simulator, "swap", 1, n=2, autoreset=False, max_steps=9, threads=1)
    with pytest.raises(AssertionError, match="the same seed gave another rollout"):
        environment_test(lambda: Drifting(make()), steps=9)
    dice = np.random.default_rng(0)
    noise = Reward({}, own=((lambda s: dice.random((s.n_worlds, s.n_robots)), 1.0),))

    def noisy(*, worlds: int, threads: int) -> Simulator:
        return Simulator("swap", worlds, n=2, reward=noise, threads=threads)

    with pytest.raises(AssertionError, match="same seed"):
        simulator_test(noisy, steps=5)

"""The laws of the simulator and of its faces on several scenarios; the tests see faults."""

from __future__ import annotations

import copy
import functools
import os
import subprocess
import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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


def test_learners() -> None:
    make = functools.partial(gymnasium.make, "fgenv/swap-v0", n=3, starts="random", max_steps=20)
    environment_test(make, steps=25)
    environment_test(lambda: make().unwrapped, steps=25)


@pytest.mark.parametrize("name", ["three_tanks", "intersection"])
def test_scenarios(name: str) -> None:
    scenario_test(name, steps=12)


CODE = """
import hashlib
import numpy as np
import fgenv
from fgenv.envs import Simulator
digest = hashlib.sha256()
for name, worlds in (("swap", 5), ("forest", 2), ("cell", 2)):
    simulator = Simulator(name, worlds, starts="random" if name != "cell" else "scenario", n=3,
                          clearance=True, max_steps=20)
    rng = np.random.default_rng(0)
    digest.update(simulator.reset(seed=1).tobytes())
    for _ in range(30):
        for array in simulator.step(simulator.sample(rng)):
            digest.update(array.tobytes())
        digest.update(simulator.hit_points.tobytes() + simulator.clearances.tobytes())
env = fgenv.parallel_env("swap", n=4, jitter=0.5, max_cycles=30)
env.reset(seed=2)
while env.agents:
    rows, rewards, *_ = env.step({a: rng.uniform(-1, 1, 2) for a in env.agents})
    digest.update(np.array([*rewards.values()]).tobytes())
    digest.update(b"".join(row.tobytes() for row in rows.values()))
print(digest.hexdigest())
"""


def test_rollouts_are_the_same_for_all_threads_and_instruction_sets() -> None:
    runs = {}
    for isa, threads in (("baseline", "1"), ("v3", "2"), ("", "2")):
        env = {**os.environ, "FGENV_ISA": isa, "FGENV_THREADS": threads}
        runs[isa] = subprocess.Popen(
            [sys.executable, "-c", CODE], stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=env
        )
    told = {isa: run.communicate() for isa, run in runs.items()}
    if b"no AVX2" in told["v3"][1]:
        del told["v3"]
    assert all(out for out, _ in told.values()), told
    assert len({out for out, _ in told.values()}) == 1


@settings(max_examples=15)
@given(st.lists(st.tuples(st.sampled_from("rsncm"), st.integers(0, 5)), max_size=12))
def test_any_order_of_calls_is_repeatable(calls: list[tuple[str, int]]) -> None:
    """Reset with and without a seed, of some worlds, steps and copies, in any order."""

    def play(through_copies: bool) -> list[bytes]:
        simulator = Simulator("swap", 3, n=3, starts="random", threads=1, max_steps=4)
        simulator.reset(seed=0)
        told = []
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
            told.append(simulator.observe().tobytes() + simulator.state())
        return told

    assert play(False) == play(True)


class Drifting(FleetParallelEnv):
    """Its rewards depend on how often it was made to step: no law."""

    count = 0

    def step(self, actions: Any) -> Any:
        rows, rewards, *rest = super().step(actions)
        Drifting.count += 1
        return rows, {name: r + Drifting.count for name, r in rewards.items()}, *rest


def test_a_fault_is_seen() -> None:
    make = functools.partial(Simulator, "swap", 1, n=2, autoreset=False, max_steps=9, threads=1)
    with pytest.raises(AssertionError, match="the same seed gave another rollout"):
        environment_test(lambda: Drifting(make()), steps=9)
    dice = np.random.default_rng(0)
    noise = Reward({}, own=((lambda s: dice.random((s.n_worlds, s.n_robots)), 1.0),))

    def noisy(*, worlds: int, threads: int) -> Simulator:
        return Simulator("swap", worlds, n=2, reward=noise, threads=threads)

    with pytest.raises(AssertionError, match="same seed"):
        simulator_test(noisy, steps=5)

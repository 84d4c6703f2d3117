"""States of episodes, and starts and goals of a reset, on every interface."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import fgenv
from fgenv.agents import FleetVecEnv
from fgenv.arrays import Floats
from fgenv.envs import FleetEnv, FleetVectorEnv, Simulator

N, WORLDS = 3, 2
Step = Callable[[Any, np.random.Generator], list[Any]]


def flat(values: Any) -> list[Any]:
    """Rewards and observations as plain lists, so that they can be compared."""
    if isinstance(values, dict):
        return [[name, np.asarray(value).tolist()] for name, value in sorted(values.items())]
    return [np.asarray(values).tolist()]


def step_parallel(env: Any, rng: np.random.Generator) -> list[Any]:
    actions = {name: rng.uniform(-1, 1, env.action_space(name).shape) for name in env.agents}
    observations, rewards, *ends, _ = env.step(actions)
    return [flat(observations), flat(rewards), *map(flat, ends), list(env.agents)]


def step_aec(env: Any, rng: np.random.Generator) -> list[Any]:
    rows = []
    for _ in range(len(env.agents)):
        agent = env.agent_selection
        observation, reward, terminated, truncated, _ = env.last()
        over = terminated or truncated
        env.step(None if over else rng.uniform(-1, 1, env.action_space(agent).shape))
        rows.append([agent, observation.tolist(), reward, terminated, truncated])
    return rows


def step_gym(env: Any, rng: np.random.Generator) -> list[Any]:
    observations, rewards, *ends, _ = env.step(rng.uniform(-1, 1, env.action_space.shape))
    return [flat(observations), flat(rewards), *map(flat, ends)]


def step_rows(env: Any, rng: np.random.Generator) -> list[Any]:
    shape = (env.num_envs, *env.action_space.shape)
    return list(map(flat, env.step(rng.uniform(-1, 1, shape))[:3]))


OPTIONS: dict[str, Any] = {"n": N, "jitter": 0.3, "threads": 1}
INTERFACES: dict[str, tuple[Callable[[], Any], Step]] = {
    "parallel": (lambda: fgenv.parallel_env("swap", **OPTIONS), step_parallel),
    "aec": (lambda: fgenv.env("swap", **OPTIONS), step_aec),
    "single": (lambda: FleetEnv("swap", others="random", **OPTIONS), step_gym),
    "vector": (lambda: FleetVectorEnv("swap", WORLDS, others="random", **OPTIONS), step_gym),
    "rows": (lambda: FleetVecEnv("swap", WORLDS, **OPTIONS), step_rows),
}


def simulator_of(env: Any) -> Simulator:
    simulator: Simulator = getattr(env, "unwrapped", env).simulator
    return simulator


def begun(kind: str, options: dict[str, Any] | None = None) -> tuple[Any, Step]:
    """An environment at the first episode of seed 3."""
    make, step = INTERFACES[kind]
    env = make()
    if kind == "rows":
        env.seed(3)
        if options is not None:
            env.set_options(options)
        env.reset()
    else:
        env.reset(seed=3, options=options)
    return env, step


@pytest.mark.parametrize("kind", INTERFACES)
def test_an_episode_continues_from_its_state_bit_for_bit(kind: str) -> None:
    """Also the other robots' policy, which draws random numbers."""
    env, step = begun(kind)
    rng = np.random.default_rng(0)
    for _ in range(5):
        step(env, rng)
    state = env.get_state()
    first = [step(env, rng_) for rng_ in [np.random.default_rng(1)] for _ in range(8)]
    other = begun(kind)[0]
    for again in (env, env, other):  # a state can be used several times, and elsewhere
        again.set_state(state)
        rng_ = np.random.default_rng(1)
        assert [step(again, rng_) for _ in range(8)] == first


@pytest.mark.parametrize("kind", INTERFACES)
def test_the_state_of_another_environment_is_refused(kind: str) -> None:
    env = begun(kind)[0]
    other = begun("parallel")[0]
    state = env.get_state()
    wrong = fgenv.parallel_env("swap", n=N + 1)
    wrong.reset(seed=0)
    if kind == "parallel":
        with pytest.raises(ValueError, match="state"):
            wrong.set_state(state)
    else:
        with pytest.raises((ValueError, TypeError)):
            other.set_state(state)


def test_agents_are_those_of_the_simulator() -> None:
    """`set_state` and `place` of the simulator left `agents` as they were."""
    env, _ = begun("parallel")
    simulator, names = env.simulator, list(env.possible_agents)
    before = simulator.state()
    goal = simulator.goals[0, 0]
    simulator.place(0, 0, goal, goal)
    actions = {name: np.zeros(env.action_space(name).shape) for name in names}
    env.step(actions)
    assert env.agents == names[1:]
    simulator.set_state(before)
    assert env.agents == names
    env.step(actions)  # of all robots again


def test_an_episode_goes_on_after_a_robot_was_placed() -> None:
    """After the last arrival without autoreset, `step` said that the episode is over."""
    simulator = Simulator("swap", n=2, autoreset=False)
    simulator.reset(seed=0)
    starts, goals = simulator.configurations[0], simulator.goals[0]
    for i in range(2):
        simulator.place(0, i, goals[i], goals[i])
    rest = np.zeros((1, 2, simulator.action_size))
    simulator.step(rest)
    assert simulator.over.all()
    with pytest.raises(RuntimeError, match="is over"):
        simulator.step(rest)
    simulator.place(0, 1, starts[1], goals[1])
    assert not simulator.over.any()
    assert not simulator.step(rest).terminated.any()


@pytest.mark.parametrize("kind", INTERFACES)
def test_starts_and_goals_of_a_reset(kind: str) -> None:
    start, goal = np.array([0.5, 0.25, 1.0]), np.array([-0.5, 1.5, 0.0])
    options = {
        "starts": {"robot 2": start},
        "goals": {"robot 1": goal, "robot 2": goal * [1, -1, 1]},
    }
    env, step = begun(kind, options)
    plain = begun(kind)[0]
    simulator, before = simulator_of(env), simulator_of(plain)
    assert (simulator.configurations[:, 1] == start).all()
    assert (simulator.goals[:, 0] == goal).all()
    np.testing.assert_array_equal(
        simulator.configurations[:, [0, 2]], before.configurations[:, [0, 2]]
    )
    np.testing.assert_array_equal(simulator.goals[:, 2], before.goals[:, 2])
    assert step(env, np.random.default_rng(0)) != step(plain, np.random.default_rng(0))


def test_starts_by_world_and_for_a_mask() -> None:
    env = FleetVectorEnv("swap", 3, n=2, autoreset_mode="DISABLED")
    starts: Floats = np.array([[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.0]])
    env.reset(seed=0, options={"starts": {"robot 1": starts}})
    np.testing.assert_array_equal(env.simulator.configurations[:, 0], starts)
    mask = np.array([True, False, True])
    rows, _ = env.reset(options={"reset_mask": mask, "starts": {"robot 1": starts[:2] + 0.1}})
    expected = [starts[0] + 0.1, starts[1], starts[1] + 0.1]
    np.testing.assert_array_equal(env.simulator.configurations[:, 0], expected)
    np.testing.assert_array_equal(rows, env.simulator.observe()[:, 0])


@pytest.mark.parametrize("kind", ["parallel", "single", "vector", "rows"])
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"starts": {"robot 9": [0, 0, 0]}}, "starts: got 'robot 9', expected one of robot 1"),
        ({"goals": {"robot 1": [0, 0]}}, r"goals: 'robot 1': got shape \(2,\), expected \(3,\)"),
        ({"goals": {"robot 1": [0, 0, np.nan]}}, "goals: 'robot 1': got .* within the limits"),
        ({"starts": {"robot 1": [1e9, 0, 0]}}, "starts: 'robot 1': got .* within the limits"),
        ({"starts": [[0, 0, 0]]}, "starts: got list, expected a dict by name of robot"),
        ({"start": {"robot 1": [0, 0, 0]}}, "options: got 'start', expected starts or goals"),
        (
            {"starts": {"robot 1": [0, 0, 0], "robot 2": [0.1, 0, 0]}},
            "got 'robot 1' in contact with 'robot 2'",
        ),
    ],
)
def test_wrong_starts_and_goals_are_refused(
    kind: str, options: dict[str, Any], message: str
) -> None:
    env, step = begun(kind)
    reset = env.reset
    if kind == "rows":
        env.set_options(options)
        options = {}
    with pytest.raises((ValueError, TypeError), match=message):
        reset(**({"options": options} if options else {}))
    step(env, np.random.default_rng(0))  # it can still be used


def test_options_of_test_suites_are_ignored() -> None:
    fgenv.parallel_env("swap").reset(seed=0, options={"options": 1})


POLICIES = ("rest", "goto", "random", "orca", "replan:prioritized")


@pytest.mark.parametrize("starts", ["scenario", "random"])
@pytest.mark.parametrize("others", POLICIES)
def test_a_world_of_a_vector_environment_is_the_single_one(others: str, starts: str) -> None:
    """World k of seed s is the environment of seed s + k, with each policy of the others."""
    options = {**OPTIONS, "starts": starts, "others": others, "max_steps": 12}
    vector = FleetVectorEnv("swap", WORLDS, autoreset_mode="SAME_STEP", **options)
    singles = [FleetEnv("swap", **options) for _ in range(WORLDS)]
    rows, _ = vector.reset(seed=5)
    for k, single in enumerate(singles):
        np.testing.assert_array_equal(single.reset(seed=5 + k)[0], rows[k])
    rng = np.random.default_rng(0)
    for _ in range(30):  # over two ends of episodes
        actions = rng.uniform(-1, 1, vector.action_space.shape)
        rows, rewards, terminated, truncated, _ = vector.step(actions)
        for k, single in enumerate(singles):
            row, reward, *ends, _ = single.step(actions[k])
            assert (reward, ends) == (rewards[k], [terminated[k], truncated[k]])
            if any(ends):
                row = single.reset()[0]
            np.testing.assert_array_equal(row, rows[k])

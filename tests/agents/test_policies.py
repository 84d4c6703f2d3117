"""Policies: the protocol, and `goto` in free space."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.episodes import DRIVES, alone

from fgenv.agents import GoToPolicy, RandomPolicy, run_episode
from fgenv.envs import Simulator, View, policy_of
from fgenv.metrics import Results

MODES = ("drive", "way_points")
NAMES = ("goto", "orca", "random", "rest", "plan", "replan")


def begun(policy: str, simulator: Simulator, seed: int = 0) -> np.ndarray:
    """Return the first actions of a policy."""
    made = policy_of(policy, seed)
    observations = simulator.reset(seed=0)
    made.reset(View(simulator))
    return np.asarray(made.act(observations))


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("kind", DRIVES)
def test_goto_reaches_every_goal_in_free_space(kind: str, mode: str) -> None:
    for seed in range(12):
        simulator = Simulator(alone(kind, seed), actions=mode, autoreset=False)
        run_episode(simulator, GoToPolicy())
        (robot,) = Results.of(simulator).robots
        assert robot.success, f"seed {seed}"


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("kind", DRIVES)
def test_rest_does_not_move(kind: str, mode: str) -> None:
    simulator = Simulator(alone(kind), actions=mode, autoreset=False)
    record = run_episode(simulator, policy_of("rest"), steps=20)
    at = record["configurations"]
    np.testing.assert_allclose(at, np.broadcast_to(at[0], at.shape), atol=1e-12)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("policy", NAMES)
@pytest.mark.parametrize("name", ["swap", "forest", "cell"])
def test_actions_have_the_expected_shape_and_range(name: str, policy: str, mode: str) -> None:
    simulator = Simulator(name, 3, n=2, actions=mode)
    if policy == "orca" and name != "swap":
        with pytest.raises(ValueError, match="expected discs on a plane"):
            begun(policy, simulator)
        return
    method = ":composite" if policy in ("plan", "replan") else ""  # the fastest
    actions = begun(policy + method, simulator)
    assert actions.shape == (3, 2, simulator.action_size)
    assert actions.dtype == np.float64
    assert (np.abs(actions) <= 1).all()
    assert np.isfinite(simulator.step(actions).observations).all()


def test_same_seed_same_actions() -> None:
    simulator = Simulator("swap", 2, n=4)
    a, b, c = (begun("random", simulator, seed) for seed in (5, 5, 6))
    np.testing.assert_array_equal(a, b)
    assert (a != c).all()


def test_random_differs_between_episodes() -> None:
    simulator, policy = Simulator("swap", n=4), RandomPolicy(5)
    acts = []
    for seed in (0, None, 0):
        observations = simulator.reset(seed)
        policy.reset(View(simulator))
        acts.append(policy.act(observations))
    assert (acts[0] != acts[1]).all()
    assert (acts[0] == acts[2]).all()  # the first episode of the same seed


def test_random_in_many_worlds_is_random_in_each() -> None:
    many = Simulator("swap", 3, n=4)
    rows = [begun("random", many, 5)[w] for w in range(3)]
    for w in range(3):
        simulator = Simulator("swap", n=4)
        simulator.reset(seed=w)
        policy = RandomPolicy(5)
        policy.reset(View(simulator))
        np.testing.assert_array_equal(policy.act(simulator.observe())[0], rows[w])


def test_any_class_with_the_protocol_is_a_policy() -> None:
    class Circle:
        def reset(self, view: View) -> None:
            self.shape = view.n_worlds, view.n_robots, view.action_size

        def act(self, observations: np.ndarray) -> np.ndarray:
            return np.full(self.shape, 0.5)

    record = run_episode(Simulator("swap", n=2, autoreset=False), Circle(), steps=7)
    assert (len(record), record.policy) == (7, "Circle")


def test_unknown_policy_raises_with_the_closest_name() -> None:
    with pytest.raises(ValueError, match=r"policy: got 'gotoo', .*; did you mean 'goto'\?"):
        policy_of("gotoo")
    with pytest.raises(ValueError, match=r"expected one of: goto, .*random, rest"):
        policy_of("xyz")
    with pytest.raises(ValueError, match="seed: got -1, expected 0 or more"):
        policy_of("random", -1)


@pytest.mark.parametrize("policy", NAMES)
def test_acting_before_reset_raises(policy: str) -> None:
    with pytest.raises(RuntimeError, match="act before reset"):
        policy_of(policy).act(np.zeros((1, 1, 1), dtype=np.float32))


def test_an_episode_of_several_worlds_raises() -> None:
    with pytest.raises(ValueError, match="simulator: got 3 worlds, expected one"):
        run_episode(Simulator("swap", 3, n=2, autoreset=False), GoToPolicy())


def test_a_view_follows_its_simulator_read_only() -> None:
    simulator = Simulator("swap", n=2, autoreset=False)
    view = View(simulator)
    simulator.reset(seed=0)
    before = simulator.state()
    for name in ("configurations", "goals", "velocities", "moving", "steps"):
        getattr(view, name)[:] = 1
        with pytest.raises(AttributeError):
            setattr(view, name, 0)
    world = view.world()
    world.remove(view.names[0])
    assert simulator.state() == before
    assert view.moving.tolist() == [[True, True]]
    simulator.step(view.toward(view.goals))
    assert view.steps.tolist() == [1]
    np.testing.assert_array_equal(view.configurations, simulator.configurations)
    assert (view.dt, view.horizon) == (simulator.dt, simulator.horizon)
    assert (view.robots, view.layouts) == (simulator.robots, simulator.layouts)


@pytest.mark.parametrize("mode", MODES)
def test_invalid_targets_raise(mode: str) -> None:
    simulator = Simulator("swap", n=2, actions=mode)
    simulator.reset(seed=0)
    view = View(simulator)
    with pytest.raises(ValueError, match=r"targets: got shape \(2, 3\), expected \(1, 2, 3\)"):
        view.toward(np.zeros((2, 3)))
    with pytest.raises(ValueError, match="targets"):
        view.toward(np.full((1, 2, 3), np.nan))


def test_a_policy_of_a_python_file(tmp_path: Path) -> None:
    """A class, with or without a seed, an object and a function of observations are policies."""
    file = tmp_path / "mine.py"
    file.write_text(
        "import numpy as np\n"
        "class Seeded:\n"
        "    def __init__(self, seed):\n        self.seed = seed\n"
        "    def reset(self, view):\n        pass\n"
        "    def act(self, observations):\n"
        "        return np.full((*observations.shape[:2], 2), 0.01 * self.seed)\n"
        "instance = Seeded(3)\n"
        "def still(observations):\n"
        "    return np.zeros((*observations.shape[:2], 2))\n",
        encoding="utf-8",
    )
    expected = {"Seeded": 0.07, "instance": 0.03, "still": 0.0}
    for name, action in expected.items():
        simulator = Simulator("swap", n=2)
        assert np.allclose(begun(f"{file}:{name}", simulator, seed=7), action)
    with pytest.raises(ValueError, match=r"mine\.py has no 'stil'; did you mean 'still'\?"):
        policy_of(f"{file}:stil")
    with pytest.raises(FileNotFoundError, match=r"none\.py does not exist, expected a Python file"):
        policy_of(f"{tmp_path / 'none.py'}:Mine")

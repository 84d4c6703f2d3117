"""Residual actions: over `goto` or ORCA, along a path, and near the goal."""

import numpy as np
import pytest

from fgenv.agents import OrcaPolicy
from fgenv.agents.policies.residual import ResidualConfig, ResidualController
from fgenv.agents.tracking.path_targets import path_targets
from fgenv.envs import Observation, Simulator, View

HINT = Observation(path_hint=True, path="shortest", look_ahead=0.5)


@pytest.fixture
def view() -> View:
    simulator = Simulator("random", 2, n=3, cases=2, drive="differential", observation=HINT)
    simulator.reset(seed=0)
    return View(simulator)


def acting(base: ResidualConfig, view: View) -> ResidualController:
    """Return a controller for the simulator of a view."""
    made = ResidualController(base)
    made.reset(view)
    return made


def test_a_zero_output_follows_the_path(view: View) -> None:
    seen = view._simulator.observe()
    asked = np.zeros((2, 3, 2))
    found = acting(ResidualConfig(residual=2.0), view).actions(asked, seen)
    assert (found == np.clip(view.toward(path_targets(view, seen)), -1, 1)).all()
    assert (acting(ResidualConfig(), view).actions(asked, seen) == asked).all()


def test_a_large_residual_overrides_goto(view: View) -> None:
    seen = view._simulator.observe()
    for end in (-1.0, 1.0):
        asked = np.full((2, 3, 2), end)
        assert (acting(ResidualConfig(residual=2.0), view).actions(asked, seen) == end).all()


def test_targets_are_at_the_hint_and_faced(view: View) -> None:
    simulator = view._simulator
    q, seen = simulator.configurations, simulator.observe()
    found = path_targets(view, seen)
    part = next(part for part in view.layouts[0] if part.name == "path_hint")
    x, y = np.moveaxis(seen[..., part.slice].astype(float), -1, 0)
    yaw = q[..., 2]
    expected = q[..., :2] + np.stack(
        [np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y], axis=-1
    )
    np.testing.assert_allclose(found[..., :2], expected, atol=1e-6)
    ahead = expected - q[..., :2]
    assert (simulator.remaining > np.pi / 2.0).all()  # s of turning at 1 m/s: too far
    np.testing.assert_allclose(found[..., 2], np.arctan2(ahead[..., 1], ahead[..., 0]), atol=1e-5)


def test_a_robot_turns_on_the_way_to_its_goal() -> None:
    simulator = Simulator("random", n=1, fill=0.0, drive="holonomic", autoreset=False)
    simulator.reset(seed=0)
    simulator.place(0, 0, [-2.0, 0.0, 0.0], [2.0, 0.0, np.pi])
    base, steps = acting(ResidualConfig(residual=2.0), View(simulator)), 0
    seen, nothing = simulator.observe(), np.zeros((1, 1, 3))
    while simulator.arrival_steps[0, 0] < 0:
        yaw = simulator.configurations[0, 0, 2]
        assert yaw == pytest.approx(0.0) or simulator.remaining[0, 0] < np.pi / 2 + 1e-6
        seen = simulator.step(base.actions(nothing, seen)).observations
        steps += 1
    assert steps == pytest.approx(40, abs=2)  # 4 m at 1 m/s; the turn takes no extra time


def test_targets_of_other_bases_are_goals() -> None:
    simulator = Simulator("forest", n=2)
    simulator.reset(seed=0)
    assert (path_targets(View(simulator), simulator.observe()) == simulator.goals).all()


def test_goto_acts_near_the_goal(view: View) -> None:
    seen = view._simulator.observe()
    far = float(np.mean(view.remaining))
    asked = np.full((2, 3, 2), 0.25)
    found = acting(ResidualConfig(near=far), view).actions(asked, seen)
    near = view.remaining < far
    assert 0 < near.sum() < near.size
    assert (found[near] == view.toward(view.goals)[near]).all()
    assert (found[~near] == 0.25).all()


def test_a_robot_that_follows_its_path_arrives() -> None:
    simulator = Simulator("doorway", n=1, drive="holonomic", observation=HINT, autoreset=False)
    for seed in range(5):
        seen = simulator.reset(seed=seed)
        base = acting(ResidualConfig(near=0.3, residual=2.0), View(simulator))
        for _ in range(200):
            step = simulator.step(base.actions(np.zeros((1, 1, simulator.action_size)), seen))
            seen = step.observations
            if step.terminated[0]:
                break
        assert simulator.arrival_steps[0, 0] > 0


def test_a_zero_output_over_orca_is_orca(view: View) -> None:
    seen = view._simulator.observe()
    orca = OrcaPolicy.guided()
    orca.reset(view)
    base = acting(ResidualConfig(near=0.3, residual=1.5, orca=True), view)
    assert (base.actions(np.zeros((2, 3, 2)), seen) == orca.act(seen)).all()


def test_over_orca_the_output_shifts_the_preferred_velocity() -> None:
    simulator = Simulator("random", n=2, fill=0.0, drive="holonomic", autoreset=False)
    simulator.reset(seed=0)
    ahead = np.array([np.cos(0.5), np.sin(0.5)])  # faces the goal, so that it does not turn
    simulator.place(0, 0, [0.0, 0.0, 0.5], [*(3.0 * ahead), 0.5])
    simulator.place(0, 1, [0.0, 6.0, 0.0], [3.0, 6.0, 0.0])
    base = acting(ResidualConfig(residual=2.0, orca=True), View(simulator))
    asked = np.zeros((1, 2, 3))
    asked[0, 0, 1] = 1.0  # left, toward the other robot
    seen = simulator.observe()
    seen = simulator.step(base.actions(asked, seen)).observations
    v = ahead + 2.0 * np.array([-ahead[1], ahead[0]])
    by = 0.1 * v / np.linalg.norm(v)  # at 1 m/s, without near robots
    np.testing.assert_allclose(simulator.configurations[0, 0, :2], by, atol=1e-6)
    simulator.place(0, 1, [0.0, 2.0, 0.0], [3.0, 2.0, 0.0])
    for _ in range(20):
        seen = simulator.step(base.actions(asked, seen)).observations
        assert (simulator.hits < 0).all()
    assert simulator.configurations[0, 0, 1] > 1.0


def test_near_the_goal_the_output_is_ignored_over_orca(view: View) -> None:
    seen = view._simulator.observe()
    distance = float(np.mean(view.remaining))
    base = acting(ResidualConfig(near=distance, residual=1.5, orca=True), view)
    nothing, some = (base.actions(np.full((2, 3, 2), x), seen) for x in (0.0, -1.0))
    near = view.remaining < base.config.near
    assert 0 < near.sum() < near.size
    same = (nothing == some).all(axis=-1)
    assert same[near].all()
    assert not same[~near].all()


def test_orca_without_planar_bases_raises() -> None:
    simulator = Simulator("forest", n=2)
    simulator.reset(seed=0)
    with pytest.raises(ValueError, match="orca: 'robot 1' has a free base"):
        acting(ResidualConfig(residual=1.0, orca=True), View(simulator))

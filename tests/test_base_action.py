"""What is made of a network's output: beside `goto`, along a path, and near the goal."""

import numpy as np
import pytest

from fgenv.agents.base_action import BaseAction, targets
from fgenv.envs import Observation, Simulator, View

HINT = Observation(path_hint=True, path="shortest", look_ahead=0.5)


@pytest.fixture
def view() -> View:
    simulator = Simulator("random", 2, n=3, cases=2, drive="differential", observation=HINT)
    simulator.reset(seed=0)
    return View(simulator)


def test_an_output_of_nothing_goes_along_the_path(view: View) -> None:
    seen = view._simulator.observe()
    asked = np.zeros((2, 3, 2))
    found = BaseAction(residual=2.0).actions(asked, view, seen)
    assert (found == np.clip(view.toward(targets(view, seen)), -1, 1)).all()
    assert (BaseAction().actions(asked, view, seen) == asked).all()


def test_a_residual_takes_over_whatever_goto_does(view: View) -> None:
    seen = view._simulator.observe()
    for end in (-1.0, 1.0):
        found = BaseAction(residual=2.0).actions(np.full((2, 3, 2), end), view, seen)
        assert (found == end).all()


def test_targets_are_where_the_hint_is(view: View) -> None:
    simulator = view._simulator
    q, seen = simulator.configurations, simulator.observe()
    part = next(part for part in view.layouts[0] if part.name == "path_hint")
    x, y = np.moveaxis(seen[..., part.slice].astype(float), -1, 0)
    yaw = q[..., 2]
    wanted = q[..., :2] + np.stack(
        [np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y], axis=-1
    )
    np.testing.assert_allclose(targets(view, seen)[..., :2], wanted, atol=1e-6)
    assert (targets(view, seen)[..., 2] == simulator.goals[..., 2]).all()


def test_without_a_hint_targets_are_goals() -> None:
    simulator = Simulator("forest", n=2)
    simulator.reset(seed=0)
    view = View(simulator)
    assert (targets(view, simulator.observe()) == simulator.goals).all()


def test_near_its_goal_a_robot_does_what_goto_does(view: View) -> None:
    seen = view._simulator.observe()
    far = float(np.mean(view.remaining))
    asked = np.full((2, 3, 2), 0.25)
    found = BaseAction(near=far).actions(asked, view, seen)
    near = view.remaining < far
    assert 0 < near.sum() < near.size
    assert (found[near] == view.toward(view.goals)[near]).all()
    assert (found[~near] == 0.25).all()


def test_who_follows_its_path_alone_arrives() -> None:
    simulator = Simulator("doorway", n=1, drive="holonomic", observation=HINT, autoreset=False)
    for seed in range(5):
        seen, base = simulator.reset(seed=seed), BaseAction(near=0.3, residual=2.0)
        for _ in range(200):
            asked = np.zeros((1, 1, simulator.action_size))
            step = simulator.step(base.actions(asked, View(simulator), seen))
            seen = step.observations
            if step.terminated[0]:
                break
        assert simulator.arrival_steps[0, 0] > 0

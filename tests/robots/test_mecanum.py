"""Mecanum drive: its model, and its use in scenarios, planning and simulation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

import fgenv
from fgenv.agents import run_episode
from fgenv.envs import Simulator, policy_of
from fgenv.metrics import Results
from fgenv.robots import Link, Robot
from fgenv.robots.drives.mecanum import Mecanum
from fgenv.scenarios import Scenario

DRIVE = Mecanum(0.05, 0.15, 0.2, wheel_speed=20.0, wheel_acceleration=80.0)


@pytest.fixture
def scenario(tmp_path: Path) -> Scenario:
    """Four discs that swap places, with mecanum wheels, from a file."""
    data = Scenario.load("swap", n=4, jitter=0.2).model_dump(mode="json", exclude_none=True)
    data["models"]["disc"]["drive"] = {
        "kind": "mecanum",
        "wheel_radius": 0.05,
        "half_track": 0.15,
        "half_wheelbase": 0.2,
        "wheel_speed": 20.0,
        "wheel_acceleration": 80.0,
    }
    file = tmp_path / "mecanum.yaml"
    file.write_text(yaml.safe_dump(data), encoding="utf-8")
    return Scenario.load(file)


def test_wheel_speeds_are_those_of_modern_robotics() -> None:
    """K. Lynch and F. Park, equation 13.10, with l = half_wheelbase and w = half_track."""
    r, w, length = 0.05, 0.15, 0.2
    h = np.array(  # wheels: front left, front right, rear right, rear left; columns: yaw, x, y
        [
            [-length - w, 1, -1],
            [length + w, 1, 1],
            [length + w, 1, -1],
            [-length - w, 1, 1],
        ]
    )
    twist = np.random.default_rng(0).normal(size=(20, 3))
    wheels = DRIVE.part_values(twist[:, [1, 2, 0]])
    np.testing.assert_allclose(wheels[:, [0, 1, 3, 2]], twist @ h.T / r, rtol=1e-12)


def test_a_command_in_one_direction_is_in_force_as_a_whole() -> None:
    robot = Robot("cart", [Link("body")], base="planar", drive=DRIVE)
    zero = np.zeros(3)
    for k, action in enumerate(DRIVE.actions(robot)):
        found = DRIVE.limited(robot, np.eye(3)[k], zero, 10.0)
        np.testing.assert_allclose(found, np.eye(3)[k] * action.high, rtol=1e-12)
    diagonal = DRIVE.limited(robot, np.array([1.0, 1.0, 0.0]), zero, 10.0)
    np.testing.assert_allclose(diagonal, [0.5, 0.5, 0.0], rtol=1e-12)


@pytest.mark.parametrize("policy", ["goto", "orca"])
def test_policies_drive_it_within_the_limits_of_its_wheels(policy: str, scenario: Scenario) -> None:
    simulator = Simulator(scenario, autoreset=False)
    record = run_episode(simulator, policy_of(policy))
    if policy == "orca":
        assert all(robot.success for robot in Results.of(simulator).robots)
    steps = record["configurations"]
    assert steps.shape[0] > 10
    robot = simulator.robots[0]
    for i in range(simulator.n_robots):
        q = steps[:, i].reshape(len(steps), -1)[:, :3]
        actions, residual = DRIVE.inverse(robot, q[:-1], q[1:], simulator.dt)
        assert np.abs(DRIVE.part_values(actions)).max() <= 20.0 * (1 + 1e-6)
        np.testing.assert_allclose(residual, 0.0, atol=1e-9)


@pytest.mark.parametrize("method", ["composite", "prioritized"])
def test_plans_keep_the_limits_of_its_wheels(method: str, scenario: Scenario) -> None:
    plan = fgenv.plan(scenario, method=method, time_limit=60.0)
    assert fgenv.verify(plan)

"""Laws that hold for every registered drive, with and without limits of acceleration."""

from __future__ import annotations

import math
from dataclasses import fields
from itertools import pairwise
from typing import Any, get_type_hints

import numpy as np
import pytest

from fgenv.arrays import Floats
from fgenv.planners.limits import broken_limits
from fgenv.planners.timing import steps_of
from fgenv.robots import DifferentialDrive, Drive, Joint, JointVelocity, Link, Platform, Robot
from fgenv.robots.drives import DRIVES
from fgenv.scenarios.drive_specs import DriveSpec

DT = 0.1
SAMPLES = 300
VALUES = {"m": 1.0, "m/s": 1.0, "rad/s": 2.0}  # of required fields, by unit
ACCELERATION = 1.5
NESTED = {Platform: DifferentialDrive(1.0, 2.0), JointVelocity: JointVelocity()}


def example(kind: str, limited: bool) -> Drive:
    """A drive of a kind, from its fields; `limited`: with limits of acceleration."""
    hints = get_type_hints(DRIVES[kind], include_extras=True)
    values: dict[str, Any] = {}
    for item in fields(DRIVES[kind]):  # type: ignore[arg-type]
        about = getattr(hints[item.name], "__metadata__", None)
        if about is None:
            values[item.name] = NESTED[hints[item.name]]
        elif item.default == math.inf:  # steering rates stay unlimited: paths of cars have corners
            limited_field = limited and about[0].unit.endswith("^2")
            values[item.name] = ACCELERATION if limited_field else math.inf
        elif item.default is not None:
            values[item.name] = VALUES[about[0].unit]
    return DRIVES[kind](**values)


def robot_of(drive: Drive) -> Robot:
    """A robot that the drive moves, in a workspace of 20 m."""
    base = next((part.base for part in drive.parts if part.base), "fixed")
    d = {"fixed": 0, "planar": 2, "free": 3}[base]
    workspace = np.array([[-10.0] * d, [10.0] * d]) if d else None
    links, joints = [Link("body")], []
    if any(part.base is None for part in drive.parts):
        links += [Link("mast"), Link("arm")]
        joints = [
            Joint("lift", "prismatic", "body", "mast", lower=-9, upper=9, velocity=0.5),
            Joint("elbow", "continuous", "mast", "arm", velocity=2.0),
        ]
    return Robot("robot", links, joints, base, workspace=workspace, drive=drive)


def configurations(robot: Robot, rng: np.random.Generator, n: int, size: float = 5.0) -> Floats:
    """Level configurations (n, nq) within `size` of the origin."""
    q = rng.uniform(-size, size, (n, robot.nq))
    q[:, robot.endless] = rng.uniform(-math.pi, math.pi, (n, int(robot.endless.sum())))
    if robot.base == "free":
        yaw = rng.uniform(-math.pi, math.pi, n)
        q[:, 3:7] = np.stack([0 * yaw, 0 * yaw, np.sin(yaw / 2), np.cos(yaw / 2)], axis=1)
    return q


@pytest.fixture(params=[(kind, limited) for kind in sorted(DRIVES) for limited in (False, True)])
def robot(request: Any) -> Robot:
    return robot_of(example(*request.param))


def test_the_inverse_model_inverts_the_forward_model(robot: Robot) -> None:
    rng, drive = np.random.default_rng(0), robot.required_drive
    commands = rng.uniform(0.1, 1.0, (SAMPLES, len(robot.actions)))
    commands *= rng.choice([-1.0, 1.0], commands.shape)
    actions = drive.limited(robot, commands, np.zeros_like(commands), DT)
    q = configurations(robot, rng, SAMPLES)
    found, residual = drive.inverse(robot, q, drive.forward(robot, q, actions, DT), DT)
    np.testing.assert_allclose(found, actions, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(residual, 0.0, atol=1e-8)


def test_actions_in_force_keep_the_limits(robot: Robot) -> None:
    rng, drive = np.random.default_rng(1), robot.required_drive
    before = np.zeros(len(robot.actions))
    for _ in range(SAMPLES):
        commands = rng.uniform(-1.5, 1.5, len(before))
        actions = drive.limited(robot, commands, before, DT)
        too_fast, too_sudden = drive.limit_violations(robot, actions, before, DT, 1e-12)
        assert not too_fast.any()
        assert not too_sudden.any()
        before = actions


def test_steering_ends_at_its_target(robot: Robot) -> None:
    rng = np.random.default_rng(2)
    methods = robot.required_drive.base_drive.steering_methods if robot.base == "planar" else [None]
    for q0, q1 in zip(configurations(robot, rng, 20), configurations(robot, rng, 20), strict=True):
        for method in methods:
            rows = robot.steer(q0, q1, method)
            np.testing.assert_array_equal(rows[0], q0)
            np.testing.assert_array_equal(rows[-1], q1)
            assert len(rows) == 2 or method != "straight"


def test_a_timed_path_is_tracked_within_the_limits(robot: Robot) -> None:
    rng, drive = np.random.default_rng(3), robot.required_drive
    targets = configurations(robot, rng, 4, size=3.0)
    path = np.concatenate([targets[:1], *[robot.steer(a, b)[1:] for a, b in pairwise(targets)]])
    steps = steps_of(robot, path, DT)
    assert broken_limits(robot, steps, DT) is None
    q, before = steps[0], np.zeros(len(robot.actions))
    for target in steps[1:]:
        commands = drive.tracking_action(robot, q, target, DT)
        before = drive.limited(robot, commands, before, DT)
        q = drive.forward(robot, q, before, DT)
        assert robot.displacement_bound(q, target) <= drive.base_drive.tracking_error
    assert robot.displacement_bound(q, targets[-1]) <= drive.base_drive.tracking_error


def test_a_drive_in_a_scenario_file_is_the_same_drive(robot: Robot) -> None:
    drive = robot.required_drive
    data = DriveSpec.of(drive).model_dump(mode="json", exclude_none=True)
    assert data["kind"] == drive.kind
    assert type(DriveSpec.of(drive)).model_validate(data).build() == drive

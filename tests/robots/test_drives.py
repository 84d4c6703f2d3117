"""Drives: their actions and limits, and the robots that they fit."""

from __future__ import annotations

import math
import pickle
from typing import Any

import numpy as np
import pytest
import trimesh
from support.robots import BOX

from fgenv.robots import (
    Car,
    DifferentialDrive,
    Drive,
    Drone,
    Holonomic,
    Joint,
    JointVelocity,
    Link,
    MobileManipulator,
    Robot,
)


def arm(base: str = "fixed", speed: float = 2.0, drive: Drive | None = None) -> Robot:
    joints = [
        Joint("lift", "prismatic", "base", "mast", lower=0, upper=1, velocity=0.5),
        Joint("elbow", "revolute", "mast", "arm", lower=-1, upper=1, velocity=speed),
    ]
    return Robot("arm", [Link("base"), Link("mast"), Link("arm")], joints, base, drive=drive)


def test_a_robot_in_one_line(tmp_path: Any) -> None:
    trimesh.creation.box((100, 200, 300)).export(tmp_path / "cart.stl")
    drive = DifferentialDrive(speed=1.0, turn_rate=1.5)
    robot = Robot.from_mesh(tmp_path / "cart.stl", scale=0.001, drive=drive)
    assert repr(robot) == "Robot('cart': planar base, 3 dof, 1 links, 1 shapes)"
    assert robot.drive is drive
    np.testing.assert_allclose(np.ptp(robot.parts[0].shape.vertices, axis=0), [0.1, 0.2, 0.3])
    assert Robot.from_mesh(BOX, "free").nq == 7
    assert Robot.from_mesh(BOX, "fixed", name="post").nq == 0


ACTIONS: list[tuple[Drive, str, list[tuple[str, str, float, float]]]] = [
    (
        Holonomic(1.0, 2.0),
        "planar",
        [("vx", "m/s", -1, 1), ("vy", "m/s", -1, 1), ("yaw_rate", "rad/s", -2, 2)],
    ),
    (
        DifferentialDrive(1.0, 2.0, reverse=0.5),
        "planar",
        [("v", "m/s", -0.5, 1), ("yaw_rate", "rad/s", -2, 2)],
    ),
    (
        Car(wheelbase=2.0, min_turning_radius=2.0, speed=3.0),
        "planar",
        [("v", "m/s", -3, 3), ("steering", "rad", -math.pi / 4, math.pi / 4)],
    ),
    (
        Drone(2.0, 1.0, climb=0.5),
        "free",
        [
            ("vx", "m/s", -2, 2),
            ("vy", "m/s", -2, 2),
            ("vz", "m/s", -0.5, 0.5),
            ("yaw_rate", "rad/s", -1, 1),
        ],
    ),
    (
        JointVelocity(speed=1.0),
        "fixed",
        [("lift", "m/s", -0.5, 0.5), ("elbow", "rad/s", -1, 1)],
    ),
    (
        MobileManipulator(DifferentialDrive(1.0, 2.0)),
        "planar",
        [
            ("v", "m/s", -1, 1),
            ("yaw_rate", "rad/s", -2, 2),
            ("lift", "m/s", -0.5, 0.5),
            ("elbow", "rad/s", -2, 2),
        ],
    ),
]


@pytest.mark.parametrize(("drive", "base", "expected"), ACTIONS, ids=lambda x: type(x).__name__)
def test_an_action_and_its_limits(drive: Drive, base: str, expected: list[Any]) -> None:
    robot = arm(base, drive=drive)
    actions = robot.actions
    assert actions == drive.actions(robot)
    assert [action[:2] for action in actions] == [item[:2] for item in expected]
    np.testing.assert_allclose(
        [(a.low, a.high) for a in actions], [item[2:] for item in expected], rtol=1e-14
    )
    assert all(action.rate > 0 for action in actions)
    assert pickle.loads(pickle.dumps(robot)).drive == drive


@pytest.mark.parametrize(("drive", "base", "expected"), ACTIONS, ids=lambda x: type(x).__name__)
def test_a_drive_that_does_not_fit_is_refused(drive: Drive, base: str, expected: list[Any]) -> None:
    if isinstance(drive, JointVelocity):
        with pytest.raises(ValueError, match="got 'robot' without joints"):
            Robot("robot", [Link("a")], drive=drive)
        return
    other = "free" if base == "planar" else "planar"
    with pytest.raises(ValueError, match=f"got a {other} base of 'arm', expected base='{base}'"):
        arm(other, drive=drive)


FAULTS: list[tuple[Any, str]] = [
    (lambda: Holonomic(0.0, 1.0), "Holonomic: speed: got 0, expected a limit over 0"),
    (lambda: Holonomic(math.inf, 1.0), "Holonomic: speed: got inf, expected a finite number"),
    (lambda: Drone(1.0, math.nan), "Drone: turn_rate: got nan"),
    (lambda: Car(1.0, -2.0, 1.0), "Car: min_turning_radius: got -2.0"),
    (lambda: DifferentialDrive(1.0, 1.0, acceleration=-1.0), "DifferentialDrive: acceleration"),
    (lambda: DifferentialDrive("1", 1.0), "DifferentialDrive: speed: got '1'"),  # type: ignore[arg-type]
    (
        lambda: MobileManipulator(JointVelocity()),  # type: ignore[arg-type]
        "platform: got JointVelocity, expected a Platform",
    ),
    (lambda: MobileManipulator(None), "platform: got NoneType, expected a Platform"),  # type: ignore[arg-type]
    (
        lambda: arm(speed=math.inf, drive=JointVelocity()),
        "got no speed limit of joint 'elbow', expected one; give Join",
    ),
    (lambda: arm(drive="car"), "drive: got str, expected a Drive"),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("make", "message"), FAULTS, ids=[m for _, m in FAULTS])
def test_invalid_limits_are_errors(make: Any, message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=message):
        make()

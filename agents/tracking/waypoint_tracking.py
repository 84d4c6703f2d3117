"""Actions that lead robots to where they are to be after the step: drives, or way points."""

from __future__ import annotations

import math

import numpy as np

from fgenv.arrays import Flags, Floats
from fgenv.robots import (
    Action,
    Car,
    DifferentialDrive,
    Drive,
    JointVelocity,
    MobileManipulator,
    Robot,
)
from fgenv.robots.inverse_drive import actions_between

STILL = 1e-9  # m/s: none
SLACK = 1e-6  # of a limit


def drives(robot: Robot, q: Floats, target: Floats, dt: float) -> Floats:
    """Actions in [-1, 1] that lead from q to target (..., nq) in a step, (..., size)."""
    asked = actions_between(robot, q, target, dt)
    low, high = limits(robot.actions)
    return np.asarray(np.clip((asked - 0.5 * (low + high)) / (0.5 * (high - low)), -1.0, 1.0))


def limits(actions: tuple[Action, ...]) -> tuple[Floats, Floats]:
    """The least and the greatest of each number."""
    return np.array([a.low for a in actions]), np.array([a.high for a in actions])


def can(robot: Robot, q: Floats, target: Floats, before: Floats, dt: float) -> bool:
    """Whether a robot gets from q to target (nq,) in a step, by what its drive did before it."""
    asked = actions_between(robot, q, target, dt)
    low, high = limits(robot.actions)
    most = np.array([a.rate for a in robot.actions]) * dt
    room = SLACK * (high - low)
    within = (asked >= low - room) & (asked <= high + room)
    return bool((within & (np.abs(asked - before[: len(asked)]) <= most + room)).all())


def way_points(
    robot: Robot, q: Floats, target: Floats, dt: float, seconds: float
) -> tuple[Floats, Flags]:
    """Way points after which a robot has got from q to target (worlds, nq) in one step.

    A way point is driven at as if to stop there. One that is farther on, by the way that stopping
    takes, lets the robot go on at its speed.

    Returns:
        Actions (worlds, numbers) in [-1, 1], and where there are such: who drives at way points
        does not back up, unless it can go any way.
    """
    asked = actions_between(robot, q, target, dt)
    rates = np.array([a.rate for a in robot.actions]) * dt
    reach = limits(robot.actions)[1] * seconds
    drive = robot.drive
    platform = drive.platform if isinstance(drive, MobileManipulator) else drive
    n = len(robot.moving_joints) if isinstance(drive, (JointVelocity, MobileManipulator)) else 0
    split = asked.shape[1] - n
    parts, led = [], np.ones(len(asked), dtype=bool)
    if split:
        assert platform is not None
        part, led = base_way_point(platform, asked[:, :split], rates, reach, dt)
        parts.append(part)
    if n:
        parts.append(ahead(asked[:, split:], rates[split:], dt) / reach[split:])
    return np.clip(np.concatenate(parts, axis=1), -1.0, 1.0), led


def ahead(speed: Floats, rate: Floats, dt: float) -> Floats:
    """How far to look for a speed, either way, that may change by `rate` in a step of dt."""
    v = np.abs(speed)
    steps = np.where(np.isfinite(rate), v / np.where(rate > 0, rate, 1.0), 0.0)
    return np.asarray(np.sign(speed) * np.maximum(v * dt, 0.5 * dt * v * (steps + 1.0)))


def base_way_point(
    drive: Drive, asked: Floats, rates: Floats, reach: Floats, dt: float
) -> tuple[Floats, Flags]:
    """x, y (z) and yaw of a base that is to go at velocities (worlds, size), and for whom."""
    v, led = asked[:, 0], np.ones(len(asked), dtype=bool)
    if isinstance(drive, (DifferentialDrive, Car)):
        far = ahead(v, rates[0], dt)
        if isinstance(drive, Car):
            course, yaw = pursued(far, asked[:, 1], drive.wheelbase), np.zeros(len(v))
        else:
            course = np.where(v > STILL, ahead(asked[:, 1], rates[1], dt), 0.0)
            yaw, far = ahead(asked[:, 1], rates[1], dt), far / np.cos(course)
        led = v > -STILL
        place = far[:, None] * np.stack([np.cos(course), np.sin(course)], axis=1) / reach[0]
    else:
        n = asked.shape[1] - 1
        speed = np.linalg.norm(asked[:, :n], axis=1, keepdims=True)
        way = asked[:, :n] / np.maximum(speed, STILL)
        place = way * ahead(speed, rates[:1], dt) / reach[[0, 0, 2][:n]]
        yaw = ahead(asked[:, n], rates[n], dt)
    place = place / np.maximum(1.0, np.abs(place).max(axis=1, keepdims=True))
    return np.column_stack([place, yaw / math.pi]), led


def pursued(far: Floats, steering: Floats, wheelbase: float) -> Floats:
    """Where to put a point `far` away, radians, for a car that pursues it to steer by so much.

    It pursues what is half as far before the point: tan(steering) is 2 L sin / far (1.25 - cos).
    """
    m = far * np.tan(steering) / (2 * wheelbase)
    return np.asarray(np.arcsin(np.clip(1.25 * m / np.sqrt(1 + m * m), -1, 1)) - np.arctan(m))

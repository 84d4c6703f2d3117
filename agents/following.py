"""A base on a plane follows velocities, as its drive can."""

from __future__ import annotations

import math

import numpy as np

from fgenv import _core
from fgenv.envs.simulator import Floats
from fgenv.robots import Car, Drive, Holonomic, MobileManipulator, Robot
from fgenv.robots.limits import reaches

OFF_COURSE = 1.2  # rad: farther off, a differential drive turns on the spot
CREEP = 0.3  # of its speed, what a car goes at least


def base_of(robot: Robot) -> Drive | None:
    """The drive of its base."""
    return robot.drive.platform if isinstance(robot.drive, MobileManipulator) else robot.drive


def enclosing(robot: Robot) -> float:
    """Radius of the disc about a planar base's origin that encloses the robot, metres."""
    root, *others = robot.links
    if any(link.shapes for link in others):
        return float(reaches(robot)[robot.root])
    found = [0.0]
    for part in root.shapes:
        points = part.shape.vertices @ part.origin[:2, :3].T + part.origin[:2, 3]
        found.append(float((points[:, 0] ** 2 + points[:, 1] ** 2).max()))
    return math.sqrt(max(found))


def followed(robot: Robot, yaw: Floats, v: Floats, dt: float) -> Floats:
    """A base's actions in [-1, 1] that follow velocities (n, 2) of the world, (n, size)."""
    sine, cosine = _core.sin_cos(yaw)
    ahead, left = cosine * v[:, 0] + sine * v[:, 1], cosine * v[:, 1] - sine * v[:, 0]
    drive, speed = base_of(robot), np.sqrt(ahead**2 + left**2)
    course = np.array([_core.arc_tangent(y, x) for x, y in zip(ahead, left, strict=True)])
    if isinstance(drive, Holonomic):
        asked = [ahead, left, np.zeros_like(yaw)]
    elif isinstance(drive, Car):  # it has to move to turn
        asked = [np.maximum(ahead, CREEP * speed), course]
    else:
        asked = [np.where(np.abs(course) < OFF_COURSE, ahead, 0.0), course / dt]
    limits = robot.actions[: len(asked)]
    halves = [((a.high + a.low) / 2, (a.high - a.low) / 2) for a in limits]
    return np.stack(
        [np.clip((x - m) / h, -1.0, 1.0) for x, (m, h) in zip(asked, halves, strict=True)], axis=1
    )

"""A base on a plane follows velocities, as its drive can."""

from __future__ import annotations

import math

import numpy as np

from fgenv import _core
from fgenv.arrays import Floats, Floats32
from fgenv.envs import View
from fgenv.robots import Car, Drive, Holonomic, MobileManipulator, Robot

OFF_COURSE = 1.2  # rad: farther off, a differential drive turns on the spot
CREEP = 0.3  # of its speed, what a car goes at least


def base_of(robot: Robot) -> Drive | None:
    """The drive of its base."""
    return robot.drive.platform if isinstance(robot.drive, MobileManipulator) else robot.drive


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


def targets(view: View, observations: Floats32) -> Floats:
    """Where robots go next, (worlds, robots, nq): planar ones to their path hints, others to goals.

    Planar ones look where they go, until it is time to turn as the goal wants: what they see and
    ask for is then in a frame with their way ahead.
    """
    q, found, left = view.configurations, view.goals, view.remaining
    for i, (robot, parts) in enumerate(zip(view.robots, view.layouts, strict=True)):
        if robot.base != "planar":
            continue
        hint = next((part.slice for part in parts if part.name == "path_hint"), None)
        if hint is not None:
            base = robot.forward(q[:, i, : robot.nq], 0)
            x, y = np.moveaxis(observations[:, i, hint].astype(np.float64), -1, 0)
            for k in range(2):
                found[:, i, k] = base[:, k, 0] * x + base[:, k, 1] * y + base[:, k, 3]
        way = found[:, i, :2] - q[:, i, :2]
        stays = (way == 0.0).all(axis=1)
        yaw = np.where(stays, q[:, i, 2], [_core.arc_tangent(y, x) for x, y in way.tolist()])
        turn = np.abs(np.remainder(found[:, i, 2] - q[:, i, 2] + math.pi, 2 * math.pi) - math.pi)
        rate = next(
            (action.high for action in robot.actions if action.name == "yaw_rate"), math.inf
        )
        late = turn / rate * robot.actions[0].high >= left[:, i]
        found[:, i, 2] = np.where(late, found[:, i, 2], yaw)
    return found

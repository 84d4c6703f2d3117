"""Actions that take a robot from one configuration to the next in a step: drives, inverted."""

from __future__ import annotations

import math

import numpy as np

from fgenv.arrays import Floats

from .drives import Car, DifferentialDrive, Drive, Drone, Holonomic, MobileManipulator
from .robot import Robot

SLOW = 1e-9  # m: a car that moves less does not steer


def changes(robot: Robot, q0: Floats, q1: Floats) -> Floats:
    """What each degree of freedom changes by from q0 to q1 (..., nq), the shorter way: (..., dof).

    Of a free base position, then the rotation vector in its own frame at q0 (rad).
    """
    change: Floats = q1 - q0
    ends = robot.endless
    change[..., ends] = np.remainder(change[..., ends] + math.pi, 2 * math.pi) - math.pi
    if robot.base != "free":
        return change
    u, v = q0[..., 3:6], q1[..., 3:6]
    a, b = q0[..., 6:7], q1[..., 6:7]
    axis = a * v - b * u - np.cross(u, v)
    cosine = a * b + np.sum(u * v, axis=-1, keepdims=True)
    sine = np.linalg.norm(axis, axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, np.abs(cosine)) * np.where(cosine >= 0, 1.0, -1.0)
    turn = axis * np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 1e-12)
    return np.concatenate([change[..., :3], turn, change[..., 7:]], axis=-1)


def actions_between(robot: Robot, q0: Floats, q1: Floats, dt: float) -> Floats:
    """Actions, in their own units, that lead from q0 to q1 (..., nq) in dt seconds, (..., size).

    What a drive cannot do is left out, see `left_over`. They are not brought to the limits.

    Raises:
        ValueError: the robot has no drive.
    """
    return _driven(robot, q0, q1, dt)[0]


def left_over(robot: Robot, q0: Floats, q1: Floats, dt: float) -> Floats:
    """What the drive cannot do on the way from q0 to q1 (..., nq): (...), m/s or rad/s.

    A differential drive or a car does not go sideways, a car does not turn on the spot, a drone
    does not tilt.
    """
    return _driven(robot, q0, q1, dt)[1]


def _driven(robot: Robot, q0: Floats, q1: Floats, dt: float) -> tuple[Floats, Floats]:
    drive = robot.drive
    if drive is None:
        raise ValueError(f"robot: {robot.name!r} has no drive, give its model one")
    change = changes(robot, np.asarray(q0, dtype=np.float64), np.asarray(q1, dtype=np.float64))
    n = len(robot.moving_joints)
    joints = change[..., change.shape[-1] - n :] / dt
    base = drive.platform if isinstance(drive, MobileManipulator) else drive
    still = np.abs(change[..., : change.shape[-1] - n]).sum(axis=-1) / dt
    parts, left = ([], still) if base.base is None else _base(base, q0, change, dt)
    if len(robot.actions) > _size(base):
        parts = [*parts, *np.moveaxis(joints, -1, 0)]
    elif n:
        left = left + np.abs(joints).sum(axis=-1)
    return np.stack(parts, axis=-1), left


def _size(drive: Drive) -> int:
    """How many of the actions are the base's."""
    sizes = {Holonomic: 3, DifferentialDrive: 2, Car: 2, Drone: 4}
    return next((size for kind, size in sizes.items() if isinstance(drive, kind)), 0)


def _base(drive: Drive, q: Floats, change: Floats, dt: float) -> tuple[list[Floats], Floats]:
    """A base's actions, and what it cannot do."""
    if isinstance(drive, Drone):
        turn = change[..., 5]
        ahead = _in_frame(q, change[..., :3])
        vx, vy = _off_arc(ahead[..., 0], ahead[..., 1], turn, dt)
        tilt = np.linalg.norm(change[..., 3:5], axis=-1) / dt
        return [vx, vy, ahead[..., 2] / dt, turn / dt], tilt
    turn, yaw = change[..., 2], q[..., 2]
    c, s = np.cos(yaw), np.sin(yaw)
    x, y = c * change[..., 0] + s * change[..., 1], c * change[..., 1] - s * change[..., 0]
    vx, vy = _off_arc(x, y, turn, dt)
    if isinstance(drive, Holonomic):
        return [vx, vy, turn / dt], np.zeros_like(vx)
    if isinstance(drive, DifferentialDrive):
        return [vx, turn / dt], np.abs(vy)
    assert isinstance(drive, Car)
    goes = np.abs(vx * dt) > SLOW
    way = np.where(goes, vx * dt, np.inf)
    steering = np.arctan(turn * drive.wheelbase / way)
    return [vx, steering], np.abs(vy) + np.where(goes, 0.0, np.abs(turn) / dt)


def _off_arc(x: Floats, y: Floats, turn: Floats, dt: float) -> tuple[Floats, Floats]:
    """Velocity in the body's frame that draws the arc whose chord is (x, y)."""
    half = 0.5 * turn
    chord = np.where(np.abs(half) > 1e-9, np.sin(half) / np.where(half == 0, 1.0, half), 1.0)
    c, s = np.cos(half), np.sin(half)
    return (c * x + s * y) / (chord * dt), (c * y - s * x) / (chord * dt)


def _in_frame(q: Floats, by: Floats) -> Floats:
    """A vector as the frame of a free base sees it."""
    u, w = -q[..., 3:6], q[..., 6:7]
    t = 2 * np.cross(u, by)
    turned: Floats = by + w * t + np.cross(u, t)
    return turned

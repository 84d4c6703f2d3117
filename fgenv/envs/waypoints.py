"""Way points that lead to a configuration: what an action is with `actions="way_points"`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fgenv import _core
from fgenv.robots import Drone, JointVelocity, MobileManipulator, Robot

if TYPE_CHECKING:
    from fgenv.arrays import Floats

    from .simulator import Simulator


def way_points_toward(simulator: Simulator, targets: ArrayLike) -> Floats:
    """Way points straight to targets (worlds, robots, nq), where farther than they reach, that far.

    Raises:
        ValueError: wrong shape, or a number that is not finite.
    """
    expected, q = np.asarray(targets, dtype=np.float64), simulator.configurations
    if expected.shape != q.shape:
        raise ValueError(f"targets: shape {expected.shape}, expected {q.shape}")
    if not np.isfinite(expected).all():
        raise ValueError("targets: expected finite numbers")
    actions = np.zeros((simulator.n_worlds, simulator.n_robots, simulator.action_size))
    for i, robot in enumerate(simulator.robots):
        ends = q[:, i, : robot.nq], expected[:, i, : robot.nq]
        own = way_point(robot, *ends, simulator.way_point_seconds)
        actions[:, i, : own.shape[1]] = own
    return actions


def way_point(robot: Robot, q: Floats, target: Floats, seconds: float) -> Floats:
    """The action (worlds, numbers) of one robot, from configurations (worlds, nq)."""
    drive, found = robot.drive, []
    joints = isinstance(drive, (JointVelocity, MobileManipulator))
    platform = drive.platform if isinstance(drive, MobileManipulator) else drive
    limits = np.array([action.high for action in robot.actions]) * seconds
    if not isinstance(platform, JointVelocity):
        found.append(base_way_point(robot, q, target, limits, isinstance(platform, Drone)))
    if joints:
        n = len(robot.moving_joints)
        by = target[:, -n:] - q[:, -n:]
        around = np.round(by / (2 * np.pi)) * (2 * np.pi)
        by = np.where(robot.endless[-n:], by - around, by)
        found.append(np.clip(by / limits[-n:], -1.0, 1.0))
    return np.concatenate(found, axis=1)


def base_way_point(robot: Robot, q: Floats, target: Floats, limits: Floats, flies: bool) -> Floats:
    """x, y (z) by how far full speed gets, shortened as a whole; yaw by half a turn."""
    here, there = robot.forward(q, 0), robot.forward(target, 0)
    offset = np.einsum("wji,wj->wi", here[:, :3, :3], there[:, :3, 3] - here[:, :3, 3])
    reach = limits[[0, 0, 2]] if flies else limits[[0, 0]]
    part = offset[:, : len(reach)] / reach
    part /= np.maximum(1.0, np.abs(part).max(axis=1, keepdims=True))
    turned = np.einsum("wji,wjk->wik", here[:, :3, :3], there[:, :3, :3])
    yaw = [_core.arc_tangent(float(t[1, 0]), float(t[0, 0])) / np.pi for t in turned]
    return np.column_stack([part, yaw])

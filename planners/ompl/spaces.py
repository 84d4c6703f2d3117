"""OMPL state spaces of robots: by the kinds of their joints, with bounds and weights."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from ompl import base as ob

from fgenv.arrays import Floats
from fgenv.robots import Robot, Steering

Subspace = tuple[str, int]  # its kind, such as "SE2", and its dimension
Weighted = tuple[Any, float]  # a space, and its weight in a compound space

MIN_WEIGHT = 1e-3  # m/rad


@dataclass(frozen=True)
class StateLayout:
    """Conversion between a robot's configurations and its states.

    The state of a robot with a free base that stays level (`Drone`) has x, y, z, yaw in place of
    x, y, z and a quaternion. The states of other robots are their configurations.
    """

    robot: Robot
    steering: Steering

    @property
    def level(self) -> bool:
        """Whether the robot stays level."""
        return self.robot.drive is not None and self.robot.drive.base_drive.level

    @property
    def size(self) -> int:
        """Numbers in a state."""
        return self.robot.nq - (3 if self.level else 0)

    def states(self, q: ArrayLike) -> Floats:
        """States (..., size) of configurations (..., nq), with angles in [-pi, pi).

        Quaternions are normalized, since OMPL rejects norms that differ from 1 by over 1e-9.
        """
        q = np.array(q, dtype=np.float64)
        q[..., self.robot.endless] = _wrapped(q[..., self.robot.endless])
        if self.robot.base == "free":
            q[..., 3:7] /= np.linalg.norm(q[..., 3:7], axis=-1, keepdims=True)
        if not self.level:
            return q
        yaw = 2.0 * np.arctan2(q[..., 5:6], q[..., 6:7])
        return np.concatenate([q[..., :3], _wrapped(yaw), q[..., 7:]], axis=-1)

    def configurations(self, states: Floats) -> Floats:
        """Configurations (..., nq) of states (..., size)."""
        if not self.level:
            return states
        half, flat = 0.5 * states[..., 3:4], np.zeros_like(states[..., :2])
        parts = [states[..., :3], flat, np.sin(half), np.cos(half), states[..., 4:]]
        return np.concatenate(parts, axis=-1)


def configurations_of(layouts: Sequence[StateLayout], states: Floats) -> list[Floats]:
    """Configurations (..., nq) of each robot in joint states (..., size)."""
    ends = np.cumsum([layout.size for layout in layouts])[:-1]
    parts = zip(layouts, np.split(states, ends, axis=-1), strict=True)
    return [layout.configurations(part) for layout, part in parts]


def state_space(layout: StateLayout, bounds: Floats | None = None) -> Any:
    """Return the OMPL state space of one robot.

    A planar base is SE2 (Dubins or Reeds-Shepp for a car) and a free base SE3 (R3 and SO2 for a
    level robot). Bounded joints form real vector spaces, unbounded joints are SO2. Several parts
    form a compound space, in the order of the configuration. The weight of an angle is the distance
    that the farthest point moves per radian.

    Args:
        bounds: (2, 2) or (2, 3), lowest and highest position of the base (meters); the robot's
            workspace by default.
    """
    parts = [*_base(layout, bounds), *_joints(layout.robot)]
    if len(parts) == 1:
        return parts[0][0]
    return _compound(parts)


def joint_space(spaces: Sequence[Any]) -> Any:
    """Return the joint space of several robots; one real vector space if all of theirs are."""
    if len(spaces) == 1:
        return spaces[0]
    if all(isinstance(space, ob.RealVectorStateSpace) for space in spaces):
        low, high = (
            [x for space in spaces for x in getattr(space.getBounds(), side)]
            for side in ("low", "high")
        )
        return _real(np.array([low, high]))
    return _compound([(space, 1.0) for space in spaces])


def subspaces(space: Any) -> list[Subspace]:
    """Kinds and dimensions of a space's parts, in the order of its states."""
    if isinstance(space, (ob.SE2StateSpace, ob.SE3StateSpace)) or not space.isCompound():
        return [(type(space).__name__.removesuffix("StateSpace"), space.getDimension())]
    return [sub for part in space.getSubspaces() for sub in subspaces(part)]


def _base(layout: StateLayout, bounds: Floats | None) -> list[Weighted]:
    robot = layout.robot
    if robot.base == "fixed":
        return []
    box = robot.workspace if bounds is None else bounds
    if box is None:
        raise ValueError(
            f"bounds: got None, expected (2, 3) for {robot.name!r}, a robot without workspace"
        )
    d = 2 if robot.base == "planar" else 3
    limits, weight = _bounds(np.asarray(box)[:, :d]), max(float(robot.weights[d]), MIN_WEIGHT)
    if layout.level:
        real = ob.RealVectorStateSpace(3)
        real.setBounds(limits)
        return [(real, 1.0), (ob.SO2StateSpace(), weight)]
    space = _pose_space(layout)
    space.setBounds(limits)
    if not layout.steering.car_like:
        space.setSubspaceWeight(1, weight)
    return [(space, 1.0)]


def _pose_space(layout: StateLayout) -> Any:
    method, radius = layout.steering.method, layout.steering.radius
    if layout.robot.base == "free":
        return ob.SE3StateSpace()
    if method == "dubins":
        return ob.DubinsStateSpace(radius)
    return ob.ReedsSheppStateSpace(radius) if method == "reeds_shepp" else ob.SE2StateSpace()


def _joints(robot: Robot) -> list[Weighted]:
    """A circle for each unbounded joint, and real vectors for runs of bounded joints."""
    first = robot.nq - len(robot.moving_joints)
    parts: list[Weighted] = []
    for endless, run in groupby(range(first, robot.nq), key=lambda k: bool(robot.endless[k])):
        joints = list(run)
        if endless:
            parts += [
                (ob.SO2StateSpace(), max(float(robot.weights[k]), MIN_WEIGHT)) for k in joints
            ]
            continue
        weight = 1.0 if first == 0 else float(robot.weights[joints].mean())
        parts.append((_real(_limits(robot, joints)), max(weight, MIN_WEIGHT)))
    return parts


def _limits(robot: Robot, joints: list[int]) -> Floats:
    """Lower and upper limits (2, n) of joints; ValueError if one has none."""
    limits = np.array([robot.lower[joints], robot.upper[joints]])
    unlimited = np.flatnonzero(~np.isfinite(limits).all(axis=0))
    if len(unlimited):
        name = robot.coordinates[joints[unlimited[0]]]
        raise ValueError(f"bounds: joint {name!r} of {robot.name!r} has no limits; set them")
    return limits


def _compound(parts: Sequence[Weighted]) -> Any:
    space = ob.CompoundStateSpace()
    for part, weight in parts:
        space.addSubspace(part, weight)
    space.lock()
    return space


def _real(box: Floats) -> Any:
    space = ob.RealVectorStateSpace(box.shape[1])
    space.setBounds(_bounds(box))
    return space


def _bounds(box: Floats) -> Any:
    limits = ob.RealVectorBounds(box.shape[1])
    for axis, (low, high) in enumerate(box.T.tolist()):
        limits.setLow(axis, low)
        limits.setHigh(axis, high)
    return limits


def _wrapped(angle: Floats) -> Floats:
    wrapped: Floats = np.remainder(angle + math.pi, 2 * math.pi) - math.pi
    return wrapped

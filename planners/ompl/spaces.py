"""State spaces of OMPL for robots: by the kinds of their joints, with bounds and weights."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from ompl import base as ob

from fgenv.arrays import Floats
from fgenv.planners.steering import Steering, platform
from fgenv.robots import Drone, Robot

Leaf = tuple[str, int]  # kind of a subspace, and its dimension


@dataclass(frozen=True)
class Layout:
    """How a robot's configuration stands in a state.

    A robot with a free base that stays level (`Drone`) has x, y, z, yaw in place of x, y, z and a
    quaternion; all others have their configuration as it is.
    """

    robot: Robot
    steering: Steering

    @property
    def level(self) -> bool:
        """Whether it stays level."""
        return self.robot.base == "free" and isinstance(platform(self.robot.drive), Drone)

    @property
    def size(self) -> int:
        """Numbers in a state."""
        return self.robot.nq - (3 if self.level else 0)

    @staticmethod
    def room_of(layout: Layout | None) -> list[float]:
        """Least x, y and greatest x, y of the base: arcs of a car swing out of where they end."""
        box = None if layout is None else layout.robot.workspace
        if box is None:
            return [-math.inf, -math.inf, math.inf, math.inf]
        return [float(x) for x in np.asarray(box)[:, :2].ravel()]

    def states(self, q: ArrayLike) -> Floats:
        """States (..., size) of configurations (..., nq); angles come to [-pi, pi).

        Quaternions come to length 1: OMPL takes no state in which it is off by more than 1e-9.
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


def space_of(layout: Layout, bounds: Floats | None = None) -> Any:
    """The space of one robot's states.

    Planar bases are SE2 (a car's Dubins or Reeds-Shepp), free ones SE3 (a level one R3 and SO2),
    bounded joints are real vectors and those without end SO2; several of these are a compound
    space, in the order of the configuration. An angle weighs as many meters as it moves the
    farthest point.

    Args:
        bounds: (2, 2) or (2, 3), least and greatest position of the base (meters); the robot's
            workspace if left out.
    """
    parts = [*_base(layout, bounds), *_joints(layout.robot)]
    if len(parts) == 1:
        return parts[0][0]
    return _compound(parts)


def compound_of(spaces: Sequence[Any]) -> Any:
    """The joint space of several robots; one real vector where all of theirs are."""
    if len(spaces) == 1:
        return spaces[0]
    if all(isinstance(space, ob.RealVectorStateSpace) for space in spaces):
        low, high = (
            [x for space in spaces for x in getattr(space.getBounds(), side)]
            for side in ("low", "high")
        )
        return _real(np.array([low, high]))
    return _compound([(space, 1.0) for space in spaces])


def leaves(space: Any) -> list[Leaf]:
    """What a space is made of, in the order of its states."""
    if isinstance(space, (ob.SE2StateSpace, ob.SE3StateSpace)) or not space.isCompound():
        return [(type(space).__name__.removesuffix("StateSpace"), space.getDimension())]
    return [leaf for part in space.getSubspaces() for leaf in leaves(part)]


def _base(layout: Layout, bounds: Floats | None) -> list[tuple[Any, float]]:
    robot = layout.robot
    if robot.base == "fixed":
        return []
    box = robot.workspace if bounds is None else bounds
    if box is None:
        raise ValueError(
            f"bounds: {robot.name!r} has no workspace, expected workspace= of the robot, or bounds="
        )
    place, turn = (2, 2) if robot.base == "planar" else (3, 3)
    limits, weight = _bounds(np.asarray(box)[:, :place]), max(float(robot.weights[turn]), 1e-3)
    if layout.level:
        real = ob.RealVectorStateSpace(3)
        real.setBounds(limits)
        return [(real, 1.0), (ob.SO2StateSpace(), weight)]
    space = _turning(layout)
    space.setBounds(limits)
    if layout.steering.way in ("straight", "turn_drive_turn"):
        space.setSubspaceWeight(1, weight)
    return [(space, 1.0)]


def _turning(layout: Layout) -> Any:
    way, radius = layout.steering.way, layout.steering.radius
    if layout.robot.base == "free":
        return ob.SE3StateSpace()
    if way == "dubins":
        return ob.DubinsStateSpace(radius)
    return ob.ReedsSheppStateSpace(radius) if way == "reeds_shepp" else ob.SE2StateSpace()


def _joints(robot: Robot) -> list[tuple[Any, float]]:
    """Real vectors for joints with limits, as long as they can be, and circles."""
    first = robot.nq - len(robot.moving_joints)
    parts: list[tuple[Any, float]] = []
    k = first
    while k < robot.nq:
        if robot.endless[k]:
            parts.append((ob.SO2StateSpace(), max(float(robot.weights[k]), 1e-3)))
            k += 1
            continue
        end = k
        while end < robot.nq and not robot.endless[end]:
            if not np.isfinite([robot.lower[end], robot.upper[end]]).all():
                name = robot.coordinates[end]
                raise ValueError(
                    f"bounds: joint {name!r} of {robot.name!r} has no limits, give it some"
                )
            end += 1
        weight = 1.0 if first == 0 else float(robot.weights[k:end].mean())
        parts.append((_real(np.array([robot.lower[k:end], robot.upper[k:end]])), max(weight, 1e-3)))
        k = end
    return parts


def _compound(parts: Sequence[tuple[Any, float]]) -> Any:
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

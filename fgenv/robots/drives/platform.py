"""Platform: base class of drives that move a base."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import ClassVar

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats

from ..configuration_space import ConfigurationSpace
from .arcs import arc_velocity, lookahead
from .base import DrivePart, LegLimit, normalized

STANDSTILL = 1e-9  # m/s: lower speeds count as rest


class Platform(DrivePart):
    """A drive that moves a base.

    Defaults are for a platform that moves sideways: its action is a velocity along each axis of the
    body, then the yaw rate.
    """

    base: ClassVar[str]

    def check_part(self, robot: ConfigurationSpace) -> None:
        """Raise ValueError if the robot has another kind of base."""
        if robot.base != self.base:
            raise ValueError(
                f"drive: got a {robot.base} base of {robot.name!r}, expected base={self.base!r} for"
                f" a {type(self).__name__}; give another base or drive"
            )

    def max_speed(self, robot: ConfigurationSpace) -> float:
        """Upper bound of the speed of the base's origin, m/s."""
        speeds = [max(-a.low, a.high) for a in self.part_actions(robot) if a.unit == "m/s"]
        return float(np.linalg.norm(speeds))

    def part_inverse(
        self, robot: ConfigurationSpace, q: Floats, change: Floats, dt: float
    ) -> tuple[Floats, Floats]:
        """Actions of the arc to the end of the motion."""
        turn, yaw = change[..., 2], q[..., 2]
        c, s = np.cos(yaw), np.sin(yaw)
        x, y = c * change[..., 0] + s * change[..., 1], c * change[..., 1] - s * change[..., 0]
        actions, residual = self.from_velocity(*arc_velocity(x, y, turn, dt), turn, dt)
        return np.stack(actions, axis=-1), residual

    def from_velocity(
        self, vx: Floats, vy: Floats, turn: Floats, dt: float
    ) -> tuple[list[Floats], Floats]:
        """Actions for a velocity in the frame of a planar base, and the speed left over.

        Args:
            vx, vy: (...), m/s, constant in the base's frame.
            turn: (...), radians in dt seconds.
            dt: seconds.
        """
        return [vx, vy, turn / dt], np.zeros_like(vx)

    def part_leg_limits(
        self, robot: ConfigurationSpace, q: Floats, change: Floats, dt: float
    ) -> list[LegLimit]:
        """Limits of the base's motion on a leg."""
        return self.base_leg_limits(float(q[2]), change, dt)

    @abstractmethod
    def base_leg_limits(self, yaw: float, change: Floats, dt: float) -> list[LegLimit]:
        """Limits on a leg that begins at a heading and changes the base's coordinates (dof,)."""

    def part_waypoint(
        self, robot: ConfigurationSpace, q: Floats, target: Floats, seconds: float
    ) -> Floats:
        """Position as a fraction of the reach at full speed, yaw as a fraction of half a turn."""
        here, there = robot.forward(q, 0), robot.forward(target, 0)
        offset = np.einsum("wji,wj->wi", here[:, :3, :3], there[:, :3, 3] - here[:, :3, 3])
        reach = self._reach(robot, seconds)
        part = offset[:, : len(reach)] / reach
        part /= np.maximum(1.0, np.abs(part).max(axis=1, keepdims=True))
        turned = np.einsum("wji,wjk->wik", here[:, :3, :3], there[:, :3, :3])
        yaw = [_core.arc_tangent(float(t[1, 0]), float(t[0, 0])) / np.pi for t in turned]
        return np.column_stack([part, yaw])

    def _reach(self, robot: ConfigurationSpace, seconds: float) -> Floats:
        """Distance along each axis at full speed, meters; that of x for y too."""
        high = np.array([action.high for action in self.part_actions(robot)]) * seconds
        return high[[0, 0, 2]] if self.base == "free" else high[[0, 0]]

    def part_tracking_waypoint(
        self, robot: ConfigurationSpace, actions: Floats, dt: float, seconds: float
    ) -> tuple[Floats, Flags]:
        """Waypoint of the base, shortened as a whole to the reach."""
        rates = np.array([a.rate for a in self.part_actions(robot)]) * dt
        place, yaw, tracked = self.lookahead_point(actions, rates, dt)
        place = place / self._reach(robot, seconds)
        place = place / np.maximum(1.0, np.abs(place).max(axis=1, keepdims=True))
        return np.column_stack([place, yaw / math.pi]), tracked

    def lookahead_point(
        self, actions: Floats, rates: Floats, dt: float
    ) -> tuple[Floats, Floats, Flags]:
        """Position (n, 2 or 3) and yaw (n,) to drive to in the body's frame for actions (n, size).

        Args:
            actions: in their own units.
            rates: limits of their change per step, (size,).
            dt: seconds.

        Returns:
            Position (m), yaw (rad), and whether the point leads to the actions (n,).
        """
        n = actions.shape[1] - 1
        speed = np.linalg.norm(actions[:, :n], axis=1, keepdims=True)
        direction = actions[:, :n] / np.maximum(speed, STANDSTILL)
        place: Floats = direction * lookahead(speed, rates[:1], dt)
        return place, lookahead(actions[:, n], rates[n], dt), np.ones(len(actions), dtype=bool)

    def track_velocity(
        self, robot: ConfigurationSpace, yaw: Floats, velocity: Floats, dt: float
    ) -> Floats:
        """Actions of the base, in [-1, 1], that track velocities of the world."""
        sine, cosine = _core.sin_cos(yaw)
        vx, vy = velocity[:, 0], velocity[:, 1]
        ahead, left = cosine * vx + sine * vy, cosine * vy - sine * vx
        course = np.array([_core.arc_tangent(y, x) for x, y in zip(ahead, left, strict=True)])
        actions = np.stack(self.follow_course(ahead, left, course, dt), axis=1)
        return normalized(self.part_actions(robot), actions)

    def follow_course(self, ahead: Floats, left: Floats, course: Floats, dt: float) -> list[Floats]:
        """Actions that track a velocity in the base's frame.

        Args:
            ahead, left: (n,), m/s.
            course: direction of the velocity, (n,), rad from the base's x axis.
            dt: seconds.
        """
        return [ahead, left, np.zeros_like(ahead)]

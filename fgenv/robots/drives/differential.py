"""Differential drive: two driven wheels on one axle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from fgenv.arrays import Flags, Floats

from ..configuration_space import ConfigurationSpace
from .arcs import lookahead
from .base import INF, Action, LegLimit, Quantity
from .platform import STANDSTILL, Platform

MAX_COURSE = 1.2  # rad: farther off the course, the robot turns in place


@dataclass(frozen=True)
class DifferentialDrive(Platform):
    """Two driven wheels on one axle through the origin; turns in place; planar base."""

    kind = "differential"
    base = "planar"
    native_kind = "differential"
    steering_methods = ("turn_drive_turn", "straight")

    speed: Annotated[float, Quantity("m/s", "Forward speed")]
    turn_rate: Annotated[float, Quantity("rad/s", "Yaw rate")]
    acceleration: Annotated[float, Quantity("m/s^2", "Change of speed")] = INF
    turn_acceleration: Annotated[float, Quantity("rad/s^2", "Change of yaw rate")] = INF
    reverse: Annotated[float | None, Quantity("m/s", "Backward speed; default: speed")] = None

    def part_actions(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Velocity along the body's x, and yaw rate."""
        back = self.speed if self.reverse is None else self.reverse
        return (
            Action("v", "m/s", -back, self.speed, self.acceleration),
            Action.symmetric("yaw_rate", "rad/s", self.turn_rate, self.turn_acceleration),
        )

    def from_velocity(
        self, vx: Floats, vy: Floats, turn: Floats, dt: float
    ) -> tuple[list[Floats], Floats]:
        """Speed and yaw rate; motion sideways is left over."""
        return [vx, turn / dt], np.abs(vy)

    def base_leg_limits(self, yaw: float, change: Floats, dt: float) -> list[LegLimit]:
        """Limits of a straight drive or a turn in place."""
        ahead = change[0] * math.cos(yaw) + change[1] * math.sin(yaw)
        back = self.speed if self.reverse is None else self.reverse
        speed = self.speed if ahead >= 0 else back
        return [
            LegLimit(float(np.hypot(change[0], change[1])), speed, self.acceleration),
            LegLimit(abs(float(change[2])), self.turn_rate, self.turn_acceleration),
        ]

    def lookahead_point(
        self, actions: Floats, rates: Floats, dt: float
    ) -> tuple[Floats, Floats, Flags]:
        """A point ahead, off the axis by the turn of the robot's approach."""
        v = actions[:, 0]
        yaw = lookahead(actions[:, 1], rates[1], dt)
        course = np.where(v > STANDSTILL, yaw, 0.0)
        distance = lookahead(v, rates[0], dt) / np.cos(course)
        place = distance[:, None] * np.stack([np.cos(course), np.sin(course)], axis=1)
        return place, yaw, v > -STANDSTILL

    def follow_course(self, ahead: Floats, left: Floats, course: Floats, dt: float) -> list[Floats]:
        """Turn in place until the course is roughly ahead, then drive while turning."""
        return [np.where(np.abs(course) < MAX_COURSE, ahead, 0.0), course / dt]

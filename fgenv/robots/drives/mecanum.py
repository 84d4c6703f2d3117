"""Mecanum drive: four omnidirectional wheels with limits of the wheels' speeds.

The model is that of P. Muir and C. Neuman, "Kinematic modeling for feedback control of an
omnidirectional wheeled mobile robot", 1987; see K. Lynch and F. Park, "Modern Robotics", section
13.2: with rollers at 45 degrees, a wheel at (+-ly, +-lx) turns at
(vx +- vy +- (lx + ly) yaw_rate) / radius.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from fgenv.arrays import Floats

from ..configuration_space import ConfigurationSpace
from .arcs import chord_ratio
from .base import INF, ZERO, Action, LegLimit, Quantity
from .platform import Platform

# Signs of vx, vy and the yaw rate in the wheels' speeds
WHEELS = {
    "front_left": (1.0, -1.0, -1.0),
    "front_right": (1.0, 1.0, 1.0),
    "rear_left": (1.0, 1.0, -1.0),
    "rear_right": (1.0, -1.0, 1.0),
}


@dataclass(frozen=True)
class Mecanum(Platform):
    """Four mecanum wheels around the origin; moves and turns in any direction; planar base.

    An action that exceeds a limit of a wheel is scaled down as a whole.
    """

    kind = "mecanum"
    base = "planar"
    native_kind = "mecanum"
    moves_sideways = True

    wheel_radius: Annotated[float, Quantity("m", "Radius of the wheels")]
    half_track: Annotated[float, Quantity("m", "Distance of the wheels from the body's x axis, lx")]
    half_wheelbase: Annotated[float, Quantity("m", "Distance of the axles from the y axis, ly")]
    wheel_speed: Annotated[float, Quantity("rad/s", "Speed of each wheel")]
    wheel_acceleration: Annotated[float, Quantity("rad/s^2", "Change of a wheel's speed")] = INF

    @property
    def _arm(self) -> float:
        return self.half_track + self.half_wheelbase

    def part_actions(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Velocity of the origin along the body's x and y, and yaw rate; each at most if alone."""
        speed, rate = (self.wheel_radius * x for x in (self.wheel_speed, self.wheel_acceleration))
        return (
            Action.symmetric("vx", "m/s", speed, rate),
            Action.symmetric("vy", "m/s", speed, rate),
            Action.symmetric("yaw_rate", "rad/s", speed / self._arm, rate / self._arm),
        )

    def part_limits(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Speeds of the wheels."""
        return tuple(
            Action.symmetric(f"wheel_{name}", "rad/s", self.wheel_speed, self.wheel_acceleration)
            for name in WHEELS
        )

    def part_values(self, actions: Floats) -> Floats:
        """Speeds of the wheels for actions (..., 3): (..., 4), rad/s."""
        signs = np.array(list(WHEELS.values()))
        speeds: Floats = actions @ (signs * [1.0, 1.0, self._arm]).T / self.wheel_radius
        return speeds

    def native_parameters(self) -> tuple[float, ...]:
        """Arm of the yaw rate and radius (m), speed and acceleration of the wheels."""
        return self._arm, self.wheel_radius, self.wheel_speed, self.wheel_acceleration

    def base_leg_limits(self, yaw: float, change: Floats, dt: float) -> list[LegLimit]:
        """Limit of the fastest wheel's turn on a leg.

        On a leg with a turn, the direction of motion rotates in the body's frame: the wheel's share
        is that of the worst direction, and half of the acceleration is reserved for the rotation.
        """
        length, turn = float(np.hypot(change[0], change[1])), abs(float(change[2]))
        speed, acceleration = self.wheel_speed, self.wheel_acceleration
        if turn <= ZERO:
            c, s = math.cos(yaw), math.sin(yaw)
            along = abs(c * change[0] + s * change[1]) + abs(c * change[1] - s * change[0])
            return [LegLimit(float(along) / self.wheel_radius, speed, acceleration)]
        max_turn = speed * self.wheel_radius / self._arm * dt
        along = math.sqrt(2) * length / chord_ratio(max_turn)
        wheel = (along + self._arm * turn) / self.wheel_radius
        if length > ZERO and not math.isinf(acceleration):
            acceleration /= 2
            rotation = along * turn / self.wheel_radius
            speed = min(speed, wheel * math.sqrt(acceleration / rotation))
        return [LegLimit(wheel, speed, acceleration)]

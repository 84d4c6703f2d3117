"""Holonomic drive: moves and turns in any direction at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from fgenv.arrays import Floats

from ..configuration_space import ConfigurationSpace
from .arcs import chord_ratio, turning_leg
from .base import INF, ZERO, Action, LegLimit, Quantity
from .platform import Platform


@dataclass(frozen=True)
class Holonomic(Platform):
    """Moves and turns in any direction at once; planar base."""

    kind = "holonomic"
    base = "planar"
    native_kind = "holonomic"
    moves_sideways = True

    speed: Annotated[float, Quantity("m/s", "Speed along each axis of the body")]
    turn_rate: Annotated[float, Quantity("rad/s", "Yaw rate")]
    acceleration: Annotated[float, Quantity("m/s^2", "Change of speed")] = INF
    turn_acceleration: Annotated[float, Quantity("rad/s^2", "Change of yaw rate")] = INF

    def part_actions(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Velocity of the origin along the body's x and y, and yaw rate."""
        return (
            Action.symmetric("vx", "m/s", self.speed, self.acceleration),
            Action.symmetric("vy", "m/s", self.speed, self.acceleration),
            Action.symmetric("yaw_rate", "rad/s", self.turn_rate, self.turn_acceleration),
        )

    def base_leg_limits(self, yaw: float, change: Floats, dt: float) -> list[LegLimit]:
        """Limits of a leg; a turn leaves a margin, as a step's arc is longer than its chord."""
        length, turn = float(np.hypot(change[0], change[1])), abs(float(change[2]))
        ratio = chord_ratio(self.turn_rate * dt) if turn > ZERO else 1.0
        return [
            turning_leg(length, turn, ratio * self.speed, self.acceleration),
            LegLimit(turn, self.turn_rate, self.turn_acceleration),
        ]

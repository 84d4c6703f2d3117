"""Drone: a multicopter under velocity control."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from fgenv.arrays import Floats

from ..configuration_space import ConfigurationSpace
from .arcs import arc_velocity, chord_ratio, in_base_frame, turning_leg
from .base import INF, ZERO, Action, LegLimit, Quantity
from .platform import Platform

TILT = 1e-5  # radians: a larger tilt is not level


@dataclass(frozen=True)
class Drone(Platform):
    """A multicopter under velocity control; stays level; free base."""

    kind = "drone"
    base = "free"
    native_kind = "drone"
    moves_sideways = True
    level = True

    speed: Annotated[float, Quantity("m/s", "Speed along the body's x and y")]
    turn_rate: Annotated[float, Quantity("rad/s", "Yaw rate")]
    acceleration: Annotated[float, Quantity("m/s^2", "Change of speed")] = INF
    turn_acceleration: Annotated[float, Quantity("rad/s^2", "Change of yaw rate")] = INF
    climb: Annotated[float | None, Quantity("m/s", "Speed along z; default: speed")] = None

    def part_actions(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Velocity of the origin along the body's x, y and z, and yaw rate."""
        climb = self.speed if self.climb is None else self.climb
        return (
            Action.symmetric("vx", "m/s", self.speed, self.acceleration),
            Action.symmetric("vy", "m/s", self.speed, self.acceleration),
            Action.symmetric("vz", "m/s", climb, self.acceleration),
            Action.symmetric("yaw_rate", "rad/s", self.turn_rate, self.turn_acceleration),
        )

    def part_inverse(
        self, robot: ConfigurationSpace, q: Floats, change: Floats, dt: float
    ) -> tuple[Floats, Floats]:
        """Actions of the helix to the end of the motion; a tilt is left over."""
        turn = change[..., 5]
        ahead = in_base_frame(q, change[..., :3])
        vx, vy = arc_velocity(ahead[..., 0], ahead[..., 1], turn, dt)
        tilt = np.linalg.norm(change[..., 3:5], axis=-1) / dt
        return np.stack([vx, vy, ahead[..., 2] / dt, turn / dt], axis=-1), np.asarray(tilt)

    def base_leg_limits(self, yaw: float, change: Floats, dt: float) -> list[LegLimit]:
        """Limits of a leg; a turn leaves a margin, as a step's arc is longer than its chord."""
        if (np.abs(change[3:5]) > TILT).any():
            raise ValueError("drone: got a tilted start or goal, expected level ones")
        length, turn = float(np.hypot(change[0], change[1])), abs(float(change[5]))
        ratio = chord_ratio(self.turn_rate * dt) if turn > ZERO else 1.0
        climb = self.speed if self.climb is None else self.climb
        return [
            turning_leg(length, turn, ratio * self.speed, self.acceleration),
            LegLimit(abs(float(change[2])), climb, self.acceleration),
            LegLimit(turn, self.turn_rate, self.turn_acceleration),
        ]

"""Car: Ackermann steering, with a bounded turning radius."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats

from ..configuration_space import ConfigurationSpace
from .arcs import lookahead
from .base import INF, Action, LegLimit, Quantity
from .platform import STANDSTILL, Platform

MIN_DISTANCE = 1e-9  # m: for shorter motions the steering angle is 0
RADIUS_MARGIN = 1.002  # of the planned turning radius: chords are shorter than their arcs
CORNER_LOSS = 2e-3  # of the speed: deviation of steps that cross corners between chords
SPEED_TOLERANCE = 0.01  # of the speed: chords of one arc differ by less
MIN_SPEED = 0.3  # of the speed to track: a car has to move to turn


@dataclass(frozen=True)
class Car(Platform):
    """Ackermann steering, the origin in the middle of the rear axle; planar base.

    The yaw rate is v tan(steering) / wheelbase.
    """

    kind = "car"
    base = "planar"
    native_kind = "car"
    steering_methods = ("reeds_shepp", "dubins", "straight")
    tracking_error = 0.02  # a plan has chords in place of arcs
    recovery_error = 0.1  # a car cannot move sideways to its plan

    wheelbase: Annotated[float, Quantity("m", "Distance between the axles")]
    min_turning_radius: Annotated[float, Quantity("m", "Radius of the origin's smallest circle")]
    speed: Annotated[float, Quantity("m/s", "Forward speed")]
    acceleration: Annotated[float, Quantity("m/s^2", "Change of speed")] = INF
    steering_rate: Annotated[float, Quantity("rad/s", "Change of the steering angle")] = INF
    reverse: Annotated[float | None, Quantity("m/s", "Backward speed; default: speed")] = None

    @property
    def max_steering(self) -> float:
        """Steering angle at the minimum turning radius, rad."""
        return _core.arc_tangent(self.wheelbase, self.min_turning_radius)

    def part_actions(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Velocity along the body's x, and steering angle, positive to the left."""
        back = self.speed if self.reverse is None else self.reverse
        return (
            Action("v", "m/s", -back, self.speed, self.acceleration),
            Action.symmetric("steering", "rad", self.max_steering, self.steering_rate),
        )

    def native_parameters(self) -> tuple[float, ...]:
        """The wheelbase, meters."""
        return (self.wheelbase,)

    def steering_radius(self) -> float:
        """Turning radius of planned arcs, meters."""
        return RADIUS_MARGIN * self.min_turning_radius

    def from_velocity(
        self, vx: Floats, vy: Floats, turn: Floats, dt: float
    ) -> tuple[list[Floats], Floats]:
        """Speed and steering angle; motion sideways and turns in place are left over."""
        moves = np.abs(vx * dt) > MIN_DISTANCE
        distance = np.where(moves, vx * dt, np.inf)
        steering = np.arctan(turn * self.wheelbase / distance)
        return [vx, steering], np.abs(vy) + np.where(moves, 0.0, np.abs(turn) / dt)

    def base_leg_limits(self, yaw: float, change: Floats, dt: float) -> list[LegLimit]:
        """Limits of a chord of the car's path."""
        ahead = change[0] * math.cos(yaw) + change[1] * math.sin(yaw)
        back = self.speed if self.reverse is None else self.reverse
        speed = (self.speed if ahead >= 0 else back) * (1 - CORNER_LOSS)
        if not math.isinf(self.acceleration):
            speed = min(speed, self.acceleration * dt / (4 * CORNER_LOSS))
        return [LegLimit(float(np.hypot(change[0], change[1])), speed, self.acceleration / 2)]

    def passes_waypoint(self, before: Floats, after: Floats) -> bool:
        """Whether the car may pass a corner between chords: unless it reverses there."""
        a, b = float(np.hypot(*before[:2])), float(np.hypot(*after[:2]))
        if before[:2] @ after[:2] < 0 or abs(a - b) > SPEED_TOLERANCE * max(a, b):
            return False
        return super().passes_waypoint(before[3:], after[3:])

    def lookahead_point(
        self, actions: Floats, rates: Floats, dt: float
    ) -> tuple[Floats, Floats, Flags]:
        """A point ahead for which pure pursuit gives the steering angle."""
        distance = lookahead(actions[:, 0], rates[0], dt)
        course = self._pursued_course(distance, actions[:, 1])
        place = distance[:, None] * np.stack([np.cos(course), np.sin(course)], axis=1)
        return place, np.zeros(len(actions)), actions[:, 0] > -STANDSTILL

    def _pursued_course(self, distance: Floats, steering: Floats) -> Floats:
        """Direction (rad) of the point that gives the steering angle by pursuit.

        The car pursues a point half as far before it:
        tan(steering) = 2 wheelbase sin(course) / (distance (1.25 - cos(course))).
        """
        m = distance * np.tan(steering) / (2 * self.wheelbase)
        return np.asarray(np.arcsin(np.clip(1.25 * m / np.sqrt(1 + m * m), -1, 1)) - np.arctan(m))

    def follow_course(self, ahead: Floats, left: Floats, course: Floats, dt: float) -> list[Floats]:
        """Drive at a minimum speed, steering along the course."""
        speed = np.sqrt(ahead**2 + left**2)
        return [np.maximum(ahead, MIN_SPEED * speed), course]

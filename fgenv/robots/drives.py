"""Drives: what a robot's action means, and how fast it may be.

A drive says what each number of an action is, in which unit, between which limits. It fits robots
of one kind of base; `check` tells. Moving by it is the simulator's business.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from fgenv import _core

from .links_joints import number_of

if TYPE_CHECKING:
    from .robot import Robot

INF = math.inf


class Action(NamedTuple):
    """One number of an action."""

    name: str
    unit: str
    low: float
    high: float
    rate: float = INF  # how much it may change in a second, either way


class Drive(ABC):
    """What all drives have."""

    base: ClassVar[str | None] = None  # the base that it moves: planar or free

    def __post_init__(self) -> None:
        """Every limit is a number over 0; what is infinite if left out may be infinite."""
        for item in fields(self):  # type: ignore[arg-type]
            value = getattr(self, item.name)
            if value is None and item.default is None:
                continue
            name = f"{type(self).__name__}: {item.name}"
            if number_of(value, name, 0.0, finite=item.default != INF) == 0:
                raise ValueError(f"{name}: got 0, expected a limit over 0")

    def check(self, robot: Robot) -> None:
        """ValueError where this drive does not fit the robot, with the remedy."""
        if self.base is not None and robot.base != self.base:
            raise ValueError(
                f"drive: {type(self).__name__} moves a {self.base} base, the base of"
                f" {robot.name!r} is {robot.base}; expected base={self.base!r}, or another drive"
            )

    @abstractmethod
    def actions(self, robot: Robot) -> tuple[Action, ...]:
        """What the numbers of an action are, in order."""


@dataclass(frozen=True)
class Holonomic(Drive):
    """Moves and turns at once, any way: mecanum wheels, or a simple model of anything.

    Attributes:
        speed: m/s, along each axis of the body.
        turn_rate: rad/s.
        acceleration, turn_acceleration: m/s^2, rad/s^2.
    """

    base = "planar"
    speed: float
    turn_rate: float
    acceleration: float = INF
    turn_acceleration: float = INF

    def actions(self, robot: Robot) -> tuple[Action, ...]:
        """Velocity of the origin along the body's x and y, and yaw rate."""
        return (
            _both_ways("vx", "m/s", self.speed, self.acceleration),
            _both_ways("vy", "m/s", self.speed, self.acceleration),
            _both_ways("yaw_rate", "rad/s", self.turn_rate, self.turn_acceleration),
        )


@dataclass(frozen=True)
class DifferentialDrive(Drive):
    """Two wheels on one axle through the origin: goes along the body's x, turns on the spot.

    Attributes:
        speed: m/s, forwards; `reverse` backwards, the same if left out.
        turn_rate: rad/s.
        acceleration, turn_acceleration: m/s^2, rad/s^2.
    """

    base = "planar"
    speed: float
    turn_rate: float
    acceleration: float = INF
    turn_acceleration: float = INF
    reverse: float | None = None

    def actions(self, robot: Robot) -> tuple[Action, ...]:
        """Velocity along the body's x, and yaw rate."""
        back = self.speed if self.reverse is None else self.reverse
        return (
            Action("v", "m/s", -back, self.speed, self.acceleration),
            _both_ways("yaw_rate", "rad/s", self.turn_rate, self.turn_acceleration),
        )


@dataclass(frozen=True)
class Car(Drive):
    """Ackermann steering: the origin, in the middle of the rear axle, goes along the body's x.

    The yaw rate is v tan(steering) / wheelbase.

    Attributes:
        wheelbase: m, between the axles.
        min_turning_radius: m, of the circle that the origin goes on.
        speed: m/s, forwards; `reverse` backwards, the same if left out.
        acceleration: m/s^2.
        steering_rate: rad/s.
    """

    base = "planar"
    wheelbase: float
    min_turning_radius: float
    speed: float
    acceleration: float = INF
    steering_rate: float = INF
    reverse: float | None = None

    @property
    def max_steering(self) -> float:
        """Angle of the front wheels at the smallest turning circle, rad."""
        return _core.arc_tangent(self.wheelbase, self.min_turning_radius)

    def actions(self, robot: Robot) -> tuple[Action, ...]:
        """Velocity along the body's x, and steering angle, to the left over 0."""
        back = self.speed if self.reverse is None else self.reverse
        return (
            Action("v", "m/s", -back, self.speed, self.acceleration),
            _both_ways("steering", "rad", self.max_steering, self.steering_rate),
        )


@dataclass(frozen=True)
class Drone(Drive):
    """A multicopter under velocity control: stays level, moves any way, turns about the vertical.

    Attributes:
        speed: m/s, along the body's x and y; `climb` along z, the same if left out.
        turn_rate: rad/s.
        acceleration, turn_acceleration: m/s^2, rad/s^2.
    """

    base = "free"
    speed: float
    turn_rate: float
    acceleration: float = INF
    turn_acceleration: float = INF
    climb: float | None = None

    def actions(self, robot: Robot) -> tuple[Action, ...]:
        """Velocity of the origin along the body's x, y and z, and yaw rate."""
        climb = self.speed if self.climb is None else self.climb
        return (
            _both_ways("vx", "m/s", self.speed, self.acceleration),
            _both_ways("vy", "m/s", self.speed, self.acceleration),
            _both_ways("vz", "m/s", climb, self.acceleration),
            _both_ways("yaw_rate", "rad/s", self.turn_rate, self.turn_acceleration),
        )


@dataclass(frozen=True)
class JointVelocity(Drive):
    """Every joint that has a value of its own goes at the speed that is asked for.

    Attributes:
        speed, acceleration: rad/s and rad/s^2, or m/s and m/s^2; limits beside those of the joints.
    """

    speed: float = INF
    acceleration: float = INF

    def check(self, robot: Robot) -> None:
        """ValueError where no joint moves, or one has no speed limit."""
        if not robot.moving_joints:
            raise ValueError(f"drive: JointVelocity moves joints, {robot.name!r} has none")
        for action in self.actions(robot):
            if math.isinf(action.high):
                raise ValueError(
                    f"drive: joint {action.name!r} has no speed limit; give JointVelocity(speed=)"
                )

    def actions(self, robot: Robot) -> tuple[Action, ...]:
        """The rate of each joint, in the order of the configuration."""
        return tuple(
            _both_ways(
                joint.name,
                "m/s" if joint.kind == "prismatic" else "rad/s",
                min(joint.velocity, self.speed),
                min(joint.acceleration, self.acceleration),
            )
            for joint in robot.moving_joints
        )


@dataclass(frozen=True)
class MobileManipulator(Drive):
    """A base with a drive, and joints on it: the base's action, then the joints'."""

    platform: Drive
    joints: JointVelocity = JointVelocity()

    def __post_init__(self) -> None:
        for name, expected in (("platform", Drive), ("joints", JointVelocity)):
            value = getattr(self, name)
            if not isinstance(value, expected):
                kind = type(value).__name__
                raise TypeError(
                    f"MobileManipulator: {name}: got {kind}, expected a {expected.__name__}"
                )
        if self.platform.base is None:
            kind = type(self.platform).__name__
            raise ValueError(
                f"MobileManipulator: platform: got {kind}, expected one that moves a base"
            )

    def check(self, robot: Robot) -> None:
        """ValueError where either part does not fit."""
        self.platform.check(robot)
        self.joints.check(robot)

    def actions(self, robot: Robot) -> tuple[Action, ...]:
        """Those of the base, then those of the joints."""
        return self.platform.actions(robot) + self.joints.actions(robot)


def _both_ways(name: str, unit: str, most: float, rate: float) -> Action:
    return Action(name, unit, -most, most, rate)

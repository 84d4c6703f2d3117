"""How a robot gets from one configuration to another: straight, turn-drive-turn, or as a car."""

from __future__ import annotations

import math
from dataclasses import dataclass

from numpy.typing import ArrayLike

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.robots import Car, DifferentialDrive, Drive, MobileManipulator, Robot

CHORDS = 1.002  # a car's circle is drawn so much larger: chords are shorter than their arcs
WAYS = ("straight", "turn_drive_turn", "dubins", "reeds_shepp")


@dataclass(frozen=True)
class Steering:
    """A way of getting from one configuration to another where there is nothing in the way.

    Attributes:
        way: `straight`: as `Robot.interpolate`. `turn_drive_turn`: on the spot, on, on the spot.
            `dubins`, `reeds_shepp`: a car's shortest, forwards only or both ways.
        radius: of a car's smallest circle, meters.
        reverse: whether turn_drive_turn may drive backwards.
    """

    way: str = "straight"
    radius: float = 1.0
    reverse: bool = True

    def __post_init__(self) -> None:
        if self.way not in WAYS:
            raise ValueError(f"steering: got {self.way!r}, expected one of {', '.join(WAYS)}")
        if not 0 < self.radius < math.inf:
            raise ValueError(f"steering: radius {self.radius}, expected finite meters over 0")

    @property
    def code(self) -> int:
        """As the core numbers the ways."""
        return WAYS.index(self.way)

    @classmethod
    def of(cls, robot: Robot, way: str | None = None) -> Steering:
        """What the robot's drive can do: a car's is Reeds-Shepp's, unless `way` says otherwise."""
        drive = platform(robot.drive)
        if isinstance(drive, Car):
            if way == "turn_drive_turn":
                raise ValueError(
                    f"steering: {way!r}, {robot.name!r} is a car, expected 'reeds_shepp'"
                )
            return cls(way or "reeds_shepp", CHORDS * drive.min_turning_radius)
        if way in ("dubins", "reeds_shepp"):
            raise ValueError(f"steering: {way!r} needs a car, {robot.name!r} has another drive")
        if isinstance(drive, DifferentialDrive):
            return cls(way or "turn_drive_turn")
        return cls(way or "straight")


def platform(drive: Drive | None) -> Drive | None:
    """The drive of the base."""
    return drive.platform if isinstance(drive, MobileManipulator) else drive


def legs(robot: Robot, q0: ArrayLike, q1: ArrayLike, way: str | None = None) -> Floats:
    """Configurations that the robot passes from q0 to q1, (m, nq); straight from one to the next.

    Of a car's arcs chords of a tenth of a radian at most.
    """
    steering = Steering.of(robot, way)
    return _core.legs(robot._core, steering.code, steering.radius, steering.reverse, q0, q1)

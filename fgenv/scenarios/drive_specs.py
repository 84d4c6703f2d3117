"""Drives and sensors as a scenario file writes them."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from fgenv import robots
from fgenv.scenarios.shapes.base import Spec, meters, quantity


def limit(unit: str, about: str, default: Any = ...) -> Any:
    """A limit over 0; None, where it may be left out, is no limit."""
    return quantity(unit, about, default, gt=0, le=1e6)


class DriveSpec(Spec):
    """What all drives have."""

    made: ClassVar[type[robots.Drive]]

    def build(self) -> robots.Drive:
        """The drive of `fgenv.robots`."""
        return self.made(**self.model_dump(exclude={"kind"}, exclude_none=True))


class Holonomic(DriveSpec):
    """Moves and turns at once, any way; planar base."""

    made = robots.Holonomic
    kind: Literal["holonomic"]
    speed: float = limit("m/s", "Along each axis of the body")
    turn_rate: float = limit("rad/s", "Yaw rate")
    acceleration: float | None = limit("m/s^2", "Change of speed", None)
    turn_acceleration: float | None = limit("rad/s^2", "Change of yaw rate", None)


class Differential(DriveSpec):
    """Two wheels on one axle through the origin; planar base."""

    made = robots.DifferentialDrive
    kind: Literal["differential"]
    speed: float = limit("m/s", "Forwards")
    turn_rate: float = limit("rad/s", "Yaw rate")
    acceleration: float | None = limit("m/s^2", "Change of speed", None)
    turn_acceleration: float | None = limit("rad/s^2", "Change of yaw rate", None)
    reverse: float | None = limit("m/s", "Backwards; as forwards if left out", None)


class Car(DriveSpec):
    """Ackermann steering, the origin at the rear axle; planar base."""

    made = robots.Car
    kind: Literal["car"]
    wheelbase: float = meters("Between the axles")
    min_turning_radius: float = meters("Of the circle that the origin goes on")
    speed: float = limit("m/s", "Forwards")
    acceleration: float | None = limit("m/s^2", "Change of speed", None)
    steering_rate: float | None = limit("rad/s", "Change of the steering angle", None)
    reverse: float | None = limit("m/s", "Backwards; as forwards if left out", None)


class Drone(DriveSpec):
    """A multicopter under velocity control, level; free base."""

    made = robots.Drone
    kind: Literal["drone"]
    speed: float = limit("m/s", "Along the body's x and y")
    turn_rate: float = limit("rad/s", "Yaw rate")
    acceleration: float | None = limit("m/s^2", "Change of speed", None)
    turn_acceleration: float | None = limit("rad/s^2", "Change of yaw rate", None)
    climb: float | None = limit("m/s", "Along z; as speed if left out", None)


class JointVelocity(DriveSpec):
    """Every joint goes at the speed that is asked for, within its own limits."""

    made = robots.JointVelocity
    kind: Literal["joint_velocity"]
    speed: float | None = limit("rad/s or m/s", "Of every joint", None)
    acceleration: float | None = limit("rad/s^2 or m/s^2", "Of every joint", None)


class MobileManipulator(DriveSpec):
    """A base with a drive, and joints on it."""

    kind: Literal["mobile_manipulator"]
    platform: Annotated[Holonomic | Differential | Car | Drone, Field(discriminator="kind")]
    joints: JointVelocity = JointVelocity(kind="joint_velocity")

    def build(self) -> robots.Drive:
        joints = self.joints.build()
        assert isinstance(joints, robots.JointVelocity)
        return robots.MobileManipulator(self.platform.build(), joints)


AnyDrive = Annotated[
    Holonomic | Differential | Car | Drone | JointVelocity | MobileManipulator,
    Field(discriminator="kind"),
]


class Lidar(Spec):
    """Rays from a point of the robot's root, spread evenly; hits are on the exact meshes."""

    rays: int = Field(default=12, ge=1, le=100_000, strict=True, description="Rays in a row")
    range: float = meters("How far a ray reaches", 5.0)
    field_of_view: float = quantity(
        "rad", "Of a row, about x ahead; 2 pi goes round", 2 * math.pi, gt=0, le=6.283185307179587
    )
    rows: int = Field(default=1, ge=1, le=1000, strict=True, description="Rows: more than 1 is 3D")
    rise: float = quantity("rad", "Of all rows, from lowest to highest", 0.0, ge=0, le=3.15)
    position: tuple[float, float, float] = Field(
        default=(0.0, 0.0, 0.1), description="On the root (m)"
    )

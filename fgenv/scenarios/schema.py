"""The schema of scenario files, with units.

Meters, seconds, radians, right-handed, z up. A configuration is that of `fgenv.robots.Robot`:
planar x, y, yaw; free x, y, z, qx, qy, qz, qw; then one number for each joint.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, PrivateAttr, model_validator

from fgenv.robots.urdf import rotation
from fgenv.scenarios.shapes.base import Spec, quantity
from fgenv.scenarios.shapes.bodies import AnyForm

from .drive_specs import AnyDrive, Lidar

if TYPE_CHECKING:
    from fgenv.arrays import Floats

VERSION = 1
Coordinate = Annotated[float, quantity("m or rad", "Coordinate", ge=-1e6, le=1e6)]
Vector = tuple[Coordinate, Coordinate, Coordinate]
Configuration = Annotated[tuple[Coordinate, ...], Field(min_length=1, max_length=200)]
Name = Annotated[str, Field(min_length=1, max_length=100)]
Label = Annotated[str, Field(pattern="^[^/]+$", max_length=100)]  # a slash parts robot and link
ORIGIN = (0.0, 0.0, 0.0)


class Placement(Spec):
    """A pose."""

    position: Vector = Field(default=ORIGIN, description="Origin in the world frame (m)")
    rpy: Vector = Field(default=ORIGIN, description="Roll, pitch, yaw about fixed x, y, z (rad)")

    @property
    def pose(self) -> Floats:
        """(4, 4), the same bits on every machine."""
        pose = rotation(self.rpy)
        pose[:3, 3] = self.position
        return pose


class Workspace(Spec):
    """Bounds of the origins of planar and free bases."""

    low: Annotated[tuple[Coordinate, ...], Field(min_length=2, max_length=3)] = Field(
        description="Lower bounds of x, y or x, y, z (m)"
    )
    high: Annotated[tuple[Coordinate, ...], Field(min_length=2, max_length=3)] = Field(
        description="Upper bounds of x, y or x, y, z (m)"
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if len(self.low) != len(self.high):
            raise ValueError(f"low has {len(self.low)} numbers, high {len(self.high)}")
        if any(a >= b for a, b in zip(self.low, self.high, strict=True)):
            raise ValueError(f"low {list(self.low)} is not below high {list(self.high)}")
        return self


class Attachment(Placement):
    """An object that a link carries: a link of its own, fixed to it."""

    name: Label = Field(description="Unique among the links")
    link: Name = Field(description="Link that carries the object; its frame is that of the pose")
    shape: Name = Field(description="Name of a shape")
    touch_links: tuple[Name, ...] = Field(
        default=(), description="Other links that the object may touch"
    )


class Model(Spec):
    """A kind of robot: one shape, or a URDF file."""

    shape: Name | None = Field(default=None, description="Name of a shape: a robot of one link")
    urdf: Name | None = Field(
        default=None,
        description="Robot file (URDF, xacro, MJCF or SDF), relative to the scenario file, or"
        " package://NAME/PATH",
    )
    srdf: Name | None = Field(
        default=None,
        description="SRDF file with allowed collisions of links; path as for urdf",
    )
    base: Literal["planar", "free", "fixed"] | None = Field(
        default=None, description="Kind of base; default: fixed for a URDF, else planar"
    )
    drive: AnyDrive | None = Field(
        default=None, description="Drive: the meaning of actions, and limits"
    )
    allowed: tuple[tuple[Name, Name], ...] = Field(
        default=(), description="Pairs of links excluded from self-collision checks"
    )
    lidar: Lidar | None = Field(default=None, description="Range sensor")
    locked: dict[Name, Coordinate] = Field(
        default={}, description="Joints that are fixed, with their values (m or rad)"
    )
    attached: tuple[Attachment, ...] = Field(
        default=(), max_length=1000, description="Objects that links carry"
    )

    @model_validator(mode="after")
    def _one_of(self) -> Self:
        if (self.shape is None) == (self.urdf is None):
            raise ValueError("has both shape and urdf" if self.urdf else "has no shape or urdf")
        for part in ("srdf", "locked", "attached"):
            if getattr(self, part) and self.urdf is None:
                raise ValueError(f"has {part} but no urdf")
        return self


class Tolerance(Spec):
    """Tolerances within which a robot has reached its goal."""

    position: float = quantity(
        "m", "Tolerance of the base position and of prismatic joints", 0.1, gt=0
    )
    angle: float = quantity(
        "rad", "Tolerance of the base orientation and of other joints", 0.2, gt=0
    )


class RobotSpec(Spec):
    """A robot with its start and its goal."""

    name: Label = Field(description="Unique among robots and bodies")
    model: Name = Field(description="Name of a model")
    start: Configuration = Field(description="Configuration (m, rad)")
    goal: Configuration = Field(description="Configuration (m, rad)")
    mount: Placement = Field(default=Placement(), description="Frame of the base in the world")
    goal_tolerance: Tolerance = Tolerance()
    groups: tuple[Name, ...] = Field(default=(), description="For allowed")


class Body(Placement):
    """A static body."""

    name: Label | None = Field(default=None, description="Unique; default: 'body 1' and so on")
    shape: Name = Field(description="Name of a shape")
    groups: tuple[Name, ...] = Field(default=(), description="For allowed")


class ScenarioSpec(Spec):
    """Robots with starts and goals among bodies: the content of a scenario file."""

    model_config = ConfigDict(title="Scenario")

    version: Literal[1] = Field(description="Version of this schema")
    name: Name
    description: str = ""
    seed: int = Field(
        default=0, ge=0, lt=2**63, strict=True, description="Seed of all random choices"
    )
    time_step: float = quantity("s", "Duration of a step", 0.1, gt=0, le=1e3)
    horizon: float = quantity("s", "Maximum duration of an episode", 60.0, gt=0, le=1e6)
    on_collision: Literal["stop", "terminate", "pass"] = Field(
        default="stop",
        description="On collision: the robot stops, the episode ends, or it is only counted",
    )
    at_goal: Literal["park", "vanish"] = Field(
        default="park", description="A robot at its goal stays as an obstacle, or is removed"
    )
    workspace: Workspace | None = None
    shapes: dict[Name, AnyForm] = Field(
        default={}, description="Shapes by name, shared by robots and bodies"
    )
    models: dict[Name, Model] = Field(default={}, description="Models by name, shared by robots")
    robots: tuple[RobotSpec, ...] = Field(default=(), max_length=10_000)
    bodies: tuple[Body, ...] = Field(default=(), max_length=1_000_000)
    allowed: tuple[tuple[Name, Name], ...] = Field(
        default=(),
        description="Pairs excluded from collision checks: names of groups, robots or bodies, or"
        " ROBOT/LINK for a link; 'robots' is the group of all robots, 'static' of all bodies",
    )

    _folder: Path | None = PrivateAttr(None)

    @property
    def folder(self) -> Path | None:
        """Folder of relative mesh paths; None: the current directory."""
        return self._folder

    def at(self, folder: Path | None) -> Self:
        """The same scenario with paths relative to another folder."""
        other = self.model_copy()
        other._folder = folder
        return other

    def replace(self, **changes: Any) -> Self:
        """A copy with other values of some fields, checked against the schema."""
        plain = {name: getattr(self, name) for name in type(self).model_fields}
        return type(self)(**{**plain, **changes}).at(self.folder)

    @property
    def dimension(self) -> int:
        """3 if a base is free or fixed, 2 if all are planar."""
        bases = {self.models[robot.model].base for robot in self.robots}
        urdf = any(self.models[r.model].urdf for r in self.robots)
        return 3 if urdf or bases & {"free", "fixed"} else 2


def yaw_quaternion(yaw: float) -> tuple[float, float, float, float]:
    """Quaternion x, y, z, w of a rotation about z by `yaw` (rad)."""
    from fgenv import _core

    sine, cosine = _core.sin_cos(0.5 * yaw)
    return 0.0, 0.0, float(sine), float(cosine)

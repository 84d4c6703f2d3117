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

    position: Vector = Field(default=ORIGIN, description="Of the origin in the world (m)")
    rpy: Vector = Field(default=ORIGIN, description="Roll, pitch, yaw about fixed x, y, z (rad)")

    @property
    def pose(self) -> Floats:
        """(4, 4), the same bits on every machine."""
        pose = rotation(self.rpy)
        pose[:3, 3] = self.position
        return pose


class Workspace(Spec):
    """Bounds of where the origins of planar and free bases may be."""

    low: Annotated[tuple[Coordinate, ...], Field(min_length=2, max_length=3)] = Field(
        description="Least x, y or x, y, z (m)"
    )
    high: Annotated[tuple[Coordinate, ...], Field(min_length=2, max_length=3)] = Field(
        description="Greatest x, y or x, y, z (m)"
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if len(self.low) != len(self.high):
            raise ValueError(f"low has {len(self.low)} numbers, high {len(self.high)}")
        if any(a >= b for a, b in zip(self.low, self.high, strict=True)):
            raise ValueError(f"low {list(self.low)} is not below high {list(self.high)}")
        return self


class Model(Spec):
    """A kind of robot: one shape, or a URDF file."""

    shape: Name | None = Field(default=None, description="Name of a shape: a robot of one link")
    urdf: Name | None = Field(
        default=None, description="URDF file, relative to the scenario file, or package://NAME/PATH"
    )
    srdf: Name | None = Field(
        default=None, description="SRDF file with pairs of links that may touch; path as urdf's"
    )
    base: Literal["planar", "free", "fixed"] | None = Field(
        default=None, description="How it is placed; if left out, fixed for a URDF, else planar"
    )
    drive: AnyDrive | None = Field(default=None, description="What an action means, and limits")
    allowed: tuple[tuple[Name, Name], ...] = Field(default=(), description="Links that may touch")
    lidar: Lidar | None = Field(default=None, description="Range sensor")

    @model_validator(mode="after")
    def _one_of(self) -> Self:
        if (self.shape is None) == (self.urdf is None):
            raise ValueError("has both shape and urdf" if self.urdf else "has no shape or urdf")
        if self.srdf is not None and self.urdf is None:
            raise ValueError("has srdf but no urdf")
        return self


class Tolerance(Spec):
    """How near to its goal a robot has arrived."""

    position: float = quantity("m", "Of the base, and of prismatic joints", 0.1, gt=0)
    angle: float = quantity("rad", "Of the base, and of other joints", 0.2, gt=0)


class RobotSpec(Spec):
    """A robot, where it starts and where it has to go."""

    name: Label = Field(description="Unique among robots and bodies")
    model: Name = Field(description="Name of a model")
    start: Configuration = Field(description="Configuration (m, rad)")
    goal: Configuration = Field(description="Configuration (m, rad)")
    mount: Placement = Field(default=Placement(), description="Frame of the base in the world")
    goal_tolerance: Tolerance = Tolerance()
    groups: tuple[Name, ...] = Field(default=(), description="For allowed")


class Body(Placement):
    """A body that stands."""

    name: Label | None = Field(default=None, description="Unique; 'body 1' and so on if left out")
    shape: Name = Field(description="Name of a shape")
    groups: tuple[Name, ...] = Field(default=(), description="For allowed")


class ScenarioSpec(Spec):
    """Robots with starts and goals among bodies: the content of a scenario file."""

    model_config = ConfigDict(title="Scenario")

    version: Literal[1] = Field(description="Of this schema")
    name: Name
    description: str = ""
    seed: int = Field(default=0, ge=0, lt=2**63, strict=True, description="Of all that is random")
    time_step: float = quantity("s", "Of a step", 0.1, gt=0, le=1e3)
    horizon: float = quantity("s", "An episode ends then", 60.0, gt=0, le=1e6)
    on_collision: Literal["stop", "terminate", "pass"] = Field(
        default="stop",
        description="A robot that meets something stops, ends the episode, or is counted",
    )
    at_goal: Literal["park", "vanish"] = Field(
        default="park", description="A robot at its goal stays as an obstacle, or is gone"
    )
    workspace: Workspace | None = None
    shapes: dict[Name, AnyForm] = Field(
        default={}, description="By name, shared by all that bear it"
    )
    models: dict[Name, Model] = Field(default={}, description="By name, shared by robots")
    robots: tuple[RobotSpec, ...] = Field(default=(), max_length=10_000)
    bodies: tuple[Body, ...] = Field(default=(), max_length=1_000_000)
    allowed: tuple[tuple[Name, Name], ...] = Field(
        default=(),
        description="Pairs whose contact is no collision: names of groups, robots or bodies;"
        " 'robots' are all robots, 'static' all bodies",
    )

    _folder: Path | None = PrivateAttr(None)

    @property
    def folder(self) -> Path | None:
        """What paths of mesh files are relative to; None: where the process is."""
        return self._folder

    def at(self, folder: Path | None) -> Self:
        """The same scenario, its paths relative to another folder."""
        other = self.model_copy()
        other._folder = folder
        return other

    def replace(self, **changes: Any) -> Self:
        """The same scenario but for some fields, checked against the schema."""
        plain = {name: getattr(self, name) for name in type(self).model_fields}
        return type(self)(**{**plain, **changes}).at(self.folder)

    @property
    def dimension(self) -> int:
        """3 where some base is free or fixed, 2 where all are planar."""
        bases = {self.models[robot.model].base for robot in self.robots}
        urdf = any(self.models[r.model].urdf for r in self.robots)
        return 3 if urdf or bases & {"free", "fixed"} else 2


def yaw_quaternion(yaw: float) -> tuple[float, float, float, float]:
    """Quaternion x, y, z, w of a turn about z (rad)."""
    from fgenv import _core

    sine, cosine = _core.sin_cos(0.5 * yaw)
    return 0.0, 0.0, float(sine), float(cosine)

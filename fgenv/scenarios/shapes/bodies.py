"""The kinds of shapes in a scenario file."""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.robots import primitives
from fgenv.scenarios.meshes import three_tanks, vehicles

from . import boxes, puzzles
from .base import LONGEST, Form, Length, Solid, meters, quantity

Coordinate = Annotated[float, quantity("m", "Coordinate", ge=-LONGEST, le=LONGEST)]
Point = tuple[Coordinate, Coordinate, Coordinate]
Place = Annotated[int, Field(ge=0, strict=True)]
Triple = tuple[Place, Place, Place]


class Box(Solid):
    """A box, centered at the origin."""

    kind: Literal["box"]
    size: tuple[Length, Length, Length] = Field(description="Edges along x, y and z (m)")

    def mesh(self) -> Any:
        return primitives.box(self.size)


class Block(Solid):
    """A box that stands on the floor at its origin."""

    kind: Literal["block"]
    size: tuple[Length, Length, Length] = Field(description="Edges along x, y and z (m)")

    def mesh(self) -> Any:
        x, y, z = self.size
        return three_tanks.block((-x / 2, -y / 2, 0.0), (x / 2, y / 2, z))


class Cylinder(Solid):
    """A cylinder about z, centered at the origin; the mesh encloses it by at most 1 mm."""

    kind: Literal["cylinder"]
    radius: float = meters("Radius")
    length: float = meters("Length along z")

    def mesh(self) -> Any:
        return primitives.cylinder(self.radius, self.length)[0]


class Sphere(Solid):
    """A sphere, centered at the origin; the mesh encloses it by at most 1 % of its radius."""

    kind: Literal["sphere"]
    radius: float = meters("Radius")

    def mesh(self) -> Any:
        return primitives.sphere(self.radius, max(1e-3, 0.01 * self.radius))[0]


class Disc(Solid):
    """An upright prism of 24 sides around a circle; stands on the floor at its origin."""

    kind: Literal["disc"]
    radius: float = meters("Radius of the circle that the prism encloses")
    height: float = meters("Height", 0.3)

    def mesh(self) -> Any:
        return vehicles.drum(self.radius * 1.00863, 0.0, self.height)  # 1 / cos(pi / 24)


class LShape(Solid):
    """An L seen from above, corner at -x, -y; stands on the floor, middle of its box at 0, 0."""

    kind: Literal["l"]
    length: float = meters("Length along x")
    width: float = meters("Width along y")
    arm: float = meters("Thickness of both arms, below length and width")
    height: float = meters("Height", 0.3)

    def mesh(self) -> Any:
        if self.arm >= min(self.length, self.width):
            raise ValueError(f"arm: got {self.arm:g}, expected less than length and width")
        return vehicles.angle_iron(self.length, self.width, self.arm, self.height)


class Cart(Solid):
    """A low transport robot, x forward; stands on the floor at its origin."""

    kind: Literal["cart"]
    length: float = meters("Length along x", 0.8)
    width: float = meters("Width along y", 0.5)
    height: float = meters("Height", 0.25)

    def mesh(self) -> Any:
        return vehicles.cart(self.length, self.width, self.height)


class CarBody(Solid):
    """A car, x forward, the origin on the floor under its rear axle; axles 0.6 length apart."""

    kind: Literal["car"]
    length: float = meters("Length along x", 2.5)
    width: float = meters("Width along y", 1.2)
    height: float = meters("Height", 1.2)

    def mesh(self) -> Any:
        return vehicles.car(self.length, self.width, self.height)


class Shelf(Solid):
    """A rack on four legs, its boards along x; stands on the floor at its origin."""

    kind: Literal["shelf"]
    length: float = meters("Length along x", 2.0)
    depth: float = meters("Width along y", 1.0)
    height: float = meters("Height", 1.6)
    clear: float = meters("Room under the lowest board, below the height", 0.35)
    levels: int = Field(default=3, ge=1, le=20, strict=True, description="Number of boards")

    def mesh(self) -> Any:
        if self.clear >= self.height:
            raise ValueError(f"clear: got {self.clear:g}, expected less than the height")
        sizes = self.length, self.depth, self.height, self.clear
        return vehicles.shelf(*sizes, self.levels)


class Tree(Solid):
    """A conifer; stands on the floor at its origin."""

    kind: Literal["tree"]
    radius: float = meters("Radius of the trunk", 0.12)
    height: float = meters("Height", 4.0)
    crown: float = meters("Radius of the crown", 0.8)

    def mesh(self) -> Any:
        return vehicles.tree(self.radius, self.height, self.crown)


class Quadcopter(Solid):
    """A quadcopter with four rotors, x forward, centered at the origin."""

    kind: Literal["quadcopter"]
    span: float = meters("Width over the rotors", 0.5)
    height: float = meters("Height", 0.12)

    def mesh(self) -> Any:
        return vehicles.drone(self.span, self.height)


class Tank(Solid):
    """A tank on four legs with a nozzle, of the published scene; stands on the floor."""

    kind: Literal["tank"]
    radius: float = meters("Radius")
    height: float = meters("Height of the shell")
    nozzle: float = quantity("rad", "Direction of the nozzle, about z", 0.0, ge=-10, le=10)

    def mesh(self) -> Any:
        return three_tanks.tank(self.radius, self.height, self.nozzle)


class MobileRobot(Solid):
    """The mobile robot with a lifting fork of the published scene, 1.1 m long, x forward."""

    kind: Literal["mobile_robot"]

    def mesh(self) -> Any:
        return three_tanks.mobile_robot()


class MeshFile(Form):
    """A mesh file: STL, OBJ, PLY, OFF, GLB or DAE."""

    kind: Literal["mesh"]
    file: str = Field(min_length=1, description="Path, relative to the scenario file")
    scale: float = quantity("-", "Factor to meters: 0.001 for a file in millimeters", 1.0, gt=0)
    up: Literal["z", "y", "-y", "x"] = Field(
        default="z",
        description="Axis of the file that becomes z: y turns (x, y, z) to (x, -z, y),"
        " -y to (x, z, -y), x to (-z, y, x)",
    )
    origin: Point = Field(
        default=(0.0, 0.0, 0.0), description="Point that becomes the origin, after up (m)"
    )
    sha256: str | None = Field(
        default=None,
        pattern="^[0-9a-f]{64}$",
        description="SHA-256 of the file, checked when it is loaded",
    )

    def path(self, folder: Path | None) -> Path:
        """Path of the file."""
        return (folder or Path()) / self.file

    def shape(self, folder: Path | None = None) -> Shape:
        path = self.path(folder).resolve()
        status = path.stat() if path.is_file() else None
        changed = status and (status.st_mtime_ns, status.st_size)
        return _from_file(path, self.scale, self.up, self.origin, changed)

    def check_hash(self, folder: Path | None) -> None:
        """Raise ValueError if the hash of the file is not `sha256`."""
        found = hashlib.sha256(self.path(folder).read_bytes()).hexdigest()
        if self.sha256 not in (None, found):
            raise ValueError(f"sha256 of {self.file} is {found}, not as written")


class Triangles(Solid):
    """A mesh given by its vertices and faces."""

    kind: Literal["triangles"]
    vertices: tuple[Point, ...] = Field(min_length=3, description="x, y, z of each (m)")
    faces: tuple[Triple, ...] = Field(
        min_length=1, description="Three indices of vertices, from 0, counter-clockwise"
    )

    def mesh(self) -> Any:
        return Shape(self.vertices, self.faces, name=self.kind)


AnyForm = Annotated[
    Box
    | Block
    | Cylinder
    | Sphere
    | Disc
    | LShape
    | Cart
    | CarBody
    | Shelf
    | Tree
    | Quadcopter
    | Tank
    | MobileRobot
    | puzzles.Cone
    | puzzles.Table
    | puzzles.Chair
    | puzzles.TwistedBar
    | puzzles.TwistedWall
    | puzzles.BugTrap
    | puzzles.OpenRing
    | MeshFile
    | Triangles
    | boxes.Boxes,
    Field(discriminator="kind"),
]


@lru_cache(maxsize=256)
def _from_file(path: Path, scale: float, up: str, origin: Point, status: object) -> Shape:
    """`status` makes the cache read a changed file again."""
    shape = Shape.load(path, scale=scale)
    if up == "z" and not any(origin):
        return shape
    vertices = turned_up(np.asarray(shape.vertices), up) - np.array(origin)
    return Shape(vertices, shape.faces, name=shape.name)


def turned_up(points: Floats, up: str) -> Floats:
    """Points (n, 3) turned so that an axis (x, y, -y or z) becomes z; exact."""
    x, y, z = points.T
    axes = {"z": (x, y, z), "y": (x, -z, y), "-y": (x, z, -y), "x": (-z, y, x)}
    return np.column_stack(axes[up])

"""Links and joints from URDF, read by yourdfpy.

yourdfpy provides the tree, limits and geometry. Origins come from the text, with the native core's
sines and cosines, so that a file gives the same robot, bit for bit, on every machine.
"""

from __future__ import annotations

import math
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape

from . import primitives
from .links_joints import MAX_VALUE, Joint, Link, LinkShape, Mimic
from .mesh_location import PackagePaths
from .mesh_shapes import MeshShapes
from .robot_file import RobotFile
from .urdf_document import check_document, load_model, numbers, parsed_document, quaternion
from .xacro_files import expand_xacro


def read_urdf(
    path: Path,
    packages: PackagePaths,
    *,
    collision: bool,
    scale: float,
    error: float,
    shape_options: dict[str, Any],
    soft_limits: bool = False,
    xacro_args: Mapping[str, str] | None = None,
) -> RobotFile:
    """Read the robot of a URDF file, or of a xacro file (.xacro).

    Args:
        packages: folders in which packages are searched first.
        collision: True: use collision geometry; False: visual geometry.
        scale: factor of all lengths.
        error: meters by which the mesh of a cylinder or sphere, which encloses it, may exceed it.
        shape_options: of Shape.
        soft_limits: keep to the limits of <safety_controller> as well.
        xacro_args: values of <xacro:arg> by name.

    Raises:
        FileNotFoundError: the file, or a mesh in it, with the places searched.
        ModuleNotFoundError: yourdfpy or xacro is not installed.
        ValueError: invalid content, with file, line or link.
    """
    meshes = MeshShapes(path, packages, scale, shape_options)
    reader = _Reader(path, collision, scale, error, meshes, soft_limits)
    if path.suffix.lower() != ".xacro":
        if xacro_args:
            raise ValueError(f"xacro_args: got some for {path}, expected a .xacro file")
        return reader.read()
    text = expand_xacro(path, xacro_args or {}, packages)
    try:
        return reader.read(text)
    except ValueError as fault:
        raise ValueError(f"{fault} (lines of the expanded file: xacro {path})") from fault


@dataclass
class _Reader:
    """Reader of one URDF file."""

    path: Path
    collision: bool
    scale: float
    error: float  # meters, of cylinders and spheres
    meshes: MeshShapes
    soft_limits: bool
    notes: list[str] = field(default_factory=list)

    def read(self, text: bytes | None = None) -> RobotFile:
        """Return the robot.

        Args:
            text: None: the content of the file.
        """
        document = parsed_document(self.path, self.notes, text=text)
        kind, unused = ("collision", "visual")[:: 1 if self.collision else -1]
        other = document.find(f"link/{unused}") is not None
        check_document(document, self.path, kind)
        model = load_model(document, self.path)
        texts = document.findall("link"), document.findall("joint")
        links = [self._link(link, text) for link, text in zip(model.links, texts[0], strict=True)]
        slides = {joint.name for joint in model.joints if joint.type == "prismatic"}
        joints = [self._joint(j, t, slides) for j, t in zip(model.joints, texts[1], strict=True)]
        return RobotFile(model.name, links, joints, notes=self.notes, other_geometry=other)

    def _link(self, link: Any, text: Any) -> Link:
        kind = "collision" if self.collision else "visual"
        items = link.collisions if self.collision else link.visuals
        shapes = []
        for item, element in zip(items, text.findall(kind), strict=True):
            shape, excess = self._shape(item.geometry, link.name)
            shapes.append(LinkShape(shape, self._origin(element), excess))
        return Link(link.name, shapes)

    def _joint(self, joint: Any, text: Any, slides: Container[str]) -> Joint:
        length = self.scale if joint.type == "prismatic" else 1.0
        limit, velocity = joint.limit, math.inf
        lower, upper = self._limits(joint, text, length)
        if limit is not None and limit.velocity:  # 0 means unknown
            velocity = length * limit.velocity
        mimic = None
        if joint.mimic is not None and joint.type != "fixed":
            m = joint.mimic
            followed = self.scale if m.joint in slides else 1.0
            mimic = Mimic(m.joint, m.multiplier * length / followed, length * m.offset)
        origin, axis = self._origin(text), joint.axis
        names = joint.name, joint.type, joint.parent, joint.child
        return Joint(*names, origin, axis, lower, upper, velocity, mimic=mimic)

    def _limits(self, joint: Any, text: Any, length: float) -> tuple[float, float]:
        """Limits of a joint's coordinate; a missing one is 0, which is the format's default."""
        if joint.type not in ("revolute", "prismatic"):
            return -math.inf, math.inf
        limit, label = joint.limit, f"joint {joint.name!r}"
        if limit is None or (limit.lower is None and limit.upper is None):
            self.notes.append(f"The {label} has no limits; it is unbounded.")
            return -math.inf, math.inf
        ends = [0.0 if x is None else float(x) for x in (limit.lower, limit.upper)]
        soft = text.find("safety_controller")
        if self.soft_limits and soft is not None:
            for k, name in enumerate(("soft_lower_limit", "soft_upper_limit")):
                if (value := soft.get(name)) is not None:
                    ends[k] = (max, min)[k](ends[k], float(value))
        if max(map(abs, ends)) > MAX_VALUE:
            self.notes.append(f"The {label} has limits over {MAX_VALUE:g}; it is unbounded there.")
        low, high = (x if abs(x) <= MAX_VALUE else math.copysign(math.inf, x) for x in ends)
        return length * low, length * high

    def _origin(self, text: Any) -> Floats:
        """The pose of an element's <origin>."""
        origin = text.find("origin")
        if origin is None:
            return np.eye(4)
        if origin.get("quat_xyzw") is None:
            pose = rotation(numbers(origin, "rpy", self.path))
        else:
            pose = np.eye(4)
            pose[:3, :3] = rotation_of_quaternion(*quaternion(origin, self.path))
        pose[:3, 3] = [self.scale * x for x in numbers(origin, "xyz", self.path)]
        return pose

    def _shape(self, geometry: Any, link: str) -> tuple[Shape, float]:
        if geometry.mesh is not None:
            scale = 1.0 if geometry.mesh.scale is None else geometry.mesh.scale
            factors = tuple(np.broadcast_to(scale, 3).astype(float).tolist())
            label = f"{self.path}: link {link!r}"
            return self.meshes.shape(geometry.mesh.filename, factors, label), 0.0
        try:
            return self._primitive(geometry)
        except ValueError as error:
            raise ValueError(f"{self.path}: link {link!r}: {error}") from None

    def _primitive(self, geometry: Any) -> tuple[Shape, float]:
        k, options = self.scale, self.meshes.options
        if geometry.box is not None:
            return primitives.box(k * geometry.box.size, **options), 0.0
        if geometry.sphere is not None:
            return primitives.sphere(k * geometry.sphere.radius, self.error, **options)
        form = geometry.cylinder
        return primitives.cylinder(k * form.radius, k * form.length, self.error, **options)


def rotation_of_quaternion(x: float, y: float, z: float, w: float) -> list[list[float]]:
    """Rotation (3, 3) of a unit quaternion."""
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]


def rotation(rpy: Sequence[float]) -> Floats:
    """Rotation by roll, pitch, yaw (rad) about fixed x, y, z, as a pose (4, 4)."""
    sines, cosines = _core.sin_cos(rpy)
    (sr, sp, sy), (cr, cp, cy) = sines.tolist(), cosines.tolist()
    pose = np.eye(4)
    pose[0, :3] = cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr
    pose[1, :3] = sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr
    pose[2, :3] = -sp, cp * sr, cp * cr
    return pose

"""Links and joints from URDF, read by yourdfpy.

yourdfpy provides the tree, limits and geometry. Origins come from the text, with the native core's
sines and cosines, so that a file gives the same robot, bit for bit, on every machine.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.collision.mesh_files import read_mesh_file

from . import primitives
from .configuration_space import ConfigurationSpace, source_limits
from .links_joints import MAX_VALUE, Joint, Link, LinkShape, Mimic
from .mesh_location import PackagePaths, find_mesh
from .topology import mimic_source
from .urdf_document import check_document, load_model, numbers, parsed_document, quaternion
from .xacro_files import expand_xacro


@dataclass
class Reader:
    """Reader of one URDF file."""

    path: Path
    packages: PackagePaths
    collision: bool
    scale: float
    error: float  # meters, of cylinders and spheres
    shape_options: dict[str, Any]  # of Shape
    soft_limits: bool = False  # of <safety_controller>, where it has them
    xacro_args: Mapping[str, str] = field(default_factory=dict)
    meshes: dict[tuple[Any, ...], Shape] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def read(self) -> tuple[str, list[Link], list[Joint]]:
        """Return name, links and joints of the file."""
        if self.path.suffix.lower() != ".xacro":
            if self.xacro_args:
                raise ValueError(f"xacro_args: got some for {self.path}, expected a .xacro file")
            return self._read(None)
        text = expand_xacro(self.path, self.xacro_args, self.packages)
        try:
            return self._read(text)
        except ValueError as error:
            raise ValueError(f"{error} (lines of the expanded file: xacro {self.path})") from error

    def _read(self, text: bytes | None) -> tuple[str, list[Link], list[Joint]]:
        document = parsed_document(self.path, self.notes, text=text)
        seen = document.find("link/visual") is not None
        kind = "collision" if self.collision else "visual"
        check_document(document, self.path, kind)
        model = load_model(document, self.path)
        texts = document.findall("link"), document.findall("joint")
        links = [self._link(link, text) for link, text in zip(model.links, texts[0], strict=True)]
        slides = {joint.name for joint in model.joints if joint.type == "prismatic"}
        joints = [self._joint(j, t, slides) for j, t in zip(model.joints, texts[1], strict=True)]
        shaped = any(link.shapes for link in links)
        if self.collision and not shaped and seen:
            warnings.warn(
                f"{self.path}: got visual but no collision geometry, so that nothing collides;"
                " give collision=False to use the visual geometry",
                UserWarning,
                stacklevel=3,
            )
        joints = self._without_contradictions(joints)
        try:
            ConfigurationSpace(model.name, tuple(links), tuple(joints))
        except ValueError as error:
            raise ValueError(f"{self.path}: {error}") from None
        return model.name, links, joints

    def _without_contradictions(self, joints: list[Joint]) -> list[Joint]:
        """Joints that mimic others without limits that leave the others no room; noted.

        Many grippers' files give a joint that turns the other way the limits of the joint that it
        mimics.
        """
        by_name = {joint.name: joint for joint in joints}
        limits = {joint.name: (joint.lower, joint.upper) for joint in joints}
        result = list(joints)
        for i, joint in enumerate(joints):
            if joint.mimic is None:
                continue
            try:
                source, multiplier, offset = mimic_source(joint, by_name)
            except ValueError:  # Robot reports it
                continue
            own, low_high = limits[source.name], source_limits(joint, multiplier, offset)
            both = max(own[0], low_high[0]), min(own[1], low_high[1])
            if both[0] < both[1] or both[0] == both[1] == own[0] == own[1]:
                limits[source.name] = both
                continue
            self.notes.append(
                f"The limits of joint {joint.name!r} contradict those of {source.name!r}, which it"
                " mimics; they are left out."
            )
            result[i] = replace(joint, lower=-math.inf, upper=math.inf)
        return result

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
            return self._mesh(geometry.mesh, link), 0.0
        try:
            return self._primitive(geometry)
        except ValueError as error:
            raise ValueError(f"{self.path}: link {link!r}: {error}") from None

    def _primitive(self, geometry: Any) -> tuple[Shape, float]:
        k, options = self.scale, self.shape_options
        if geometry.box is not None:
            return primitives.box(k * geometry.box.size, **options), 0.0
        if geometry.sphere is not None:
            return primitives.sphere(k * geometry.sphere.radius, self.error, **options)
        form = geometry.cylinder
        return primitives.cylinder(k * form.radius, k * form.length, self.error, **options)

    def _mesh(self, mesh: Any, link: str) -> Shape:
        """The shape of a mesh file, scaled, mirrored for a negative scale; cached."""
        try:
            file = find_mesh(mesh.filename, self.path, self.packages)
        except FileNotFoundError as error:
            raise FileNotFoundError(f"{self.path}: link {link!r}: {error}") from None
        scale = np.broadcast_to(1.0 if mesh.scale is None else mesh.scale, 3).astype(float)
        key = (file, *scale)
        if key not in self.meshes:
            if not (np.isfinite(scale) & (scale != 0)).all():
                raise ValueError(
                    f"{self.path}: link {link!r}: mesh scale: got {mesh.scale}, expected"
                    " numbers but 0"
                )
            mesh_data = read_mesh_file(file, self.scale)
            faces = mesh_data.faces[:, ::-1] if np.prod(scale) < 0 else mesh_data.faces
            vertices = mesh_data.vertices * scale  # in meters
            try:
                self.meshes[key] = Shape(vertices, faces, name=file.stem, **self.shape_options)
            except ValueError as error:
                raise ValueError(f"{self.path}: link {link!r}: {file}: {error}") from None
        return self.meshes[key]


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

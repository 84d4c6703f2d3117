"""Robots from SDF, the format of Gazebo: a model with links and joints in one file.

Poses are resolved through frames, `relative_to`, `attached_to` and `expressed_in`, as SDFormat 1.4
to 1.12 define them. fgenv checks collisions between all links that no joint connects, also where
`self_collide` is false, its default: only `collide_bitmask` allows links to touch.
"""

from __future__ import annotations

import functools
import itertools
import operator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision.mesh_files.xml_tree import Element

from .documents import MAX_LINKS, fail
from .links_joints import Joint, Link
from .mesh_location import PackagePaths
from .mesh_shapes import MeshShapes
from .robot_file import RobotFile
from .sdf_document import SdfDocument, sdf_document
from .sdf_frames import WORLD, Frames, inverse
from .sdf_geometry import SdfGeometry
from .sdf_joints import SdfJoints
from .topology import in_order


def read_sdf(
    path: Path,
    packages: PackagePaths,
    *,
    collision: bool,
    scale: float,
    error: float,
    shape_options: dict[str, Any],
) -> RobotFile:
    """Read the robot of an SDF file with one model.

    A model without a joint to the world has a free base; a static one does not move at all.

    Args:
        packages: folders in which `model://` and `package://` are searched first.
        collision: True: use collision geometry; False: visual geometry.
        scale: factor of all lengths.
        error: meters by which the mesh of a round shape, which encloses it, may exceed it.
        shape_options: of Shape.

    Raises:
        FileNotFoundError: the file, or a mesh in it, with the places searched.
        ValueError: invalid content, or unsupported content: several models, nested or included
            models, planes, height maps, ball, screw and gearbox joints. Names file and line.
    """
    notes: list[str] = []
    document = sdf_document(path, notes)
    frames = Frames(document, scale)
    meshes = MeshShapes(path, packages, scale, shape_options)
    geometry = SdfGeometry(document, frames, meshes, collision, error, shape_options)
    return _Reader(document, frames, geometry).read()


class JointEnds(NamedTuple):
    """A joint and the links that it connects."""

    joint: Element
    parent: str
    child: str
    in_world: bool


@dataclass
class _Reader:
    """Links and joints of a model."""

    document: SdfDocument
    frames: Frames
    geometry: SdfGeometry

    def read(self) -> RobotFile:
        """Return the robot."""
        document, model = self.document, self.document.model
        count = len(model.all("link"))
        if not 1 <= count <= MAX_LINKS:
            fail(document.path, model, f"got {count} links", f"1 to {MAX_LINKS}")
        links, allowed = self._links()
        static = document.flag(model, "static")
        joints = SdfJoints(document, self.frames, static, self._model_pose())
        base, place = self._connect(joints, static)
        links += joints.links
        self._note(static)
        try:
            in_order(links, joints.joints)
        except ValueError as error:
            raise ValueError(f"path: {document.path}: {error}") from None
        name = document.named(model)
        mount = place if base == "fixed" else np.eye(4)
        unused = "visual" if self.geometry.collision else "collision"
        other = any(element.all(unused) for element in model.all("link"))
        parts = name, links, joints.joints, base, mount, place, allowed, document.notes
        return RobotFile(*parts, other_geometry=other)

    def _links(self) -> tuple[list[Link], list[tuple[str, str]]]:
        """Links with shapes, and pairs of links with no bit in common."""
        links: list[Link] = []
        masks: dict[str, int] = {}
        for element in self.document.model.all("link"):
            self.document.check(element)
            shapes = self.geometry.of(element)
            name = self.document.named(element)
            links.append(Link(name, shapes.shapes))
            if shapes.masks:
                masks[name] = functools.reduce(operator.or_, shapes.masks)
        allowed = [(a, b) for a, b in itertools.combinations(masks, 2) if not masks[a] & masks[b]]
        return links, allowed

    def _model_pose(self) -> Floats:
        """The pose of the model's frame in the world."""
        model = self.document.model
        base, pose = self.frames.relative(model, WORLD)
        if base != WORLD:
            fail(self.document.path, model, "pose: got relative_to=", "a pose in the world")
        placement = model.get("placement_frame")
        return pose @ inverse(self.frames.pose(placement, model)) if placement else pose

    def _connect(self, joints: SdfJoints, static: bool) -> tuple[str, Floats]:
        """Add the joints; return the base and the root's place in the world.

        A model that more than one fixed joint holds in the world gets a link for the world.
        """
        document, ends = self.document, self._ends()
        children = {end.child for end in ends if not end.in_world}
        names = [document.named(link) for link in document.model.all("link")]
        roots = [name for name in names if name not in children]
        to_world = [end for end in ends if end.in_world]
        fixed = static or [end.joint.get("type") for end in to_world] == ["fixed"]
        alone = len(roots) == 1 and (fixed or not to_world)
        for end in ends:
            if not (end.in_world and alone):
                joints.add(end.joint, end.parent, end.child, end.in_world)
        poses = [joints.model_pose @ self.frames.pose(root, document.model) for root in roots]
        if alone:
            return "fixed" if fixed else "free", poses[0]
        if not (to_world or static):
            return "free", np.eye(4)
        joints.links.append(Link(WORLD))
        held = {end.child for end in to_world}
        for root, pose in zip(roots, poses, strict=True):
            if static and root not in held:
                joints.joints.append(Joint(f"{WORLD}@{root}", "fixed", WORLD, root, pose))
        return "fixed", np.eye(4)

    def _ends(self) -> list[JointEnds]:
        """Joints with the links that they connect."""
        ends = []
        for joint in self.document.model.all("joint"):
            self.document.check(joint)
            name = self.document.text(joint, "parent")
            in_world = name == WORLD and WORLD not in self.frames.frames
            parent = WORLD if in_world else self.frames.link(name, joint)
            child = self.frames.link(self.document.text(joint, "child"), joint)
            ends.append(JointEnds(joint, parent, child, in_world))
        return ends

    def _note(self, static: bool) -> None:
        document, model = self.document, self.document.model
        if static and any(joint.get("type") != "fixed" for joint in model.all("joint")):
            document.note("The model is static; its joints do not move.")
        if not document.flag(model, "self_collide"):
            document.note("self_collide is not set; collisions between links are checked anyway.")

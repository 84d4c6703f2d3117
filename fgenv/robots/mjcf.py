"""Robots from MJCF, compiled by MuJoCo: defaults, includes, frames, units, attached models.

A body is a link, with the body's frame. A body with several joints, or a joint away from the body's
origin, adds links without shapes. Coordinates are MuJoCo's: `ref` and equality constraints that
couple two joints linearly are applied. MJCF has no limits of speed.

Meshes are used as they are, while MuJoCo collides their convex hulls; their vertices have MuJoCo's
single precision. Poses come from MuJoCo; their last bits may differ between machines.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats

from .documents import MAX_LINKS
from .links_joints import Joint, Link
from .mjcf_couplings import joint_couplings, tendon_bodies
from .mjcf_geometry import Geometry, excluded_bodies, pose, unmatched_bodies
from .mjcf_joints import JointReader, body_joints, joint_kinds, translation
from .mjcf_model import compiled_model, model_name
from .mjcf_tree import Names, body_subtree, listed, robot_root
from .robot_file import RobotFile

WORLD = "world"  # root link, if joints move the robot's first body


def read_mjcf(
    path: Path,
    *,
    collision: bool,
    scale: float,
    error: float,
    shape_options: dict[str, Any],
    root: str | None = None,
) -> RobotFile:
    """Read the robot of an MJCF file; needs mujoco: `pip install 'fgenv[mjcf]'`.

    The robot is the tree of bodies that has joints; bodies and geoms at rest are the scene, and
    single free bodies beside a robot are objects. Pairs of links may touch if <exclude> names
    them, or if their contype and conaffinity rule out contact.

    Args:
        collision: True: use geoms that may collide; False: geoms of groups 0 to 2, which MuJoCo
            shows.
        scale: factor of all lengths.
        error: meters by which the mesh of a round geom, which encloses it, may exceed it.
        shape_options: of Shape.
        root: name of the first body of the robot, if the file has several trees with joints.

    Raises:
        FileNotFoundError: the file, or a file that it refers to, does not exist.
        ModuleNotFoundError: mujoco is not installed.
        ValueError: invalid content, several robots, or what a robot cannot have: ball joints,
            planes, deformable bodies, other constraints. Names the file and the element.
    """
    notes: list[str] = []
    model = compiled_model(path, collision, notes)
    try:
        first = robot_root(model, root, notes)
        geometry = Geometry(model, collision, scale, error, shape_options)
        return _Reader(model, path, geometry, first, notes).read()
    except ValueError as fault:
        raise ValueError(f"path: {path}: {fault}") from None


@dataclass
class _Reader:
    """Links and joints of one tree of bodies."""

    model: Any
    path: Path
    geometry: Geometry
    first: int  # body
    notes: list[str]
    links: list[Link] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.names = Names(self.model)
        self.bodies = body_subtree(self.model, self.first)
        if len(self.bodies) > MAX_LINKS:
            raise ValueError(
                f"worldbody: got {len(self.bodies)} bodies, expected {MAX_LINKS} at most"
            )
        self.scale = self.geometry.scale
        couplings = joint_couplings(self.model, set(self.bodies), self.notes)
        self.joint_reader = JointReader(self.model, self.names, self.scale, couplings, self.notes)

    def read(self) -> RobotFile:
        """Return the robot."""
        chosen = self.geometry.chosen()
        kinds = joint_kinds(self.model, self.first)
        base, place = "free" if kinds == ["free"] else "fixed", np.eye(4)
        root = self.names.bodies[self.first]
        if kinds in ([], ["free"]):
            self.links.append(Link(root, self.geometry.shapes(self.first, chosen)))
            place = self._pose(self.first)
        else:
            self.links.append(Link(self.names.unused_body(WORLD)))
            self._add_body(self.first, self.links[0].name, chosen)
        for body in self.bodies[1:]:
            parent = self.names.bodies[int(self.model.body_parentid[body])]
            self._add_body(body, parent, chosen)
        self._note_rest()
        name, allowed = model_name(self.model, self.path), self._allowed(chosen)
        mount = place if base == "fixed" else np.eye(4)
        parts = name, self.links, self.joints, base, mount, place, allowed, self.notes
        return RobotFile(*parts, other_geometry=not chosen.all())

    def _pose(self, body: int) -> Floats:
        return pose(self.scale * self.model.body_pos[body], self.model.body_quat[body])

    def _add_body(self, body: int, parent: str, chosen: NDArray[np.bool_]) -> None:
        """Add a body's link, its joints, and links between them.

        A hinge turns about an anchor. Joint frames have their origins there; the translation back
        is part of the next joint's origin.
        """
        name, origin = self.names.bodies[body], self._pose(body)
        joints = body_joints(self.model, body)
        for joint, kind in zip(joints, joint_kinds(self.model, body), strict=True):
            anchor = self.scale * np.asarray(self.model.jnt_pos[joint])
            if kind == "slide":
                anchor = np.zeros(3)
            last = joint == joints[-1] and not anchor.any()
            label = self.names.joints[joint]
            child = name if last else self.names.unused_body(f"{name}@{label}")
            at = origin @ translation(anchor)
            self.joints.append(self.joint_reader.joint(joint, parent, child, at))
            self._add_link(child, body, chosen, last)
            parent, origin = child, translation(-anchor)
        if parent != name:
            fixed = self.names.unused_joint(name)
            self.joints.append(Joint(fixed, "fixed", parent, name, origin))
            self._add_link(name, body, chosen, True)

    def _add_link(self, name: str, body: int, chosen: NDArray[np.bool_], shaped: bool) -> None:
        self.links.append(Link(name, self.geometry.shapes(body, chosen) if shaped else ()))

    def _allowed(self, chosen: NDArray[np.bool_]) -> list[tuple[str, str]]:
        """Pairs of links that may touch, as the file says."""
        pairs = excluded_bodies(self.model)
        if self.geometry.collision:
            pairs |= unmatched_bodies(self.model, chosen, self.bodies)
        inside, names = set(self.bodies), self.names.bodies
        return [(names[a], names[b]) for a, b in sorted(pairs) if a in inside and b in inside]

    def _note_rest(self) -> None:
        """Note what the file has for simulation and the robot has not."""
        inside = set(self.bodies)
        limited = [
            self.model.tendon(i).name or str(i)
            for i in np.flatnonzero(self.model.tendon_limited)
            if inside.intersection(tendon_bodies(self.model, int(i)))
        ]
        if limited:
            self.notes.append(f"Limits of tendons are left out: {listed(limited)}.")
        if self.model.nu:
            self.notes.append(f"Actuators are left out: {self.model.nu}.")

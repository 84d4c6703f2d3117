"""Joints of SDF models."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.collision.mesh_files.xml_tree import Element

from .documents import fail
from .links_joints import MAX_VALUE, Joint, Link, Mimic
from .sdf_document import SdfDocument
from .sdf_frames import MODEL, Frames, inverse

KINDS = ("continuous", "fixed", "prismatic", "revolute", "revolute2", "universal")
TWO_AXES = ("revolute2", "universal")
NO_LIMIT = 1e16  # in files of older versions
AT_ORIGIN = 1e-12  # meters


@dataclass
class SdfJoints:
    """Joints of a model, and links between them.

    A joint away from its child's origin, and one with two axes, add links without shapes. The
    second axis of a joint has the coordinate `JOINT@axis2`.

    Attributes:
        frozen: all joints are fixed, as in a static model.
        model_pose: (4, 4), of the model in the world.
    """

    document: SdfDocument
    frames: Frames
    frozen: bool
    model_pose: Floats
    links: list[Link] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)

    def add(self, element: Element, parent: str, child: str, in_world: bool) -> None:
        """Add a joint between two links.

        Args:
            in_world: the parent is the world.
        """
        name, kind = self.document.named(element), self._kind(element)
        at = self.frames.pose(child, element)
        if in_world:
            origin = self.model_pose @ at
        else:
            origin = inverse(self.frames.pose(parent, element)) @ at
        if self.frozen or kind == "fixed":
            self.joints.append(Joint(name, "fixed", parent, child, origin))
            return
        anchor = (inverse(at) @ self.frames.pose(name, element))[:3, 3]
        if kind == "prismatic" or np.abs(anchor).max() <= AT_ORIGIN:
            anchor = np.zeros(3)
        tags = ("axis", "axis2") if kind in TWO_AXES else ("axis",)
        origin = origin @ _moved(anchor)
        for tag in tags:
            last = tag == tags[-1] and not anchor.any()
            label = name if tag == "axis" else f"{name}@{tag}"
            end = child if last else f"{child}@{label}"
            self._add_axis(element, tag, label, (parent, end, child), origin)
            parent, origin = end, np.eye(4)
        if parent != child:
            fixed = Joint(f"{name}@frame", "fixed", parent, child, _moved(-anchor))
            self.joints.append(fixed)

    def _kind(self, element: Element) -> str:
        kind = element.get("type")
        if kind not in KINDS:
            expected = f"one of {', '.join(KINDS)}"
            if kind == "ball":
                expected += "; replace it by three revolute joints"
            fail(self.document.path, element, f"type: got {kind[:20]!r}", expected)
        return kind

    def _add_axis(
        self, element: Element, tag: str, label: str, ends: tuple[str, str, str], origin: Floats
    ) -> None:
        """Add the joint of an axis, and the link that it ends in unless that is the child.

        Args:
            ends: the links before and after, and the child of the element.
        """
        parent, end, child = ends
        axis = element.first(tag)
        if axis is None:
            fail(self.document.path, element, f"got no {tag}", f"<{tag}>")
        self.document.check(axis)
        slides = element.get("type") == "prismatic"
        length = self.frames.scale if slides else 1.0
        low, high, velocity = self._limits(element, axis, length)
        if element.get("type") == "continuous":
            low, high = -math.inf, math.inf
        kind = "prismatic" if slides else "revolute"
        if not slides and math.isinf(low) and math.isinf(high):
            kind = "continuous"
        direction, mimic = self._direction(axis, element, child), self._mimic(axis, length)
        if end != child:
            self.links.append(Link(end))
        self.joints.append(
            Joint(label, kind, parent, end, origin, direction, low, high, velocity, mimic=mimic)
        )

    def _direction(self, axis: Element, joint: Element, child: str) -> NDArray[np.float64]:
        """An axis in the frame of the joint's child."""
        xyz = axis.first("xyz")
        values = [0.0, 0.0, 1.0]
        if xyz is not None:
            values = self.document.numbers(xyz, xyz.text, (3,))
        if not any(values):
            fail(self.document.path, axis, "xyz: got 0 0 0", "a direction")
        frame = "" if xyz is None else xyz.get("expressed_in")
        if self.document.version < (1, 5) or self.document.flag(axis, "use_parent_model_frame"):
            frame = MODEL
        turn = self.frames.pose(frame or self.document.named(joint), axis)[:3, :3]
        direction: NDArray[np.float64] = (
            self.frames.pose(child, axis)[:3, :3].T @ turn @ np.array(values)
        )
        return direction

    def _limits(self, element: Element, axis: Element, length: float) -> tuple[float, float, float]:
        """Limits of an axis and of its speed."""
        limit = axis.first("limit")
        if limit is None:
            return -math.inf, math.inf, math.inf
        self.document.check(limit)
        ends = [self.document.number(limit, "lower", -math.inf)]
        ends.append(self.document.number(limit, "upper", math.inf))
        for end in ends:
            if MAX_VALUE < abs(end) < NO_LIMIT:
                name = self.document.named(element)
                self.document.note(
                    f"The joint {name!r} has limits over {MAX_VALUE:g}; it is unbounded there."
                )
        low, high = (x if abs(x) <= MAX_VALUE else math.copysign(math.inf, x) for x in ends)
        if low > high:
            fail(self.document.path, limit, f"got lower {low:g} over upper {high:g}", "no more")
        speed = self.document.number(limit, "velocity", math.inf)
        return length * low, length * high, length * speed if speed > 0 else math.inf

    def _mimic(self, axis: Element, length: float) -> Mimic | None:
        element = axis.first("mimic")
        if element is None:
            return None
        self.document.check(element)
        leader, which = element.get("joint"), element.get("axis") or "axis"
        source = self.frames.elements.get(leader)
        if source is None or source.tag != "joint":
            fail(self.document.path, element, f"joint: got {leader[:60]!r}", "a joint")
        if which not in ("axis", "axis2") or source.first(which) is None:
            fail(self.document.path, element, f"axis: got {which[:20]!r}", f"an axis of {leader!r}")
        factor = self.document.number(element, "multiplier", 1.0)
        offset = self.document.number(element, "offset", 0.0)
        offset -= factor * self.document.number(element, "reference", 0.0)
        per = self.frames.scale if source.get("type") == "prismatic" else 1.0
        name = leader if which == "axis" else f"{leader}@{which}"
        return Mimic(name, factor * length / per, length * offset)


def _moved(offset: NDArray[np.float64]) -> Floats:
    pose = np.eye(4)
    pose[:3, 3] = offset
    return pose

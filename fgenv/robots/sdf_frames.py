"""Frames of SDF models: poses relative to other frames, and links that frames are attached to."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision.mesh_files.xml_tree import Element

from .documents import fail
from .sdf_document import SdfDocument, unique
from .urdf import rotation, rotation_of_quaternion

MODEL = "__model__"
WORLD = "world"
MAX_FRAMES = 10_000


class Frame(NamedTuple):
    """A link, joint or frame, with the frame that its pose is relative to by default."""

    element: Element
    attached_to: str  # "" for a link
    default: str


class Frames:
    """Frames of a model.

    Args:
        document: its model.
        scale: factor of lengths.
    """

    def __init__(self, document: SdfDocument, scale: float) -> None:
        self.document, self.scale = document, scale
        self.frames: dict[str, Frame] = {}
        self.elements: dict[str, Element] = {}
        self.poses: dict[str, Floats] = {MODEL: np.eye(4)}
        elements = document.model.all("link", "joint", "frame")
        if len(elements) > MAX_FRAMES:
            fail(document.path, document.model, f"got {len(elements)} frames", f"{MAX_FRAMES}")
        for element in elements:
            name = unique(document, self.elements, element)
            self.elements[name] = element
            self.frames[name] = self._frame(element)

    def _frame(self, element: Element) -> Frame:
        if element.tag == "link":
            return Frame(element, "", MODEL)
        if element.tag == "joint":
            child = self.document.text(element, "child")
            return Frame(element, child, child)
        self.document.check(element)
        attached = element.get("attached_to") or MODEL
        return Frame(element, attached, attached)

    def pose(self, name: str, source: Element) -> Floats:
        """The pose (4, 4) of a frame in the model's, meters.

        Args:
            source: the element that names the frame, for messages.
        """
        chain: dict[str, Floats] = {}
        while name not in self.poses:
            frame = self._known(name, source)
            if name in chain:
                fail(self.document.path, source, f"got a loop of poses at {name!r}", "a tree")
            base, pose = self.relative(frame.element, frame.default)
            chain[name] = pose
            name, source = base, frame.element
        for inner, pose in reversed(chain.items()):
            self.poses[inner] = self.poses[name] @ pose
            name = inner
        return self.poses[name]

    def placed(self, element: Element, default: str) -> Floats:
        """The pose (4, 4) of an element with a <pose>, in the model's frame."""
        base, pose = self.relative(element, default)
        return self.pose(base, element) @ pose

    def link(self, name: str, source: Element) -> str:
        """The link that a frame is attached to."""
        seen = set()
        while True:
            if name == MODEL:
                links = self.document.model.all("link")
                name = self.document.model.get("canonical_link") or links[0].get("name")
            frame = self._known(name, source)
            if not frame.attached_to:
                return name
            if name in seen:
                fail(self.document.path, source, f"got a loop of frames at {name!r}", "a tree")
            seen.add(name)
            name, source = frame.attached_to, frame.element

    def _known(self, name: str, source: Element) -> Frame:
        if name not in self.frames:
            nested = "; nested models are not read" if "::" in name else ""
            received = f"got the frame {name[:60]!r}"
            fail(self.document.path, source, received, f"a link, joint or frame{nested}")
        return self.frames[name]

    def relative(self, element: Element, default: str) -> tuple[str, Floats]:
        """The frame that an element's <pose> is relative to, and the pose in it, meters."""
        text = element.first("pose")
        if text is None:
            return default, np.eye(4)
        if text.get("frame"):
            fail(self.document.path, text, "got frame=", "relative_to=, in version 1.7 or later")
        return text.get("relative_to") or default, self._parsed(text)

    def _parsed(self, element: Element) -> Floats:
        style = element.get("rotation_format") or "euler_rpy"
        degrees = self.document.boolean(element, element.get("degrees"))
        if style not in ("euler_rpy", "quat_xyzw"):
            received = f"rotation_format: got {style[:20]!r}"
            fail(self.document.path, element, received, "euler_rpy or quat_xyzw")
        if not element.text.strip():
            return np.eye(4)
        count = 6 if style == "euler_rpy" else 7
        xyz_turn = self.document.numbers(element, element.text, (count,))
        pose, turn = np.eye(4), xyz_turn[3:]
        if style == "euler_rpy":
            pose = rotation([math.radians(x) for x in turn] if degrees else turn)
        else:
            length = math.sqrt(sum(x * x for x in turn))
            if degrees or abs(length - 1) > 1e-3:
                received = "got degrees" if degrees else f"got a quaternion of length {length:g}"
                fail(self.document.path, element, received, "a quaternion of length 1")
            x, y, z, w = (c / length for c in turn)
            pose[:3, :3] = rotation_of_quaternion(x, y, z, w)
        pose[:3, 3] = [self.scale * x for x in xyz_turn[:3]]
        return pose


def inverse(pose: Floats) -> Floats:
    """The inverse of a pose (4, 4)."""
    turned = np.eye(4)
    turned[:3, :3] = pose[:3, :3].T
    turned[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return turned

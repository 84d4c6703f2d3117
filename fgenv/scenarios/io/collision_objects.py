"""Collision objects of a planning scene: the operations ADD, REMOVE, APPEND and MOVE of MoveIt."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NoReturn

import numpy as np

from fgenv.arrays import Floats
from fgenv.scenarios.errors import near, short
from fgenv.scenarios.shapes.bodies import AnyForm

from .ros import pose_of
from .solids import mesh, plane, primitive
from .yaml_node import Node

WORLD = ("", "world")  # frames that are the world's
ADD, REMOVE, APPEND, MOVE = OPERATIONS = ("ADD", "REMOVE", "APPEND", "MOVE")  # 0, 1, 2, 3
Parts = list[tuple[AnyForm, Floats]]  # forms, and their poses (4, 4)


@dataclass
class CollisionObject:
    """An object of a scene.

    Attributes:
        pose: (4, 4), in the world.
        parts: forms, and their poses in the object.
        subframes: poses in the object by name.
        place: of the id, for messages.
    """

    pose: Floats
    parts: Parts
    subframes: dict[str, Floats]
    place: Node


@dataclass
class SceneObjects:
    """The objects of a scene by id, changed by messages one after another.

    Attributes:
        frames: poses (4, 4) in the world of other frames by name, such as links of a robot.
    """

    frames: Mapping[str, Floats] = field(default_factory=dict)
    by_id: dict[str, CollisionObject] = field(default_factory=dict)

    def apply(self, message: Node) -> None:
        """Apply a moveit_msgs/CollisionObject.

        ADD replaces an object of the same id, APPEND adds shapes to it, MOVE sets its pose, REMOVE
        removes it, or all objects if the id is empty.
        """
        operation = operation_of(message)
        if operation == REMOVE:
            self._remove(message)
        elif operation == MOVE:
            self._move(message)
        else:
            self._add(message, operation)

    def _add(self, message: Node, operation: str) -> None:
        pose, parts = geometry(message)
        frame = self.frame(message)
        name = message.get("id").text()
        old = self.by_id.get(name)
        if old is not None and message.find("operation") is None:
            message.get("id").fail(
                f"{name!r} names two objects", "rename one, or write its operation"
            )
        frames = subframes(message)
        if old is None or operation == ADD:
            self.by_id.pop(name, None)
            self.by_id[name] = CollisionObject(frame @ pose, parts, frames, message.get("id"))
            return
        shift = inverse(old.pose) @ frame @ pose
        old.parts += [(form, shift @ at) for form, at in parts]
        old.subframes = frames

    def _move(self, message: Node) -> None:
        _without_shapes(message, MOVE)
        self._known(message).pose = self.frame(message) @ pose_of(message.find("pose"))

    def _remove(self, message: Node) -> None:
        _without_shapes(message, REMOVE)
        label = message.find("id")
        if label is None or label.value == "":
            self.by_id.clear()
        else:
            self._known(message)
            del self.by_id[label.text()]

    def _known(self, message: Node) -> CollisionObject:
        name = message.get("id").text()
        if name not in self.by_id:
            message.get("id").fail(f"{name!r} names no object", near(name, self.by_id))
        return self.by_id[name]

    def frame(self, message: Node) -> Floats:
        """The pose in the world of the frame in a message's header."""
        place = message.find("header", "frame_id")
        name = "" if place is None else str(place.value).removeprefix("/")
        if name in WORLD:
            return np.eye(4)
        if name in self.frames:
            return self.frames[name]
        if name in self.by_id:
            return self.by_id[name].pose
        owner, _, subframe = name.partition("/")
        if owner in self.by_id and subframe in self.by_id[owner].subframes:
            return self.by_id[owner].pose @ self.by_id[owner].subframes[subframe]
        return self._unknown_frame(message.get("header", "frame_id"), name)

    def _unknown_frame(self, place: Node, name: str) -> NoReturn:
        remedy = near(name, ["world", *self.frames, *self.by_id])
        if not self.frames:
            remedy += " (links are known with a robot: load_scene(..., robot=...), load_problem)"
        place.fail(f"is {short(name)}, which is no known frame", remedy)


def operation_of(message: Node) -> str:
    """The operation of a message: its name, its number, or a byte with it; ADD if it is missing."""
    place = message.find("operation")
    if place is None:
        return ADD
    value = place.value
    if isinstance(value, str):
        digit = ord(value) if len(value) == 1 and ord(value) < len(OPERATIONS) else None
        if value.isdecimal() and len(value) < 4:
            digit = int(value)
        name = value.upper().removeprefix("COLLISIONOBJECT.")
        value = name if digit is None else digit
    if isinstance(value, int) and 0 <= value < len(OPERATIONS):
        return OPERATIONS[value]
    if value not in OPERATIONS:
        place.fail(f"is {short(place.value)}", near(value, OPERATIONS))
    return str(value)


def geometry(message: Node) -> tuple[Floats, Parts]:
    """Pose of a message's object in its frame, and its shapes with their poses in the object.

    As in MoveIt, the pose of a lone shape is that of the object where the object has none.
    """
    pose, parts = pose_of(message.find("pose")), list(_parts(message))
    if not parts:
        message.fail("has no primitives, meshes or planes", "add one, or leave the object out")
    if len(parts) == 1 and (pose == np.eye(4)).all():
        return parts[0][1], [(parts[0][0], pose)]
    return pose, parts


def _parts(message: Node) -> Iterator[tuple[AnyForm, Floats]]:
    for key, of in (
        ("primitives", "primitive_poses"), ("meshes", "mesh_poses"), ("planes", "plane_poses")
    ):  # fmt: skip
        poses, items = list(message.items(of)), list(message.items(key))
        if len(poses) > len(items):
            message.get(of).fail(
                f"has {len(poses)} poses for {len(items)} {key}", "expected one for each"
            )
        for i, part in enumerate(items):
            if i >= len(poses) and (i or message.find("pose") is None):
                part.fail("has no pose", f"add one to {of}")
            pose = pose_of(poses[i] if i < len(poses) else None)
            if key == "planes":
                form, inside = plane(part)
                yield form, pose @ inside
            else:
                yield primitive(part) if key == "primitives" else mesh(part), pose


def subframes(message: Node) -> dict[str, Floats]:
    """Poses of a message's subframes by name, in the object."""
    names, poses = (list(message.items(f"subframe_{key}")) for key in ("names", "poses"))
    if len(names) != len(poses):
        message.fail(
            f"has {len(names)} subframe_names, {len(poses)} subframe_poses", "expected one for each"
        )
    return {name.text(): pose_of(pose) for name, pose in zip(names, poses, strict=True)}


def inverse(pose: Floats) -> Floats:
    """The inverse of a rigid transform (4, 4)."""
    result = np.eye(4)
    result[:3, :3] = pose[:3, :3].T
    result[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return result


def _without_shapes(message: Node, operation: str) -> None:
    for key in ("primitives", "meshes", "planes"):
        if (shapes := message.find(key)) is not None and shapes.value:
            shapes.fail(f"has shapes, which {operation} ignores", "remove them, or use ADD")

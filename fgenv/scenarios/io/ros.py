"""Messages of ROS as YAML shows them: poses and states of joints. Quaternions are x, y, z, w."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.scenarios.schema import Placement

from .yaml_node import Node

DECIMALS = 12  # of angles, so that all machines give the same bits


def pose_of(node: Node | None) -> Floats:
    """A geometry_msgs/Pose, (4, 4); missing numbers are 0."""
    pose = np.eye(4)
    if node is None:
        return pose
    if (turn := node.find("orientation")) is not None:
        pose[:3, :3] = turned(turn)
    if (at := node.find("position")) is not None:
        pose[:3, 3] = at.numbers("xyz")
    return pose


def transform_of(node: Node | None) -> Floats:
    """A geometry_msgs/Transform, (4, 4); missing numbers are 0."""
    pose = np.eye(4)
    if node is None:
        return pose
    if (turn := node.find("rotation")) is not None:
        pose[:3, :3] = turned(turn)
    if (at := node.find("translation")) is not None:
        pose[:3, 3] = at.numbers("xyz")
    return pose


def turned(node: Node) -> Floats:
    """The rotation (3, 3) of a quaternion; as in MoveIt, all zeros are no turn."""
    return rotation_of(node, node.numbers("xyzw"))


def rotation_of(node: Node, quaternion: Sequence[float]) -> Floats:
    """The rotation (3, 3) of a quaternion x, y, z, w; `node` is for messages."""
    x, y, z, w = quaternion
    size = x * x + y * y + z * z + w * w
    if size == 0.0:
        return np.eye(3)
    if abs(size - 1.0) > 0.1:
        node.fail(f"has length {math.sqrt(size):g}", "expected a quaternion of length 1")
    s = 2.0 / size
    return np.array([
        [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)],
    ])  # fmt: skip


def placement(pose: Floats) -> Placement:
    """The same pose in the schema's terms."""
    r = pose[:3, :3].tolist()
    level = math.hypot(r[0][0], r[1][0])
    pitch = math.atan2(-r[2][0], level)
    if level > 1e-9:
        roll, yaw = math.atan2(r[2][1], r[2][2]), math.atan2(r[1][0], r[0][0])
    else:  # x is upright: roll and yaw are one turn
        roll, yaw = math.atan2(-r[1][2], r[1][1]), 0.0
    x, y, z = (float(v) for v in pose[:3, 3])
    a, b, c = (round(angle, DECIMALS) + 0.0 for angle in (roll, pitch, yaw))
    return Placement(position=(x, y, z), rpy=(a, b, c))


def joints(state: Node | None) -> dict[str, float]:
    """Values of joints by name, of a sensor_msgs/JointState at rest."""
    if state is None:
        return {}
    names, values = list(state.items("name")), list(state.items("position"))
    if len(names) != len(values):
        state.fail(f"has {len(names)} names, {len(values)} positions", "expected one for each")
    if (speeds := state.find("velocity")) is not None and speeds.nonzero():
        speeds.fail("is not 0, which is not supported", "expected a start at rest")
    found: dict[str, float] = {}
    for name, value in zip(names, values, strict=True):
        if name.text() in found:
            name.fail(f"{name.text()!r} stands twice", "keep one")
        found[name.text()] = value.number()
    return found


def mounted(state: Node | None) -> Placement:
    """Where the start state puts the robot: the transform of its virtual joint."""
    transforms = [] if state is None else list(state.items("transforms"))
    if len(transforms) > 1:
        transforms[1].fail("is a second transform", "expected that of the virtual joint alone")
    return placement(transform_of(transforms[0])) if transforms else Placement()

"""Changes of a model's robot: locked joints and attached objects."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.robots import Joint, Link, LinkShape, Robot

from .errors import near
from .schema import Attachment


def with_locked_joints(robot: Robot, locked: Mapping[str, float]) -> Robot:
    """The robot with some joints fixed at values (rad, m), and the joints that mimic them.

    Raises:
        ValueError: a name that is no joint with a coordinate.
    """
    if not locked:
        return robot
    known = [joint.name for joint in robot.moving_joints]
    for name in locked:
        if name not in known:
            raise ValueError(
                f"locked: got {name!r}, expected a moving joint of {robot.name!r};"
                f" {near(name, known)}"
            )
    joints = []
    for joint in robot.joints:
        if joint.moves:
            source, multiplier, offset = robot.mimic_sources[joint.name]
            if source.name in locked:
                joint = _fixed(joint, multiplier * locked[source.name] + offset)
        joints.append(joint)
    return robot.replace(joints=tuple(joints))


def _fixed(joint: Joint, value: float) -> Joint:
    """The joint fixed at a value of its coordinate (rad or m)."""
    axis = joint.axis / np.sqrt(np.sum(joint.axis**2))
    motion = np.eye(4)
    if joint.kind == "prismatic":
        motion[:3, 3] = value * axis
    else:
        motion[:3, :3] = _rotation(axis, value)
    return Joint(joint.name, "fixed", joint.parent, joint.child, joint.origin @ motion)


def _rotation(axis: Floats, angle: float) -> Floats:
    """The rotation (3, 3) about a unit axis, by the formula of Rodrigues."""
    sine, cosine = (float(v) for v in _core.sin_cos(angle))
    x, y, z = axis.tolist()
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return cosine * np.eye(3) + sine * cross + (1.0 - cosine) * np.outer(axis, axis)


def with_attached(
    robot: Robot, attached: Iterable[Attachment], shapes: Mapping[str, Shape]
) -> Robot:
    """The robot with objects fixed to links; each becomes a link of its own.

    Raises:
        ValueError: a link or shape that does not exist, or a name that is taken.
    """
    links, joints = list(robot.links), list(robot.joints)
    allowed = list(robot.allowed)
    own = [link.name for link in links]
    for item in attached:
        for name in (item.link, *item.touch_links):
            if name not in own:
                raise ValueError(
                    f"attached: {item.name!r}: got {name!r}, expected a link of {robot.name!r};"
                    f" {near(name, own)}"
                )
        if item.shape not in shapes:
            raise ValueError(
                f"attached: {item.name!r}: got shape {item.shape!r}; {near(item.shape, shapes)}"
            )
        links.append(Link(item.name, LinkShape(shapes[item.shape])))
        joints.append(Joint(f"{item.name} joint", "fixed", item.link, item.name, item.pose))
        allowed += [(item.name, link) for link in item.touch_links]
    return replace(robot, links=tuple(links), joints=tuple(joints), allowed=tuple(allowed))

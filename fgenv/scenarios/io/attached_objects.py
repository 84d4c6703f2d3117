"""Objects that links of a robot carry: moveit_msgs/AttachedCollisionObject."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fgenv.arrays import Floats
from fgenv.scenarios.errors import near

from .collision_objects import (
    ADD,
    MOVE,
    REMOVE,
    CollisionObject,
    Parts,
    SceneObjects,
    geometry,
    inverse,
    operation_of,
    subframes,
)
from .yaml_node import Node


@dataclass
class AttachedObject:
    """An object on a link.

    Attributes:
        parts: forms, and their poses (4, 4) in the link.
        pose: (4, 4), of the object in the link.
        touch_links: other links that it may touch.
    """

    link: str
    pose: Floats
    parts: Parts
    subframes: dict[str, Floats]
    touch_links: tuple[str, ...]
    place: Node


def apply_attached(
    message: Node,
    objects: SceneObjects,
    attached: dict[str, AttachedObject],
    links: Mapping[str, Floats],
) -> None:
    """Apply an AttachedCollisionObject as MoveIt does.

    ADD attaches an object, which leaves the world; without shapes it is the object of that id in
    the world. APPEND adds shapes. REMOVE puts the object back into the world.

    Args:
        objects: of the world; changed.
        attached: by id; changed.
        links: poses (4, 4) of the robot's links in the world.
    """
    body = message.get("object")
    operation = operation_of(body)
    if operation == MOVE:
        body.get("operation").fail("is MOVE, which attached objects do not have", "use ADD")
    if operation == REMOVE:
        _detach(message, objects, attached, links)
        return
    name, link = body.get("id").text(), _link(message.get("link_name"), links)
    if operation == ADD and not any(next(body.items(k), None) for k in SHAPES):
        if name not in objects.by_id:
            body.fail(f"has no shapes, and no object is named {name!r}", near(name, objects.by_id))
        old = objects.by_id[name]
        pose, parts, frames = old.pose, old.parts, old.subframes
    else:
        own, parts = geometry(body)
        pose, frames = objects.frame(body) @ own, subframes(body)
    objects.by_id.pop(name, None)
    pose = inverse(links[link]) @ pose
    touch = tuple(_link(item, links) for item in message.items("touch_links"))
    made = AttachedObject(link, pose, [(f, pose @ at) for f, at in parts], frames, touch, body)
    before = attached.get(name)
    if operation != ADD and before is not None:
        if before.link != link:
            message.get("link_name").fail(f"is {link!r}", f"{name!r} is on {before.link!r}")
        made.parts = before.parts + made.parts
        made.touch_links = tuple(dict.fromkeys((*before.touch_links, *touch)))
        made.subframes = {**before.subframes, **frames}
    attached[name] = made


SHAPES = ("primitives", "meshes", "planes")


def _link(place: Node, links: Mapping[str, Floats]) -> str:
    name = place.text()
    if name not in links:
        place.fail(f"{name!r} is no link of the robot", near(name, links))
    return name


def _detach(
    message: Node,
    objects: SceneObjects,
    attached: dict[str, AttachedObject],
    links: Mapping[str, Floats],
) -> None:
    """Put one attached object, or all of a link or of the robot, back into the world."""
    body, place = message.get("object"), message.find("link_name")
    label = body.find("id")
    on = "" if place is None or place.value == "" else _link(place, links)
    names = [name for name, item in attached.items() if on in ("", item.link)]
    if label is not None and label.value != "":
        name = label.text()
        if name not in names:
            label.fail(f"{name!r} names no attached object", near(name, names))
        names = [name]
    for name in names:
        item = attached.pop(name)
        if name in objects.by_id:
            body.fail(f"{name!r} is in the world as well", "rename one")
        back = inverse(item.pose)
        parts = [(form, back @ at) for form, at in item.parts]
        pose = links[item.link] @ item.pose
        objects.by_id[name] = CollisionObject(pose, parts, item.subframes, body)

"""Writer of URDF: a robot with its meshes beside it, and its allowed collisions as SRDF."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.robots import Joint, Link, Robot
from fgenv.saving import save_text

from .meshes import PlacedMesh, write_meshes

NOT_XML = re.compile("[^\\t\\n\\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_urdf(robot: Robot, path: str | Path) -> list[Path]:
    """Write a robot to a URDF file, its meshes as OBJ to the folder STEM_meshes beside it.

    STEM.srdf has the pairs of links that may touch. URDF has no place for the base, the mount, the
    workspace and the drive: give them to `Robot.load` again.

    Returns:
        The written files.

    Raises:
        ValueError: the path does not end in .urdf, a name has control characters, or a joint that
            URDF cannot hold: a limit on one side only, a prismatic joint without limits, a limit of
            acceleration.
        OSError: a file cannot be written.
    """
    path = Path(path)
    if path.suffix != ".urdf":
        raise ValueError(f"path: got {path}, expected a name that ends in .urdf")
    _check_names(robot)
    root = Element("robot", name=robot.name)
    joints = [_joint(joint) for joint in robot.joints]  # raises before anything is written
    folder = path.with_name(f"{path.stem}_meshes")
    files = _write_shapes(robot, folder)
    root.extend([_link(link, files) for link in robot.links])
    root.extend(joints)
    srdf = path.with_suffix(".srdf")
    _save(root, path)
    _save(_srdf(robot), srdf)
    return [path, srdf, *dict.fromkeys(folder / Path(name).name for name in files.values())]


def _check_names(robot: Robot) -> None:
    """Raise ValueError for a name with a character that XML cannot hold."""
    named: tuple[Robot | Link | Joint, ...] = (robot, *robot.links, *robot.joints)
    for item in named:
        if NOT_XML.search(item.name):
            kind = type(item).__name__.lower()
            raise ValueError(f"{kind}: got the name {item.name!r}, expected no control characters")


def _write_shapes(robot: Robot, folder: Path) -> dict[int, str]:
    """Write each shape once; return its path, relative to the URDF file, by `id`."""
    files: dict[int, str] = {}
    if robot.parts:
        folder.mkdir(exist_ok=True)
    for link in robot.links:
        for k, item in enumerate(link.shapes):
            if id(item.shape) in files:
                continue
            name = f"{len(files)}_{re.sub(r'[^A-Za-z0-9_.-]+', '_', link.name)}_{k}.obj"
            mesh = PlacedMesh(link.name, item.shape.vertices, item.shape.faces, np.eye(4))
            write_meshes([mesh], folder / name)
            files[id(item.shape)] = f"{folder.name}/{name}"
    return files


def _link(link: Link, files: dict[int, str]) -> Element:
    element = Element("link", name=link.name)
    for item in link.shapes:
        for tag in ("visual", "collision"):
            child = SubElement(element, tag)
            child.append(_origin(item.origin))
            geometry = SubElement(child, "geometry")
            SubElement(geometry, "mesh", filename=files[id(item.shape)])
    return element


def _joint(joint: Joint) -> Element:
    kind, limits = _kind_and_limits(joint)
    element = Element("joint", name=joint.name, type=kind)
    element.append(_origin(joint.origin))
    SubElement(element, "parent", link=joint.parent)
    SubElement(element, "child", link=joint.child)
    if joint.moves:
        SubElement(element, "axis", xyz=_numbers(joint.axis))
        velocity = joint.velocity if math.isfinite(joint.velocity) else 0.0  # 0: none
        SubElement(element, "limit", {**limits, "effort": "0", "velocity": repr(velocity)})
    if joint.mimic is not None:
        m = joint.mimic
        values = {"multiplier": repr(float(m.multiplier)), "offset": repr(float(m.offset))}
        SubElement(element, "mimic", {"joint": m.joint, **values})
    return element


def _kind_and_limits(joint: Joint) -> tuple[str, dict[str, str]]:
    """URDF's type of a joint, and its limits of position."""
    label = f"joint {joint.name!r}"
    if math.isfinite(joint.acceleration):
        raise ValueError(f"{label}: got a limit of acceleration, expected none: URDF has no place")
    if joint.kind in ("fixed", "continuous"):
        return joint.kind, {}
    bounded = math.isfinite(joint.lower), math.isfinite(joint.upper)
    if joint.kind == "revolute" and not any(bounded):
        return "continuous", {}
    if not all(bounded):
        raise ValueError(
            f"{label}: got limits {joint.lower:g} and {joint.upper:g}, expected finite ones: URDF"
            " has no others"
        )
    return joint.kind, {"lower": repr(float(joint.lower)), "upper": repr(float(joint.upper))}


def _origin(pose: Floats) -> Element:
    return Element("origin", xyz=_numbers(pose[:3, 3]), rpy=_numbers(roll_pitch_yaw(pose)))


def roll_pitch_yaw(pose: Floats) -> tuple[float, float, float]:
    """Angles about fixed x, y, z (rad) of a pose's rotation.

    The roll is that of the rotation without its yaw: where x is almost upright the yaw is poorly
    determined, and the roll makes up for it.
    """
    r = pose[:3, :3]
    yaw = _core.arc_tangent(float(r[1, 0]), float(r[0, 0]))
    sine, cosine = (float(x) for x in _core.sin_cos(yaw))
    pitch = _core.arc_tangent(-float(r[2, 0]), math.hypot(r[0, 0], r[1, 0]))
    y, z = cosine * r[1, 1:] - sine * r[0, 1:]  # row y of the rotation without its yaw
    return _core.arc_tangent(-float(z), float(y)), pitch, yaw


def _srdf(robot: Robot) -> Element:
    root = Element("robot", name=robot.name)
    for a, b in robot.allowed:
        SubElement(root, "disable_collisions", link1=a, link2=b, reason="allowed")
    return root


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(x) + 0.0) for x in values)


def _save(root: Element, path: Path) -> None:
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    save_text(
        path, f'<?xml version="1.0" encoding="utf-8"?>\n<!-- fgenv: meters, radians -->\n{text}\n'
    )

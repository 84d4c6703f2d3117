"""URDF documents: parsed, checked, and loaded by yourdfpy."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any, NoReturn

from .links_joints import JOINT_KINDS, number_of

GEOMETRIES = ("box", "cylinder", "sphere", "mesh")


def parsed_document(path: Path) -> Any:
    """Root element, without elements and attributes of unknown prefixes."""
    if not path.is_file():
        what = "is a folder" if path.is_dir() else "does not exist"
        raise FileNotFoundError(f"path: {path} {what}, expected a URDF file")
    if path.suffix == ".xacro":
        raise ValueError(f"path: {path} is a xacro file, expand it first: xacro FILE > robot.urdf")
    try:
        import yourdfpy  # noqa: F401
        from lxml import etree
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"to read URDF, {error.name} is needed; remedy: pip install 'fgenv[urdf]'",
            name=error.name,
        ) from None
    parser = etree.XMLParser(recover=True, remove_comments=True, resolve_entities=False)
    try:
        root = etree.parse(str(path), parser).getroot()
    except etree.XMLSyntaxError as error:  # nothing to recover
        raise ValueError(f"path: {path}: got {error.msg}, expected a URDF file") from None
    for fault in parser.error_log:
        if fault.domain_name != "NAMESPACE":
            raise ValueError(f"path: {path}: line {fault.line}: got {fault.message}, expected XML")
    if root is None or root.tag != "robot":
        came = "nothing" if root is None else f"<{root.tag}>"
        raise ValueError(f"path: {path}: got {came}, expected a URDF file: <robot>")
    for element in list(root.iter()):  # a name with a declared xmlns is {uri}name
        if isinstance(element.tag, str) and ":" in element.tag and "{" not in element.tag:
            element.getparent().remove(element)
        for key in [k for k in element.attrib if ":" in k and "{" not in k]:
            del element.attrib[key]
    return root


def check_document(document: Any, path: Path) -> None:
    """Raise ValueError, with the line, for content that a loader fails on or skips silently."""
    for element in (document, *document.findall("link"), *document.findall("joint")):
        if not element.get("name"):
            _fail(path, element, f"<{element.tag}>: got no name, expected name=")
    for origin in document.iter("origin"):
        numbers(origin, "rpy", path)
        numbers(origin, "xyz", path)
    for joint in document.findall("joint"):
        _check_joint(joint, path)
    for link in document.findall("link"):
        for item in (*link.findall("collision"), *link.findall("visual")):
            _check_geometry(link, item, path)


def _fail(path: Path, element: Any, text: str) -> NoReturn:
    raise ValueError(f"{path}: line {element.sourceline}: {text}")


def _check_joint(joint: Any, path: Path) -> None:
    name, kind = joint.get("name"), joint.get("type")
    if kind in ("floating", "planar"):
        base = "free" if kind == "floating" else "planar"
        _fail(path, joint, f"joint {name!r} is {kind}: begin at its child, with base={base!r}")
    if kind not in JOINT_KINDS:
        expected = ", ".join(JOINT_KINDS)
        _fail(path, joint, f"joint {name!r}: type: got {kind!r}, expected one of {expected}")
    for end in ("parent", "child"):
        if joint.find(end) is None or not joint.find(end).get("link"):
            _fail(path, joint, f"joint {name!r}: got no {end}, expected <{end} link=>")


def _check_geometry(link: Any, item: Any, path: Path) -> None:
    geometry, label = item.find("geometry"), f"link {link.get('name')!r}"
    inside = [] if geometry is None else [child.tag for child in geometry]
    if len(inside) != 1 or inside[0] not in GEOMETRIES:
        got, expected = ", ".join(map(str, inside)) or "nothing", ", ".join(GEOMETRIES)
        _fail(path, item, f"{label}: {item.tag} geometry: got {got}, expected one of {expected}")
    if inside == ["mesh"] and not geometry[0].get("filename"):
        _fail(path, item, f"{label}: got a mesh without filename, expected one")


def load_model(document: Any, path: Path) -> Any:
    """yourdfpy's model of a document."""
    import yourdfpy
    from lxml import etree

    text = io.BytesIO(etree.tostring(document))
    try:
        return yourdfpy.URDF.load(text, build_scene_graph=False, load_meshes=False).robot
    except Exception as error:  # yourdfpy raises whatever its parts raise
        raise ValueError(f"path: {path} cannot be read ({error}), expected a URDF file") from error


def numbers(element: Any, name: str, path: Path) -> list[float]:
    """Three numbers of an attribute; zeros without it."""
    text = element.get(name, "0 0 0")
    try:
        x, y, z = (number_of(float(word), name, finite=True) for word in text.split())
    except ValueError:
        where = f"{path}: line {element.sourceline}: origin: {name}"
        raise ValueError(f"{where}: got {text!r}, expected three numbers") from None
    return [x, y, z]

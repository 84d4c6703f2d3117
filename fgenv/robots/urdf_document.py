"""URDF documents: parsed, checked, and loaded by yourdfpy."""

from __future__ import annotations

import io
import math
import re
from pathlib import Path
from typing import Any, NoReturn

from fgenv.printable import printable
from fgenv.regular_file import read_regular

from .links_joints import JOINT_KINDS, number_of

MAX_BYTES = 64_000_000
DECLARATION = re.compile(rb"(<\?xml\s+version\s*=\s*)(['\"])([^'\"]*)\2")
PREFIX = re.compile(r"^(\{[^}]*\}|[^:{]*:)")
GEOMETRIES = ("box", "cylinder", "sphere", "mesh")
# Numbers of elements of a joint.
JOINT_NUMBERS = {
    "limit": ("lower", "upper", "velocity"),
    "mimic": ("multiplier", "offset"),
    "safety_controller": ("soft_lower_limit", "soft_upper_limit"),
}
UNUSED = ("inertial", "dynamics", "calibration")  # removed: faults in them do not matter
# Attributes of each geometry, and how many numbers they may have.
SIZES: dict[str, dict[str, tuple[int, ...]]] = {
    "box": {"size": (3,)},
    "cylinder": {"radius": (1,), "length": (1,)},
    "sphere": {"radius": (1,)},
    "mesh": {"scale": (3, 1)},
}


def parsed_document(
    path: Path,
    notes: list[str],
    kind: str = "a URDF file",
    text: bytes | None = None,
) -> Any:
    """Root element, without elements and attributes of foreign prefixes.

    Args:
        notes: receives sentences on what the file has and the robot does not, or has otherwise.
        kind: `a URDF file` or the like, for messages.
        text: None: the content of the file.

    Raises:
        FileNotFoundError, ModuleNotFoundError: no such file; yourdfpy is not installed.
        ValueError: no regular file, one that is too large, no XML, or another root element.
    """
    try:
        import yourdfpy  # noqa: F401
        from lxml import etree
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"to read URDF, {error.name} is needed; remedy: pip install 'fgenv[urdf]'",
            name=error.name,
        ) from None
    if text is None:
        text = read_regular(path, kind, MAX_BYTES)
    if text[:1].isspace():
        notes.append("The XML does not begin in the first line, at its first character.")
        text = text.lstrip()
    declared = DECLARATION.match(text)
    if declared and declared[3] != b"1.0":  # PyBullet's data have version 0.0
        version = declared[3].decode(errors="replace")
        notes.append(f"The XML declares version {version}; it is read as version 1.0.")
        text = declared[1] + b'"1.0"' + text[declared.end() :]
    parser = etree.XMLParser(recover=True, remove_comments=True, resolve_entities=False)
    try:
        root = etree.fromstring(text, parser)
    except etree.XMLSyntaxError as error:  # nothing to recover
        reason = printable(error.msg.strip())
        raise ValueError(f"path: {path}: got {reason}, expected {kind}") from None
    if root is not None and root.getroottree().docinfo.doctype:
        raise ValueError(f"path: {path}: got a document type, expected XML without; remove it")
    for fault in parser.error_log:
        if fault.domain_name != "NAMESPACE":
            reason = printable(fault.message.strip())
            raise ValueError(f"path: {path}: line {fault.line}: got {reason}, expected XML")
    if root is not None and (default := root.nsmap.get(None)):
        notes.append(f"The default namespace {default} is ignored.")
        for element in root.iter(f"{{{default}}}*"):
            element.tag = etree.QName(element).localname
        etree.cleanup_namespaces(root)
    if root is None or root.tag != "robot":
        came = "nothing" if root is None else f"<{root.tag}>"
        raise ValueError(f"path: {path}: got {came}, expected {kind}: <robot>")
    _remove_foreign(root, path, notes)
    return root


def _remove_foreign(root: Any, path: Path, notes: list[str]) -> None:
    """Remove elements and attributes with a prefix; those of xacro are errors."""
    removed: dict[str, None] = {}
    for element in list(root.iter()):
        if not isinstance(element.tag, str):
            continue
        name = PREFIX.sub("", element.tag)
        if name != element.tag:  # prefix:name, or {uri}name where the prefix is declared
            if "xacro" in element.tag:
                _fail(
                    path, element, f"got <xacro:{name}>, expected URDF; name it .xacro to expand it"
                )
            removed[name] = None
            if element.getparent() is not None:
                element.getparent().remove(element)
            continue
        for key in [k for k in element.attrib if PREFIX.match(k)]:
            removed[PREFIX.sub("", key)] = None
            del element.attrib[key]
    if removed:
        notes.append(
            f"Elements and attributes of other programs are left out: {', '.join(removed)}."
        )


def check_document(document: Any, path: Path, kind: str) -> None:
    """Raise ValueError, with the line, for content that a loader fails on or skips silently.

    Elements without effect here are removed.

    Args:
        kind: `collision` or `visual`: the other kind of geometry is removed, not checked.
    """
    if document.find("link") is None:
        _fail(path, document, "<robot>: got no <link>, expected one; macros alone are no robot")
    for link in document.findall("link"):
        for item in link.findall("visual" if kind == "collision" else "collision"):
            link.remove(item)
    for item in list(document.iter(*UNUSED)):
        item.getparent().remove(item)
    for element in (document, *document.findall("link"), *document.findall("joint")):
        if not element.get("name"):
            _fail(path, element, f"<{element.tag}>: got no name, expected name=")
    for origin in document.iter("origin"):
        numbers(origin, "xyz", path)
        if origin.get("quat_xyzw") is None:
            numbers(origin, "rpy", path)
        elif origin.get("rpy") is None:
            quaternion(origin, path)
        else:
            _fail(path, origin, "origin: got rpy and quat_xyzw, expected one of them")
    for joint in document.findall("joint"):
        _check_joint(joint, path)
    for link in document.findall("link"):
        for item in link.findall(kind):
            _check_geometry(link, item, path)


def _fail(path: Path, element: Any, text: str) -> NoReturn:
    raise ValueError(f"{path}: line {element.sourceline}: {printable(text)}")


def _check_joint(joint: Any, path: Path) -> None:
    name, kind = joint.get("name"), joint.get("type")
    if kind in ("floating", "planar"):
        base = "free" if kind == "floating" else "planar"
        _fail(path, joint, f"joint {name!r} is {kind}: begin at its child, with base={base!r}")
    if kind not in JOINT_KINDS:
        expected = ", ".join(JOINT_KINDS)
        _fail(path, joint, f"joint {name!r}: type: got {kind!r}, expected one of {expected}")
    for tag, names in JOINT_NUMBERS.items():
        for element in joint.findall(tag):
            for attribute in names:
                _check_number(element, attribute, f"joint {name!r}: {tag}", path)
    for end in ("parent", "child"):
        if joint.find(end) is None or not joint.find(end).get("link"):
            _fail(path, joint, f"joint {name!r}: got no {end}, expected <{end} link=>")


def _check_number(element: Any, attribute: str, label: str, path: Path) -> None:
    text = element.get(attribute)
    try:
        number_of(float(text or 0), attribute)
    except ValueError:
        _fail(path, element, f"{label}: {attribute}: got {text!r}, expected a number")


def _check_geometry(link: Any, item: Any, path: Path) -> None:
    geometry, label = item.find("geometry"), f"link {link.get('name')!r}"
    inside = [] if geometry is None else [child.tag for child in geometry]
    if len(inside) != 1 or inside[0] not in GEOMETRIES:
        got, expected = ", ".join(map(str, inside)) or "nothing", ", ".join(GEOMETRIES)
        _fail(path, item, f"{label}: {item.tag} geometry: got {got}, expected one of {expected}")
    form = geometry[0]
    if inside == ["mesh"] and not form.get("filename"):
        _fail(path, item, f"{label}: got a mesh without filename, expected one")
    for name, counts in SIZES[form.tag].items():
        text = form.get(name)
        if text is None and form.tag == "mesh":
            continue
        try:
            words = [number_of(float(word), name, finite=True) for word in (text or "").split()]
        except ValueError:
            words = []
        if len(words) not in counts:
            expected = f"{' or '.join(map(str, counts))} numbers"
            _fail(path, form, f"{label}: {form.tag} {name}: got {text!r}, expected {expected}")


def load_model(document: Any, path: Path) -> Any:
    """yourdfpy's model of a document."""
    import yourdfpy
    from lxml import etree

    text = io.BytesIO(etree.tostring(document))
    try:
        return yourdfpy.URDF.load(text, build_scene_graph=False, load_meshes=False).robot
    except Exception as error:  # yourdfpy raises whatever its parts raise
        reason = printable(str(error).strip()[:200])
        raise ValueError(f"path: {path} cannot be read ({reason}), expected a URDF file") from error


def quaternion(origin: Any, path: Path) -> tuple[float, float, float, float]:
    """The unit quaternion x, y, z, w of an origin, as URDF 1.1 has it."""
    text = origin.get("quat_xyzw")
    try:
        x, y, z, w = (number_of(float(word), "quat_xyzw", finite=True) for word in text.split())
    except ValueError:
        _fail(path, origin, f"origin: quat_xyzw: got {text!r}, expected four numbers")
    length = math.sqrt(x * x + y * y + z * z + w * w)
    if abs(length - 1) > 1e-3:
        _fail(path, origin, f"origin: quat_xyzw: got length {length:g}, expected 1")
    return x / length, y / length, z / length, w / length


def numbers(element: Any, name: str, path: Path) -> list[float]:
    """Three numbers of an attribute; zeros without it."""
    text = element.get(name, "0 0 0")
    try:
        x, y, z = (number_of(float(word), name, finite=True) for word in text.split())
    except ValueError:
        where = f"{path}: line {element.sourceline}: origin: {name}"
        raise ValueError(f"{where}: got {text!r}, expected three numbers") from None
    return [x, y, z]

"""Robots from URDF, read by yourdfpy; allowed collisions from SRDF.

yourdfpy gives the tree, limits and geometry. Origins are taken from the text: their sines and
cosines are the native core's, so that a file is the same robot, bit for bit, on every machine.
"""

from __future__ import annotations

import io
import math
import os
import warnings
from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.collision.mesh_files import read_mesh_file

from . import primitives
from .links_joints import JOINT_KINDS, Joint, Link, LinkShape, Mimic, number_of

GEOMETRIES = ("box", "cylinder", "sphere", "mesh")


@dataclass
class Reader:
    """One URDF file, and how its geometry becomes shapes."""

    path: Path
    package_dirs: Sequence[Path]
    collision: bool
    scale: float
    error: float  # meters, of cylinders and spheres
    shape_options: dict[str, Any]  # of Shape
    meshes: dict[tuple[Any, ...], Shape] = field(default_factory=dict)

    def read(self) -> tuple[str, list[Link], list[Joint]]:
        """Name, links and joints, as the file has them."""
        document = parsed(self.path)
        check(document, self.path)
        model = _loaded(document, self.path)
        texts = document.findall("link"), document.findall("joint")
        links = [self._link(link, text) for link, text in zip(model.links, texts[0], strict=True)]
        slides = {joint.name for joint in model.joints if joint.type == "prismatic"}
        joints = [self._joint(j, t, slides) for j, t in zip(model.joints, texts[1], strict=True)]
        shaped = any(link.shapes for link in links)
        if self.collision and not shaped and document.find("link/visual") is not None:
            told = "has visual but no collision geometry: it meets nothing; give collision=False"
            warnings.warn(f"{self.path} {told} to take the visual", UserWarning, stacklevel=3)
        return model.name, links, joints

    def _link(self, link: Any, text: Any) -> Link:
        kind = "collision" if self.collision else "visual"
        items = link.collisions if self.collision else link.visuals
        shapes = []
        for item, element in zip(items, text.findall(kind), strict=True):
            shape, excess = self._shape(item.geometry, link.name)
            shapes.append(LinkShape(shape, self._origin(element), excess))
        return Link(link.name, shapes)

    def _joint(self, joint: Any, text: Any, slides: Container[str]) -> Joint:
        length = self.scale if joint.type == "prismatic" else 1.0
        limit = joint.limit
        lower, upper, velocity = -math.inf, math.inf, math.inf
        if limit is not None and joint.type in ("revolute", "prismatic"):
            lower = -math.inf if limit.lower is None else length * limit.lower
            upper = math.inf if limit.upper is None else length * limit.upper
        if limit is not None and limit.velocity:  # 0 stands for unknown
            velocity = length * limit.velocity
        mimic = None
        if joint.mimic is not None and joint.type != "fixed":
            m = joint.mimic
            followed = self.scale if m.joint in slides else 1.0
            mimic = Mimic(m.joint, m.multiplier * length / followed, length * m.offset)
        origin, axis = self._origin(text), joint.axis
        names = joint.name, joint.type, joint.parent, joint.child
        return Joint(*names, origin, axis, lower, upper, velocity, mimic=mimic)

    def _origin(self, text: Any) -> Floats:
        """The pose that an element's <origin> says."""
        origin = text.find("origin")
        if origin is None:
            return np.eye(4)
        pose = rotation(_numbers(origin, "rpy", self.path))
        pose[:3, 3] = [self.scale * x for x in _numbers(origin, "xyz", self.path)]
        return pose

    def _shape(self, geometry: Any, link: str) -> tuple[Shape, float]:
        if geometry.mesh is not None:
            return self._mesh(geometry.mesh, link), 0.0
        try:
            return self._primitive(geometry)
        except ValueError as error:
            raise ValueError(f"{self.path}: link {link!r}: {error}") from None

    def _primitive(self, geometry: Any) -> tuple[Shape, float]:
        k, options = self.scale, self.shape_options
        if geometry.box is not None:
            return primitives.box(k * geometry.box.size, **options), 0.0
        if geometry.sphere is not None:
            return primitives.sphere(k * geometry.sphere.radius, self.error, **options)
        form = geometry.cylinder
        return primitives.cylinder(k * form.radius, k * form.length, self.error, **options)

    def _mesh(self, mesh: Any, link: str) -> Shape:
        """The mesh file, scaled, mirrored where a scale is negative; read once."""
        file = self._found(mesh.filename, link)
        scale = np.broadcast_to(1.0 if mesh.scale is None else mesh.scale, 3).astype(float)
        key = (file, *scale)
        if key not in self.meshes:
            if not (np.isfinite(scale) & (scale != 0)).all():
                raise ValueError(
                    f"{self.path}: link {link!r}: mesh scale {mesh.scale}, expected numbers but 0"
                )
            vertices, faces = read_mesh_file(file)
            if np.prod(scale) < 0:
                faces = faces[:, ::-1]
            size = self.scale * scale * unit_of(file)
            self.meshes[key] = Shape(vertices * size, faces, name=file.stem, **self.shape_options)
        return self.meshes[key]

    def _found(self, name: str, link: str) -> Path:
        """The file that a mesh's URI or path names."""
        tried = list(dict.fromkeys(places(name, self.path, self.package_dirs)))
        for place in tried:
            if place.is_file():
                return place
        looked = ", ".join(map(str, tried))
        package = name.removeprefix("package://").split("/")[0]
        remedy = (
            f"give package_dirs=[the folder that holds {package!r}]"
            if name.startswith("package://")
            else "put it there"
        )
        raise FileNotFoundError(
            f"{self.path}: link {link!r}: mesh {name!r} is not there (looked at {looked}); {remedy}"
        )


def unit_of(file: Path) -> float:
    """Meters in a unit of a mesh file, where the file says that: COLLADA."""
    if file.suffix.lower() == ".dae":
        for _, element in ElementTree.iterparse(file):
            if element.tag.endswith("}unit"):
                return number_of(
                    float(element.get("meter", "1")), f"{file}: unit", 0.0, finite=True
                )
            if element.tag.endswith("}asset"):
                break
    return 1.0


def places(name: str, urdf: Path, package_dirs: Iterable[Path]) -> Iterable[Path]:
    """Where the file that a URI or path names may be, the likeliest first.

    `package://NAME/REST` is looked for in `package_dirs` (folders of packages, or a package
    itself), in ROS_PACKAGE_PATH, and in the folders above the URDF file.
    """
    above = urdf.resolve().parents
    if not name.startswith("package://"):
        plain = Path(name.removeprefix("file://"))
        yield plain if plain.is_absolute() else above[0] / plain
        return
    package, _, rest = name.removeprefix("package://").partition("/")
    ros = (Path(p) for p in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if p)
    for folder in (*package_dirs, *ros, *above):
        if folder.name == package:
            yield folder / rest
        yield folder / package / rest


def rotation(rpy: Sequence[float]) -> Floats:
    """Roll, pitch, yaw (rad) about fixed x, y, z, as a pose (4, 4)."""
    sines, cosines = _core.sin_cos(rpy)
    (sr, sp, sy), (cr, cp, cy) = sines.tolist(), cosines.tolist()
    pose = np.eye(4)
    pose[0, :3] = cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr
    pose[1, :3] = sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr
    pose[2, :3] = -sp, cp * sr, cp * cr
    return pose


def parsed(path: Path) -> Any:
    """The root element, without what has an unknown prefix; other faults in the XML are errors."""
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
        raise ValueError(f"path: {path} holds {came}, expected a URDF file: <robot>")
    for element in list(root.iter()):  # as xmlns declares one, a name is {uri}name
        if isinstance(element.tag, str) and ":" in element.tag and "{" not in element.tag:
            element.getparent().remove(element)
        for key in [k for k in element.attrib if ":" in k and "{" not in k]:
            del element.attrib[key]
    return root


def check(document: Any, path: Path) -> None:
    """What a loader trips over or passes by in silence, told by line."""

    def fail(element: Any, text: str) -> None:
        raise ValueError(f"{path}: line {element.sourceline}: {text}")

    for element in (document, *document.findall("link"), *document.findall("joint")):
        if not element.get("name"):
            fail(element, f"<{element.tag}> has no name, expected name=")
    for origin in document.iter("origin"):
        _numbers(origin, "rpy", path)
        _numbers(origin, "xyz", path)
    for joint in document.findall("joint"):
        name, kind = joint.get("name"), joint.get("type")
        if kind in ("floating", "planar"):
            base = "free" if kind == "floating" else "planar"
            fail(joint, f"joint {name!r} is {kind}: begin at its child, with base={base!r}")
        if kind not in JOINT_KINDS:
            fail(joint, f"joint {name!r}: type {kind!r}, expected one of {', '.join(JOINT_KINDS)}")
        for end in ("parent", "child"):
            if joint.find(end) is None or not joint.find(end).get("link"):
                fail(joint, f"joint {name!r} has no {end}, expected <{end} link=>")
    for link in document.findall("link"):
        for item in (*link.findall("collision"), *link.findall("visual")):
            geometry = item.find("geometry")
            inside = [] if geometry is None else [child.tag for child in geometry]
            if len(inside) != 1 or inside[0] not in GEOMETRIES:
                what = ", ".join(map(str, inside)) or "nothing"
                label = f"link {link.get('name')!r}: {item.tag}"
                fail(item, f"{label} geometry is {what}, expected one of {', '.join(GEOMETRIES)}")
            if inside == ["mesh"] and not geometry[0].get("filename"):
                fail(item, f"link {link.get('name')!r}: mesh without filename")


def disabled_collisions(srdf: str | Path, links: Iterable[Link]) -> list[tuple[str, str]]:
    """Pairs of links whose collisions an SRDF file disables; pairs of others are passed by."""
    path = Path(srdf)
    if not path.is_file():
        raise FileNotFoundError(f"srdf: {path} does not exist, expected an SRDF file")
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        raise ValueError(f"srdf: {path}: got {error}, expected XML") from None
    if root.tag != "robot":
        raise ValueError(f"srdf: {path} holds <{root.tag}>, expected an SRDF file: <robot>")
    known = {link.name for link in links}
    pairs = [(e.get("link1", ""), e.get("link2", "")) for e in root.iter("disable_collisions")]
    return [pair for pair in pairs if known.issuperset(pair)]


def _loaded(document: Any, path: Path) -> Any:
    import yourdfpy
    from lxml import etree

    text = io.BytesIO(etree.tostring(document))
    try:
        return yourdfpy.URDF.load(text, build_scene_graph=False, load_meshes=False).robot
    except Exception as error:  # yourdfpy raises whatever its parts raise
        raise ValueError(f"path: {path} cannot be read ({error}), expected a URDF file") from error


def _numbers(element: Any, what: str, path: Path) -> list[float]:
    """Three numbers of an attribute; 0 where it is left out."""
    text = element.get(what, "0 0 0")
    try:
        x, y, z = (number_of(float(word), what, finite=True) for word in text.split())
    except ValueError:
        where = f"{path}: line {element.sourceline}: origin: {what}"
        raise ValueError(f"{where} {text!r}, expected three numbers") from None
    return [x, y, z]

"""The package of a 3MF file: its model parts, and the objects in them."""

from __future__ import annotations

import re
from types import TracebackType
from typing import NamedTuple, NoReturn

from fgenv.arrays import Faces, Floats, Vertices

from .archive import open_zip, read_member
from .content import MeshSource
from .files import MAX_BYTES
from .xml_tree import Element, parse_xml

MODEL_TYPE = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
ENCRYPTED_TYPE = "/encryptedfile"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
SUPPORTED = {  # required extensions that keep the triangles
    PRODUCTION,
    "http://schemas.microsoft.com/3dmanufacturing/core/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
}
NAMES = {
    "beamlattice": "beam lattice",
    "slice": "slice",
    "volumetric": "volumetric",
    "implicit": "implicit function",
    "boolean": "boolean operations",
    "displacement": "displacement",
    "securecontent": "secure content (encryption)",
}
SLICER_SETTINGS = r"metadata/[^/]*model[^/]*\.config"
ROWS = {"vertex": ("x", "y", "z"), "triangle": ("v1", "v2", "v3")}


class ModelPart(NamedTuple):
    """One model document of a package."""

    source: MeshSource
    name: str
    element: Element

    def fail(self, element: Element, received: str, expected: str) -> NoReturn:
        """Raise the error of an element."""
        self.source.fail(f"{received} in {self.name[:80]}", expected, line=element.line)


class ModelObject(NamedTuple):
    """An <object>, and the part that holds it."""

    part: ModelPart
    element: Element

    def __str__(self) -> str:
        return str(self.element)

    def fail(self, received: str, expected: str) -> NoReturn:
        """Raise the error of this object."""
        self.part.fail(self.element, received, expected)


class ThreemfPackage:
    """Reads the parts of a package, each one once."""

    def __init__(self, source: MeshSource) -> None:
        self.source = source
        self._archive = open_zip(source)
        # Names of parts are equal without regard to case (Open Packaging Conventions).
        self._members = {info.filename.lower(): info for info in self._archive.infolist()}
        self._objects: dict[str, dict[str, ModelObject]] = {}
        self._parts: dict[str, ModelPart] = {}
        self._used: set[tuple[str, str]] = set()
        self.checked: dict[int, tuple[Vertices, Faces] | None] = {}  # content by id of an element
        self.poses: dict[int, Floats] = {}  # by id of an element

    def __enter__(self) -> ThreemfPackage:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        self._archive.close()

    def root(self) -> ModelPart:
        """The model that the package starts with."""
        relations = parse_xml(self.source, self._content("_rels/.rels"), part="_rels/.rels")
        kinds = relations.all("Relationship")
        if any(kind.get("Type").endswith(ENCRYPTED_TYPE) for kind in kinds):
            self.source.fail("encrypted content", "a 3MF file without encryption")
        targets = [kind.get("Target") for kind in kinds if kind.get("Type") == MODEL_TYPE]
        if len(targets) != 1:
            self.source.fail(f"{len(targets)} start parts", "one 3D model; export it again")
        return self._part(targets[0])

    def target(self, part: ModelPart, reference: Element) -> ModelObject:
        """The object that an <item> or a <component> refers to."""
        path = reference.get(f"{PRODUCTION} path")
        holder = self._part(path) if path else part
        name = reference.get("objectid")
        objects = self._objects[holder.name]
        if name not in objects:
            part.fail(
                reference, f"a reference to the object {name[:20]!r}", f"one of {holder.name}"
            )
        self._used.add((holder.name, name))
        return objects[name]

    def unused_objects(self) -> int:
        """Number of objects in the parts that were read and to which nothing refers."""
        return sum(len(objects) for objects in self._objects.values()) - len(self._used)

    def has_slicer_settings(self) -> bool:
        """Whether the package has the settings file of a slicer, which can name modifiers."""
        return any(re.fullmatch(SLICER_SETTINGS, name) for name in self._members)

    def _part(self, path: str) -> ModelPart:
        name = path.removeprefix("/")
        if name.lower() not in self._parts:
            element = parse_xml(self.source, self._content(name), ROWS, name)
            if element.tag != "model":
                self.source.fail(f"<{element.tag[:40]}> in {name[:80]}", "<model>")
            part = ModelPart(self.source, name, element)
            _check_extensions(part)
            self._parts[name.lower()] = part
            self._objects[name] = _objects(part)
        return self._parts[name.lower()]

    def _content(self, name: str) -> bytes:
        info = self._members.get(name.lower())
        if info is None:
            self.source.fail(f"no part {name[:80]!r}", "a 3MF package; export it again")
        return read_member(self.source, self._archive, info, MAX_BYTES)


def _objects(part: ModelPart) -> dict[str, ModelObject]:
    found: dict[str, ModelObject] = {}
    resources = part.element.first("resources")
    for element in resources.all("object") if resources else ():
        if element.get("id") in found:
            part.fail(element, f"a second object {element.get('id')[:20]!r}", "unique ids")
        found[element.get("id")] = ModelObject(part, element)
    return found


def _check_extensions(part: ModelPart) -> None:
    """Refuse a model that requires an extension that can change its geometry."""
    root = part.element
    for prefix in root.get("requiredextensions").split():
        namespace = root.prefixes.get(prefix, "")
        if namespace not in SUPPORTED:
            name = next((n for key, n in NAMES.items() if f"/{key}/" in namespace), prefix[:40])
            part.fail(
                root,
                f"the required extension {name} ({namespace[:80] or 'without namespace'})",
                "core 3MF, with materials and production; export it as a mesh",
            )

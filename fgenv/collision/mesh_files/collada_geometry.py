"""Meshes of COLLADA: sources of vertices, and all kinds of primitives as triangles."""

from __future__ import annotations

from typing import NamedTuple, NoReturn

import numpy as np

from fgenv.arrays import Faces, Ints, Vertices

from .collada_document import ColladaDocument
from .collada_sources import positions_of
from .polygons import crossing_note, fan_faces, strip_faces, triangulated, triangulated_with_holes
from .scene_parts import SceneParts
from .xml_tree import Element

SURFACES = ("triangles", "polylist", "polygons", "trifans", "tristrips")
LINES = ("lines", "linestrips")
NO_FACES = np.empty((0, 3), dtype=np.int64)


class Surface(NamedTuple):
    """Triangles of a geometry, each of its primitives with its own vertices."""

    vertices: Vertices
    faces: Faces


class GeometryReader:
    """Reads the geometries of a document, each one once."""

    def __init__(self, document: ColladaDocument, parts: SceneParts) -> None:
        self.document = document
        self.parts = parts
        self._surfaces: dict[int, list[Surface]] = {}

    def surfaces(self, geometry: Element) -> list[Surface]:
        """The primitives of a <geometry> that are surfaces; lines are noted."""
        if id(geometry) not in self._surfaces:
            mesh = geometry.first("mesh")
            if mesh is None:
                kinds = [child.tag for child in geometry.children if child.tag != "asset"]
                kind = f"<{kinds[0][:40]}>" if kinds else "nothing"
                self.document.fail(geometry, f"{kind} in {geometry}", "<mesh>; export a mesh")
            if mesh.all(*LINES):
                self.parts.note("Lines are skipped: they have no surface.")
            primitives = mesh.all(*SURFACES)
            self._surfaces[id(geometry)] = [self._surface(p, mesh, geometry) for p in primitives]
        return self._surfaces[id(geometry)]

    def _surface(self, primitive: Element, mesh: Element, geometry: Element) -> Surface:
        document = self.document
        inputs = primitive.all("input")
        stride = 1 + max((document.whole(i, "offset", 0) for i in inputs), default=0)
        corners = _Corners(document, primitive, f"<{primitive.tag}> of {geometry}", stride)
        if corners.empty():
            return Surface(np.empty((0, 3)), NO_FACES)
        chosen = [i for i in inputs if i.get("semantic") == "VERTEX"]
        if len(chosen) != 1:
            document.fail(primitive, f"{len(chosen)} VERTEX inputs in {corners.name}", "one")
        corners.offset = document.whole(chosen[0], "offset", 0)
        corners.vertices = positions_of(document, chosen[0], mesh)
        faces = corners.faces(self.parts)
        return Surface(corners.vertices, faces)


class _Corners:
    """The corners of one primitive element, as indices of its vertices."""

    def __init__(
        self, document: ColladaDocument, primitive: Element, name: str, stride: int
    ) -> None:
        self.document = document
        self.primitive = primitive
        self.name = name
        self.stride = stride
        self.offset = 0
        self.vertices: Vertices = np.empty((0, 3))

    def empty(self) -> bool:
        """Whether the element has no corners and states none."""
        texts = [e.text for e in self.primitive.below() if e.tag in ("p", "h")]
        return not any(map(str.strip, texts)) and self.primitive.get("count") in ("", "0")

    def faces(self, parts: SceneParts) -> Faces:
        """Triangles (m, 3)."""
        tag = self.primitive.tag
        if tag in ("trifans", "tristrips"):
            convert = fan_faces if tag == "trifans" else strip_faces
            rows = [self._ring(p) for p in self.primitive.all("p")]
            self._check_count(len(rows))
            return np.vstack([NO_FACES, *map(convert, rows)])
        if tag == "polygons":
            return self._polygons(parts)
        corners = self._indices(self.primitive.all("p"))
        if tag == "triangles":
            if len(corners) % 3:
                self._fail(f"{len(corners)} corners", "three for each triangle")
            self._check_count(len(corners) // 3)
            return corners.reshape(-1, 3)
        return self._cut(self._counts(len(corners)), corners, parts)

    def _polygons(self, parts: SceneParts) -> Faces:
        rings = [self._ring(p) for p in self.primitive.all("p")]
        holed = self.primitive.all("ph")
        self._check_count(len(rings) + len(holed))
        faces = [NO_FACES]
        if rings:
            counts = np.array([len(ring) for ring in rings])
            faces.append(self._cut(counts, np.concatenate(rings), parts))
        for element in holed:
            outline = [self._ring(p) for p in element.all("p")]
            if len(outline) != 1:
                self._fail(f"{len(outline)} outlines in <ph>", "one <p>, then holes <h>")
            holes = [self._ring(h) for h in element.all("h")]
            faces.append(triangulated_with_holes(self.vertices, [*outline, *holes]))
            self.document.polygons += 1
        return np.vstack(faces)

    def _cut(self, counts: Ints, corners: Ints, parts: SceneParts) -> Faces:
        """Polygons as triangles."""
        done = triangulated(self.vertices, counts, corners)
        self.document.polygons += done.polygons
        self.document.nonplanar += done.nonplanar
        if done.crossing:
            parts.note(crossing_note(done.crossing))
        return done.faces

    def _counts(self, corners: int) -> Ints:
        """Corners of each polygon of a <polylist>."""
        element = self.primitive.first("vcount")
        if element is None:
            self._fail("no <vcount>", "the number of corners of each polygon")
        counts: Ints = self.document.numbers(element, np.int64)
        if counts.min(initial=3) < 3:
            self._fail(f"a polygon with {counts.min()} corners", "at least 3")
        self._check_count(len(counts))
        if (total := int(counts.astype(object).sum())) != corners:
            self._fail(f"{corners} corners", f"the {total} that its <vcount> states")
        return counts

    def _ring(self, element: Element) -> Ints:
        """Corners of one polygon, strip, fan or hole."""
        corners = self._indices([element])
        if len(corners) < 3:
            self._fail(f"{len(corners)} corners in <{element.tag}>", "at least 3")
        return corners

    def _indices(self, elements: list[Element]) -> Ints:
        """Indices of vertices from <p> elements, which interleave those of all inputs."""
        if len(elements) != 1:
            self._fail(f"{len(elements)} <p> elements", "one")
        values: Ints = self.document.numbers(elements[0], np.int64)
        if len(values) % self.stride:
            self._fail(f"{len(values)} indices", f"{self.stride} for each corner")
        corners = values[self.offset :: self.stride]
        if len(corners) and not (corners.min() >= 0 and corners.max() < len(self.vertices)):
            wrong = corners[(corners < 0) | (corners >= len(self.vertices))][0]
            self._fail(f"the vertex index {wrong}", f"one of its {len(self.vertices)} vertices")
        return corners

    def _check_count(self, found: int) -> None:
        if (stated := self.document.whole(self.primitive, "count", found)) != found:
            self._fail(f"{found} primitives", f"the {stated} that its count states")

    def _fail(self, received: str, expected: str) -> NoReturn:
        self.document.fail(self.primitive, f"{received} in {self.name}", expected)

"""PLY: the Polygon File Format of Stanford, as text and binary."""

from __future__ import annotations

import numpy as np

from fgenv.arrays import Faces, Ints, Vertices

from .content import FileMesh, MeshSource
from .ply_binary import BinaryBody
from .ply_body import Columns
from .ply_header import Element, read_header
from .ply_text import TextBody
from .polygons import Triangulation, crossing_note, strip_faces, triangulated

CORNERS = ("vertex_indices", "vertex_index")


def read_ply(source: MeshSource) -> FileMesh:
    """Read faces and triangle strips of a PLY file; other elements and properties do not matter."""
    header = read_header(source)
    by_name = {element.name: element for element in header.elements}
    vertex = by_name.get("vertex")
    if vertex is None:
        source.fail("no element vertex in the header", "one with x, y and z")
    _check_coordinates(source, vertex)
    body = TextBody if header.kind == "ASCII" else BinaryBody
    columns = body(source, header).read()
    vertices = np.column_stack([columns["vertex", name].values for name in "xyz"])
    vertices = vertices.astype(np.float64, copy=False)
    parts = []
    for name, read in (("face", _faces), ("tristrips", _strips)):
        if name in by_name and by_name[name].count:
            parts.append(read(source, by_name[name], columns, vertices))
    faces = np.vstack([part.faces for part in parts]) if parts else np.empty((0, 3), dtype=np.int64)
    crossing = sum(part.crossing for part in parts)
    return FileMesh(
        f"{header.kind} PLY",
        vertices,
        faces,
        polygons=sum(part.polygons for part in parts),
        nonplanar=sum(part.nonplanar for part in parts),
        notes=(crossing_note(crossing),) if crossing else (),
    )


def _check_coordinates(source: MeshSource, element: Element) -> None:
    numbers = {p.name for p in element.properties if p.count_type is None}
    for name in "xyz":
        if name not in numbers:
            source.fail(f"vertices without the property {name}", "x, y and z")


def _corners(source: MeshSource, element: Element, columns: Columns) -> tuple[Ints, Ints]:
    """Counts (k,) and values of the lists of vertices."""
    names = [p.name for p in element.properties if p.name in CORNERS and p.count_type]
    if not names:
        source.fail(f"{element.name} without a list of vertices", f"the list {CORNERS[0]}")
    values, counts = columns[element.name, names[0]]
    assert counts is not None
    if values.dtype.kind == "f" and (values % 1 != 0).any():
        source.fail("a vertex index that is not whole", "integers")
    return counts.astype(np.int64), values.astype(np.int64)


def _check_range(
    source: MeshSource, element: str, corners: Ints, counts: Ints, vertex_count: int
) -> None:
    wrong = (corners < 0) | (corners >= vertex_count)
    if not wrong.any():
        return
    place = int(np.flatnonzero(wrong)[0])
    row = int(np.searchsorted(np.cumsum(counts), place, side="right"))
    source.fail(
        f"the vertex index {corners[place]}, out of range, in {element} {row} (from 0)",
        f"an index from 0 to {vertex_count - 1}",
    )


def _faces(
    source: MeshSource,
    element: Element,
    columns: Columns,
    vertices: Vertices,
) -> Triangulation:
    counts, corners = _corners(source, element, columns)
    if (bad := np.flatnonzero(counts < 3)).size:
        received = f"face {bad[0]} (from 0) with {counts[bad[0]]} corners"
        source.fail(received, "at least 3")
    _check_range(source, "face", corners, counts, len(vertices))
    return triangulated(vertices, counts, corners)


def _strips(
    source: MeshSource,
    element: Element,
    columns: Columns,
    vertices: Vertices,
) -> Triangulation:
    """Triangle strips; -1 ends a strip within a list."""
    counts, corners = _corners(source, element, columns)
    split = np.insert(corners, np.cumsum(counts), -1)
    ends = np.flatnonzero(split == -1)
    strips = [part[part != -1] for part in np.split(split, ends)]
    valid = np.concatenate([*strips, np.empty(0, dtype=np.int64)])
    _check_range(
        source, "tristrips", valid, np.array([len(part) for part in strips]), len(vertices)
    )
    faces: list[Faces] = [strip_faces(part) for part in strips if len(part) >= 3]
    return Triangulation(np.vstack(faces) if faces else np.empty((0, 3), dtype=np.int64), 0, 0, 0)

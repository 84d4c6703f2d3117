"""OBJ: vertices and polygons of Wavefront, by line; materials and textures do not matter."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import NoReturn

import numpy as np

from fgenv.arrays import Floats, Ints

from .content import FileMesh, MeshSource
from .polygons import crossing_note, triangulated
from .text import BadNumberError, check_finite, fail_number, numbers, shown, text_chunks

IGNORED = frozenset(
    b"# vt vn vp g o s mg usemtl mtllib usemap maplib bevel c_interp d_interp lod shadow_obj"
    b" trace_obj".split()
)
CURVES = frozenset(
    b"cstype deg bmat step curv curv2 surf parm trim hole scrv sp end con ctech stech"
    b" bzp bsp cdc cdp res".split()
)
REFERENCES = re.compile(rb"/\S*")  # to textures and normals: `7/1/3` is vertex 7
CONTINUED = re.compile(rb"\\[ \t]*\r?\n")
JOINT = b" \v"  # replaces a continuation: white space that keeps the count of lines


@dataclass
class _Elements:
    """What the lines of a file specify."""

    vertices: list[Floats] = field(default_factory=list)
    vertex_count: int = 0
    weights: int = 0  # other than 1
    corners: list[Ints] = field(default_factory=list)  # as written
    counts: list[Ints] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)  # of the faces
    defined: list[int] = field(default_factory=list)  # vertices before each face
    points: int = 0
    polylines: int = 0


def read_obj(source: MeshSource) -> FileMesh:
    """Read an OBJ file: all groups and objects as one mesh; `l` and `p` elements are noted."""
    data = CONTINUED.sub(JOINT, source.data) if b"\\" in source.data else source.data
    elements, skipped = _Elements(), 0
    for first, lines in text_chunks(source, data):
        skipped += _read_lines(source, lines, first + skipped, elements)
    vertices = np.concatenate(elements.vertices or [np.empty((0, 3))])
    if not elements.counts:
        no_faces = np.empty((0, 3), dtype=np.int64)
        return FileMesh("OBJ", vertices, no_faces, notes=_notes(elements, 0, 0))
    counts = np.concatenate(elements.counts)
    thin = counts < 3
    if thin[-1] and not source.data.endswith(b"\n"):
        received = f"a face of {counts[-1]} corners at the end: a truncated file"
        source.fail(received, "at least 3; copy or export it again", line=elements.lines[-1])
    corners = _indices(source, elements, counts)
    result = triangulated(vertices, counts[~thin], corners[np.repeat(~thin, counts)])
    notes = _notes(elements, result.crossing, int(thin.sum()))
    return FileMesh(
        "OBJ", vertices, result.faces, None, None, result.polygons, result.nonplanar, notes
    )


def _read_lines(source: MeshSource, lines: list[bytes], first: int, out: _Elements) -> int:
    """Add the elements of some lines; return the number of continuations in them."""
    vertices: list[bytes] = []
    faces: list[bytes] = []
    vertex_lines: list[int] = []
    before = out.vertex_count
    joined = 0
    for number, line in enumerate(lines, first):
        words = line.split(None, 1)
        if not words:
            continue
        keyword, rest = words[0], words[1] if len(words) > 1 else b""
        if b"#" in rest:
            rest = rest.partition(b"#")[0]
        if keyword == b"v":
            vertices.append(rest)
            vertex_lines.append(number + joined)
        elif keyword in (b"f", b"fo"):
            faces.append(rest)
            out.lines.append(number + joined)
            out.defined.append(before + len(vertices))
        elif keyword not in IGNORED and not keyword.startswith(b"#"):
            _count_other(source, keyword, number + joined, out)
        if JOINT in line:
            joined += line.count(JOINT)
    _add_vertices(source, vertices, vertex_lines, out)
    _add_faces(source, faces, out)
    return joined


def _count_other(source: MeshSource, keyword: bytes, line: int, out: _Elements) -> None:
    if keyword == b"p":
        out.points += 1
    elif keyword == b"l":
        out.polylines += 1
    elif keyword in CURVES:
        source.fail(
            f"the free-form geometry {keyword.decode()}", "polygons; export a mesh", line=line
        )
    elif keyword in (b"call", b"csh"):
        source.fail(f"the command {keyword.decode()}", "one file; export a mesh", line=line)
    else:
        source.fail(shown(keyword), "a keyword of an OBJ file: v, f, ...", line=line)


def _add_vertices(source: MeshSource, texts: list[bytes], lines: list[int], out: _Elements) -> None:
    """Add vertices of 3 numbers, a weight and a color, each optional."""
    if not texts:
        return
    try:
        values, counts = numbers(texts)
    except BadNumberError as error:
        fail_number(source, error, lines[error.index])
    if (bad := np.flatnonzero(~np.isin(counts, (3, 4, 6, 7)))).size:
        received = f"a vertex of {counts[bad[0]]} numbers"
        source.fail(received, "x, y, z, and a weight or color", line=lines[bad[0]])
    firsts = np.cumsum(counts) - counts
    vertices = values[firsts[:, None] + np.arange(3)]
    check_finite(source, vertices, lines.__getitem__)
    out.weights += int((values[firsts[counts == 4] + 3] != 1).sum())
    out.vertices.append(vertices)
    out.vertex_count += len(vertices)


def _add_faces(source: MeshSource, texts: list[bytes], out: _Elements) -> None:
    """Add faces, as written: without their references to textures and normals."""
    if not texts:
        return
    if any(b"/" in text for text in (texts[0], texts[-1])) or b"/" in b"".join(texts):
        texts = REFERENCES.sub(b"", b"\n".join(texts)).split(b"\n")
    lines = out.lines[-len(texts) :]
    try:
        corners, counts = numbers(texts, np.int64)
    except BadNumberError as error:
        source.fail(shown(error.token), "the index of a vertex", line=lines[error.index])
    out.corners.append(corners)
    out.counts.append(counts)


def _indices(source: MeshSource, elements: _Elements, counts: Ints) -> Ints:
    """Corners as indices from 0; negative ones count back from the face's line."""
    corners = np.concatenate(elements.corners)
    negative = np.flatnonzero(corners < 0)
    if negative.size:
        owner = np.repeat(np.arange(len(counts)), counts)[negative]
        before = np.array(elements.defined)[owner]
        valid = corners[negative] + before >= 0
        corners[negative] = np.where(valid, corners[negative] + before + 1, corners[negative])
    wrong = (corners < 1) | (corners > elements.vertex_count)
    if wrong.any():
        _fail_index(source, elements, counts, int(np.flatnonzero(wrong)[0]), corners)
    return corners - 1


def _fail_index(
    source: MeshSource, elements: _Elements, counts: Ints, place: int, corners: Ints
) -> NoReturn:
    face = int(np.searchsorted(np.cumsum(counts), place, side="right"))
    index, defined = int(corners[place]), elements.defined[face]
    if index == 0:
        source.fail("the vertex index 0", "indices from 1", line=elements.lines[face])
    limit = defined if index < 0 else elements.vertex_count
    received = f"the vertex index {index}, out of range"
    source.fail(received, f"one of {limit} vertices", line=elements.lines[face])


def _notes(elements: _Elements, crossing: int, thin: int) -> tuple[str, ...]:
    notes = []
    if thin:
        notes.append(f"{thin} faces with fewer than three corners have no surface.")
    if crossing:
        notes.append(crossing_note(crossing))
    if elements.polylines:
        notes.append(f"{elements.polylines} polylines (l) have no surface and are left out.")
    if elements.points:
        notes.append(f"{elements.points} point elements (p) have no surface and are left out.")
    if elements.weights:
        notes.append(f"{elements.weights} vertices have a weight, which only curves use.")
    return tuple(notes)

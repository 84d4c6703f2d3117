"""OFF: the Object File Format of Geomview, as text."""

from __future__ import annotations

import re

import numpy as np

from fgenv.arrays import Floats, Ints

from .content import FileMesh, MeshSource
from .polygons import crossing_note, triangulated
from .text import BadNumberError, check_finite, fail_number, numbers, parse, shown, text_chunks

HEADER = re.compile(rb"(?:ST)?C?N?(4?n?)(?:OFF|off)")
COUNTS = "numbers of vertices, faces and edges"


class _Lines:
    """The lines of a file without comments and empty lines, with their numbers."""

    def __init__(self, source: MeshSource) -> None:
        self.source = source
        self.lines: list[bytes] = []
        self.numbers: list[int] = []
        for first, lines in text_chunks(source):
            for number, line in enumerate(lines, first):
                content = line.partition(b"#")[0] if b"#" in line else line
                if content and not content.isspace():
                    self.lines.append(content)
                    self.numbers.append(number)

    def number(self, index: int) -> int:
        """Number in the file; of the last line if the index is behind it."""
        return self.numbers[min(index, len(self.numbers) - 1)] if self.numbers else 1

    def rows(self, begin: int, end: int) -> tuple[Floats, Ints]:
        """The numbers of some lines, and how many each has."""
        try:
            values, counts = numbers(self.lines[begin:end])
        except BadNumberError as error:
            fail_number(self.source, error, self.number(begin + error.index))
        return values, counts


def read_off(source: MeshSource) -> FileMesh:
    """Read an OFF file with any of the prefixes ST, C and N; colors and normals do not matter."""
    lines = _Lines(source)
    begin = _read_header(source, lines)
    vertex_count, face_count, begin = _read_counts(source, lines, begin)
    end = begin + vertex_count + face_count
    if len(lines.lines) != end:
        received = f"{len(lines.lines) - begin} lines of vertices and faces"
        expected = f"{vertex_count + face_count}, as line {lines.number(begin - 1)} states"
        source.fail(received, expected, line=lines.number(end))
    vertices = _vertices(source, lines, begin, begin + vertex_count)
    counts, corners, thin = _faces(source, lines, begin + vertex_count, end, vertex_count)
    result = triangulated(vertices, counts, corners)
    notes = []
    if result.crossing:
        notes.append(crossing_note(result.crossing))
    if thin:
        notes.append(f"{thin} faces with fewer than three corners have no surface.")
    return FileMesh(
        "OFF", vertices, result.faces, None, None, result.polygons, result.nonplanar, tuple(notes)
    )


def _read_header(source: MeshSource, lines: _Lines) -> int:
    """Check the keyword, which is optional; return the index of the line with the counts."""
    if not lines.lines:
        source.fail("nothing but comments", "an OFF file")
    words = lines.lines[0].split(None, 1)
    match = HEADER.fullmatch(words[0])
    if match is None:
        if words[0].isdigit():
            return 0
        source.fail(shown(words[0]), "the keyword OFF", line=lines.number(0))
    if match[1]:
        source.fail(
            f"the header {words[0].decode()}, vertices of 4 or n numbers",
            "vertices of 3; export it again",
            line=lines.number(0),
        )
    if len(words) > 1 and words[1].split()[0].upper() == b"BINARY":
        source.fail("a binary OFF file", "a text file; export it again", line=lines.number(0))
    if len(words) > 1:  # the counts follow in the same line
        lines.lines[0] = words[1]
        return 0
    return 1


def _read_counts(source: MeshSource, lines: _Lines, index: int) -> tuple[int, int, int]:
    if index >= len(lines.lines):
        source.fail("the end of the file", COUNTS, line=lines.number(index))
    if lines.lines[index].split()[0].upper() == b"BINARY":
        source.fail("a binary OFF file", "a text file; export it again", line=lines.number(index))
    values = parse(lines.lines[index], np.int64)
    if values is None or len(values) not in (2, 3) or (values < 0).any():
        source.fail(shown(lines.lines[index].strip()), COUNTS, line=lines.number(index))
    return int(values[0]), int(values[1]), index + 1


def _vertices(source: MeshSource, lines: _Lines, begin: int, end: int) -> Floats:
    values, counts = lines.rows(begin, end)
    if (bad := np.flatnonzero((counts < 3) | (counts > 12))).size:
        received = f"a vertex of {counts[bad[0]]} numbers"
        source.fail(received, "x, y and z", line=lines.number(begin + bad[0]))
    vertices: Floats = values[(np.cumsum(counts) - counts)[:, None] + np.arange(3)]
    check_finite(source, vertices, lambda i: lines.number(begin + i))
    return vertices


def _faces(
    source: MeshSource, lines: _Lines, begin: int, end: int, vertex_count: int
) -> tuple[Ints, Ints, int]:
    """Counts and corners of the polygons, and the number of faces with fewer corners.

    A line is the number of corners, the corners, and a color of up to four numbers.
    """
    values, lengths = lines.rows(begin, end)
    firsts = np.cumsum(lengths) - lengths
    counts = values[firsts]
    extra = lengths - 1 - counts
    if (bad := np.flatnonzero((counts < 1) | (counts % 1 != 0) | (extra < 0) | (extra > 4))).size:
        i = bad[0]
        received = f"a face of {counts[i]:g} corners in a line of {lengths[i]} numbers"
        expected = "the number of corners, the corners, a color of up to 4 numbers"
        source.fail(received, expected, line=lines.number(begin + i))
    counts = counts.astype(np.int64)
    owner = np.repeat(np.arange(len(counts)), counts)
    within = np.arange(len(owner)) - (np.cumsum(counts) - counts)[owner]
    corners = values[firsts[owner] + 1 + within]
    wrong = (corners < 0) | (corners >= vertex_count) | (corners % 1 != 0)
    if (bad := np.flatnonzero(wrong)).size:
        received = f"the vertex index {corners[bad[0]]:g}, out of range"
        expected = f"an index from 0 to {vertex_count - 1}"
        source.fail(received, expected, line=lines.number(begin + owner[bad[0]]))
    keep = counts >= 3
    kept = corners[keep[owner]].astype(np.int64)
    return counts[keep], kept, int((~keep).sum())

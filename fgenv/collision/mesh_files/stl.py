"""STL: binary and text. Every three corners are a face; corners have no indices."""

from __future__ import annotations

import re
import struct
from typing import NoReturn

import numpy as np

from fgenv.arrays import Floats

from .content import FileMesh, MeshSource
from .text import BadNumberError, check_finite, fail_number, numbers, shown, text_chunks

HEADER = 84  # bytes: a comment of 80, the number of faces
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])  # 50

# One letter per kind of line, so that a regular expression checks the order of lines.
KEYWORDS = {
    b"solid": "s",
    b"facet": "f",
    b"outer": "o",
    b"vertex": "v",
    b"endloop": "l",
    b"endfacet": "t",
    b"endsolid": "e",
    b"end": "d",  # `end solid`, as some programs write
}
NAMES = {letter: name.decode() for name, letter in KEYWORDS.items()}
FACET = "fovvvlt"
SOLID = re.compile(f"s?(?:{FACET})*+[ed]?")


def read_stl(source: MeshSource) -> FileMesh:
    """Read an STL file: binary if its size is what its header states, else text if it is text."""
    count = struct.unpack_from("<I", source.data, 80)[0] if len(source.data) >= HEADER else None
    fits = count is not None and len(source.data) == HEADER + RECORD.itemsize * count
    if not fits and _is_text(source.data):
        return _read_text(source)
    if count is None:
        source.fail(f"{len(source.data)} bytes", "an STL file: text, or a header of 84 bytes")
    if not fits:
        _fail_size(source, count)
    records = np.frombuffer(source.data, RECORD, count, HEADER)
    return _mesh("binary STL", records["corners"].reshape(-1, 3).astype(np.float64))


def _is_text(data: bytes) -> bool:
    head = data[:1024].lstrip(b"\xef\xbb\xbf \t\r\n").lower()
    return head.startswith((b"solid", b"facet")) and b"\0" not in data[:4096]


def _fail_size(source: MeshSource, count: int) -> NoReturn:
    size = len(source.data) - HEADER
    present, rest = divmod(size, RECORD.itemsize)
    if rest == 0 and count in (0, 0xFFFFFFFF):
        received = f"a header with {count} faces before {present} faces"
        source.fail(received, "their number; the program that wrote the file did not finish it")
    if present < count:
        received = f"a truncated file: {present} whole faces of the {count} in its header"
        source.fail(received, "all of them; copy or export it again")
    source.fail(
        f"{size - RECORD.itemsize * count} bytes after the {count} faces of its header",
        "none; export it again",
    )


def _mesh(name: str, corners: Floats, notes: tuple[str, ...] = ()) -> FileMesh:
    faces = np.arange(len(corners), dtype=np.int64).reshape(-1, 3)
    return FileMesh(name, corners, faces, notes=notes)


def _read_text(source: MeshSource) -> FileMesh:
    letters, corners = [], []
    for first, lines in text_chunks(source):
        words = [line.split(None, 1) for line in lines]
        kinds = "".join(KEYWORDS.get(w[0].lower(), "?") if w else "_" for w in words)
        if (bad := kinds.find("?")) >= 0 and b"endsolid".startswith(words[bad][0]):
            kinds = kinds[:bad] + "d" + kinds[bad + 1 :]  # the end of the file is cut off
            bad = kinds.find("?")
        if bad >= 0:
            source.fail(shown(words[bad][0]), "facet, vertex, endsolid, ...", line=first + bad)
        letters.append(kinds)
        rows = [w[1] if len(w) > 1 else b"" for w, k in zip(words, kinds, strict=True) if k == "v"]
        corners.append(_corners(source, rows, kinds, first))
    kinds = "".join(letters)
    notes = _check_order(source, kinds)
    return _mesh("ASCII STL", np.concatenate(corners), notes)


def _corners(source: MeshSource, rows: list[bytes], kinds: str, first: int) -> Floats:
    """The numbers of the lines that begin with `vertex`."""
    try:
        values, counts = numbers(rows)
    except BadNumberError as error:
        fail_number(source, error, first + _nth(kinds, error.index))
    if (counts != 3).any():
        bad = int(np.flatnonzero(counts != 3)[0])
        line = first + _nth(kinds, bad)
        source.fail(f"a vertex of {counts[bad]} numbers", "x, y and z", line=line)
    vertices = values.reshape(-1, 3)
    check_finite(source, vertices, lambda i: first + _nth(kinds, i))
    return vertices


def _nth(kinds: str, index: int) -> int:
    """Place of a vertex line among all lines."""
    return [i for i, kind in enumerate(kinds) if kind == "v"][index]


def _check_order(source: MeshSource, kinds: str) -> tuple[str, ...]:
    """Raise the error of the first line out of order; return notes on the lines of solids."""
    lines = [i for i, kind in enumerate(kinds) if kind != "_"] if "_" in kinds else None
    packed = kinds.replace("_", "")
    place = solids = closed = 0
    while place < len(packed):
        match = SOLID.match(packed, place)
        if match is None or match.end() == place:
            break
        solids += 1
        closed += packed[match.end() - 1] == "e"
        place = match.end()
    if place < len(packed):
        line = (lines[place] if lines else place) + 1
        _fail_order(source, packed, place, line)
    notes = []
    if closed < solids:
        notes.append("A solid has no endsolid line.")
    if solids > 1:
        notes.append(f"{solids} solids are joined.")
    return tuple(notes)


def _fail_order(source: MeshSource, packed: str, place: int, line: int) -> NoReturn:
    """The line out of order, or the end of the file, within a facet that begins at `place`."""
    rest = packed[place : place + 8]
    known = next(
        (i for i, (a, b) in enumerate(zip(rest, FACET, strict=False)) if a != b), len(rest)
    )
    if place + known >= len(packed):
        source.fail(
            "a truncated file: its last facet is not complete",
            f"a line with {NAMES[FACET[known]]}; copy or export it again",
            line=line + known,
        )
    expected = NAMES[FACET[known]] if known < 7 else "facet or endsolid"
    source.fail(f"a line with {NAMES[rest[known]]}", f"one with {expected}", line=line + known)

"""Points of PCD and PLY files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fgenv.scenarios.errors import cut

from .grids import count_in, fail, file_error, read_bytes

MAX_POINTS = 50_000_000
Points = NDArray[np.float64]
PCD_TYPES = {"F": "f", "I": "i", "U": "u"}
PLY_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2",
    "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8",
}  # fmt: skip
PLY_FORMATS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


def read_points(path: Path) -> Points:
    """The points (n, 3) of a file, in its unit; points that are not finite are left out.

    Raises:
        ScenarioError: another format, a truncated file, or no x, y, z.
    """
    data = read_bytes(path)
    points = read_ply(path, data) if path.suffix.lower() == ".ply" else read_pcd(path, data)
    return points[np.isfinite(points).all(axis=1)]


def read_pcd(path: Path, data: bytes) -> Points:
    """The points of a PCD file: ascii, binary or binary_compressed."""
    head, start = _pcd_header(path, data)
    names = head.get("FIELDS", head.get("COLUMNS", []))
    sizes, kinds = head.get("SIZE", []), head.get("TYPE", [])
    counts = head.get("COUNT", ["1"] * len(names))
    if not len(names) == len(sizes) == len(kinds) == len(counts) or not names:
        fail(path, "has FIELDS, SIZE, TYPE and COUNT of several lengths", "expected one for each")
    fields: list[tuple[str, str, tuple[int]]] = []
    for i, (name, size, kind, count) in enumerate(zip(names, sizes, kinds, counts, strict=True)):
        if kind not in PCD_TYPES or size not in ("1", "2", "4", "8") or kind + size in ("F1", "F2"):
            fail(path, f"has a field of {cut(kind + size, 20)!r}", "expected F4, F8, I or U 1 to 8")
        width = count_in(path, count, 1, 10_000)
        label = name if name in "xyz" and name not in [f[0] for f in fields] else f"{name} {i}"
        fields.append((label, f"<{PCD_TYPES[kind]}{size}", (width,)))
    record = _record(path, [f for f in fields if f[2] != (0,)])
    points = count_in(path, (head.get("POINTS") or ["?"])[0], 1, MAX_POINTS)
    form = (head.get("DATA") or ["?"])[0]
    if form == "ascii":
        return _ascii_points(path, data[start:], record, points)
    if form == "binary":
        return _binary_points(path, data, start, record, points)
    if form == "binary_compressed":
        return _compressed_points(path, data, start, record, points)
    expected = "expected ascii, binary or binary_compressed"
    raise file_error(path, f"has DATA {cut(form, 30)!r}", expected)


def _pcd_header(path: Path, data: bytes) -> tuple[dict[str, list[str]], int]:
    fields: dict[str, list[str]] = {}
    position = 0
    for _ in range(100):
        end = data.find(b"\n", position)
        if end < 0 or end - position > 100_000:
            break
        words = data[position:end].decode("latin-1").split()
        position = end + 1
        if words and not words[0].startswith("#"):
            fields[words[0]] = words[1:]
            if words[0] == "DATA":
                return fields, position
    expected = "expected FIELDS, SIZE, TYPE, POINTS and DATA"
    raise file_error(path, "has no PCD header", expected)


def _record(path: Path, fields: list[tuple[str, str, tuple[int]]]) -> np.dtype[np.void]:
    names = [field[0] for field in fields]
    for axis in "xyz":
        if axis not in names or fields[names.index(axis)][2] != (1,):
            fail(path, f"has no {axis}", "expected fields x, y and z")
    return np.dtype(fields)


def _ascii_points(path: Path, data: bytes, record: np.dtype[np.void], count: int) -> Points:
    width = sum(record[name].shape[0] for name in record.names or ())
    try:
        values = np.array(data.split(), dtype=np.float64)
    except ValueError:
        fail(path, "has values that are no numbers", "expected numbers in each line")
    if len(values) != width * count:
        fail(path, f"has {len(values)} values", f"expected {count} points of {width}")
    first = np.cumsum([0, *(record[name].shape[0] for name in record.names or ())])
    columns = [int(first[(record.names or ()).index(axis)]) for axis in "xyz"]
    return np.asarray(values.reshape(count, width)[:, columns])


def _binary_points(
    path: Path, data: bytes, start: int, record: np.dtype[np.void], count: int
) -> Points:
    if len(data) - start < count * record.itemsize:
        text = f"has {len(data) - start} bytes of data"
        fail(path, text, f"expected {count} points of {record.itemsize}: the file is truncated")
    table = np.frombuffer(data, record, count, start)
    return np.column_stack([table[axis].reshape(count).astype(np.float64) for axis in "xyz"])


def _compressed_points(
    path: Path, data: bytes, start: int, record: np.dtype[np.void], count: int
) -> Points:
    """Fields one after another, compressed by LZF."""
    packed, size = (
        int.from_bytes(data[start + 4 * i : start + 4 * i + 4], "little") for i in (0, 1)
    )
    body = data[start + 8 : start + 8 + packed]
    if len(body) != packed or size != count * record.itemsize:
        fail(path, f"has {len(body)} of {packed} bytes", "the file is truncated or damaged")
    raw = _unpacked(path, body, size)
    columns, position = {}, 0
    for name in record.names or ():
        kind, width = record[name].base, record[name].shape[0]
        columns[name] = np.frombuffer(raw, kind, count * width, position)
        position += count * width * kind.itemsize
    return np.column_stack([columns[axis].astype(np.float64) for axis in "xyz"])


def _unpacked(path: Path, data: bytes, size: int) -> bytes:
    """The content of data compressed by LZF (M. Lehmann's liblzf): literals and references."""
    out, i = bytearray(), 0
    try:
        while i < len(data) and len(out) <= size:
            control = data[i]
            i += 1
            if control < 32:
                out += data[i : i + control + 1]
                i += control + 1
                continue
            length = control >> 5
            if length == 7:
                length += data[i]
                i += 1
            back = ((control & 31) << 8 | data[i]) + 1
            i += 1
            if back > len(out):
                break
            piece = out[len(out) - back : len(out) - back + length + 2]
            out += (piece * ((length + 1) // back + 1))[: length + 2]  # it may repeat itself
    except IndexError:
        out.clear()
    if len(out) != size:
        fail(path, "has compressed data that is damaged", "get the file again")
    return bytes(out)


def read_ply(path: Path, data: bytes) -> Points:
    """The vertices of a PLY file without faces."""
    end = data.find(b"end_header")
    if not data.startswith(b"ply") or not 0 < end < 100_000:
        fail(path, "has no PLY header", "expected ply ... end_header", 1)
    start = data.find(b"\n", end) + 1
    lines = [line.split() for line in data[:end].decode("latin-1").splitlines()]
    form, elements = "", list[tuple[str, str, list[tuple[str, str, tuple[int]]]]]()
    for i, words in enumerate(lines[1:], start=2):
        if words[:1] == ["format"] and len(words) == 3:
            form = words[1]
        elif words[:1] == ["element"] and len(words) == 3:
            elements.append((words[1], words[2], []))
        elif words[:1] == ["property"] and elements:
            if len(words) == 3 and words[1] in PLY_TYPES:
                elements[-1][2].append((words[2], PLY_TYPES[words[1]], (1,)))
            elif elements[-1][0] == "vertex":
                fail(path, "has a list in its vertices", "expected numbers", i)
        elif words and words[0] not in ("comment", "obj_info", "property"):
            fail(path, f"got {cut(' '.join(words), 40)!r}", "expected a PLY header", i)
    if form not in PLY_FORMATS:
        fail(path, f"has format {cut(form, 30)!r}", f"expected {', '.join(PLY_FORMATS)}")
    for name, number, _ in elements:
        if name in ("face", "tristrips") and number != "0":
            fail(path, "has faces", "it is a mesh: use a shape of kind: mesh")
    if not elements or elements[0][0] != "vertex":
        fail(path, "does not begin with its vertices", "expected element vertex first")
    count = count_in(path, elements[0][1], 1, MAX_POINTS)
    order = PLY_FORMATS[form]
    fields = [(name, order + kind, width) for name, kind, width in elements[0][2]]
    if len({name for name, _, _ in fields}) < len(fields):
        fail(path, "has two properties of one name", "rename one")
    record = _record(path, fields)
    if form == "ascii":
        values = len(fields) * count
        body = b" ".join(data[start:].split(None, values)[:values])
        return _ascii_points(path, body, record, count)
    return _binary_points(path, data, start, record, count)

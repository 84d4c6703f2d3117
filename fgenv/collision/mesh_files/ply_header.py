"""The header of a PLY file: elements with their properties."""

from __future__ import annotations

from dataclasses import dataclass, field

from .content import MeshSource
from .text import shown

TYPES = {  # of PLY: of NumPy, without the order of bytes
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
FORMATS = {
    "ascii": ("ASCII", ""),
    "binary_little_endian": ("binary", "<"),
    "binary_big_endian": ("binary", ">"),
}
MAX_HEADER = 1 << 20  # bytes


@dataclass(frozen=True)
class Property:
    """A number per element, or a list of numbers."""

    name: str
    type: str  # of NumPy, with the order of bytes
    count_type: str | None = None  # of the length of a list


@dataclass
class Element:
    """A kind of element, e.g. vertex or face."""

    name: str
    count: int
    properties: list[Property] = field(default_factory=list)


@dataclass
class Header:
    """What a header states."""

    kind: str  # ASCII or binary
    order: str  # of bytes, as NumPy writes it; "" for ASCII
    elements: list[Element]
    end: int  # bytes of the header
    lines: int  # of the header


def read_header(source: MeshSource) -> Header:
    """Parse the header; raise the error of the first invalid line."""
    header = Header("", "", [], 0, 0)
    place = 0
    while True:
        end = source.data.find(b"\n", place, MAX_HEADER)
        if end < 0:
            if not source.data.startswith(b"ply"):
                source.fail("a first line other than ply", "a PLY file", line=1)
            source.fail("a header without its end", "the line end_header", line=header.lines + 1)
        words = source.data[place:end].decode("latin-1").split()
        place, header.lines = end + 1, header.lines + 1
        if header.lines == 1:
            if words != ["ply"]:
                source.fail("a first line other than ply", "a PLY file", line=1)
        elif words == ["end_header"]:
            header.end = place
            break
        elif words and words[0] not in ("comment", "obj_info"):
            _read_line(source, header, words)
    if not header.kind:
        source.fail("a header without a format", "e.g. the line format ascii 1.0")
    return header


def _read_line(source: MeshSource, header: Header, words: list[str]) -> None:
    line = header.lines
    if words[0] == "format":
        if len(words) != 3 or words[1] not in FORMATS or words[2] != "1.0":
            received = "the format " + shown(" ".join(words[1:]).encode())
            source.fail(received, f"one of {', '.join(FORMATS)} with 1.0", line=line)
        header.kind, header.order = FORMATS[words[1]]
    elif words[0] == "element":
        if len(words) != 3 or not (words[2].isascii() and words[2].isdigit()):
            source.fail("an invalid element", "a name and a number", line=line)
        if any(element.name == words[1] for element in header.elements):
            source.fail("an element named twice", "different names", line=line)
        header.elements.append(Element(words[1], int(words[2][:20])))
    elif words[0] == "property":
        _read_property(source, header, words[1:])
    else:
        source.fail(shown(words[0].encode()), "element, property or end_header", line=line)


def _read_property(source: MeshSource, header: Header, words: list[str]) -> None:
    line = header.lines
    if not header.elements:
        source.fail("a property before any element", "an element first", line=line)
    is_list = words[:1] == ["list"]
    types, names = words[is_list:-1], words[-1:]
    if len(types) != 1 + is_list or not all(name in TYPES for name in types):
        received = "the property " + shown(" ".join(words).encode())
        source.fail(received, "a type such as float or uint8, and a name", line=line)
    if any(p.name == names[0] for p in header.elements[-1].properties):
        source.fail("a property named twice", "different names", line=line)
    numpy_types = [header.order + TYPES[name] for name in types]
    if is_list and numpy_types[0][-2] == "f":
        source.fail("a list with a length of float type", "an integer type", line=line)
    count_type = numpy_types[0] if is_list else None
    header.elements[-1].properties.append(Property(names[0], numpy_types[-1], count_type))

"""The JSON of a glTF file, with checked access; the container of binary glTF."""

from __future__ import annotations

import json
import math
import struct
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NoReturn

import numpy as np

from fgenv.arrays import Floats

from .content import MeshSource

JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942
COMPRESSIONS = {
    "KHR_draco_mesh_compression": "Draco",
    "EXT_meshopt_compression": "meshopt",
    "KHR_meshopt_compression": "meshopt",
}
Item = Mapping[str, Any]


@dataclass
class GltfDocument:
    """A glTF document.

    Attributes:
        source: the file.
        content: the JSON object.
        binary: whether the file is a GLB.
        chunk: the binary chunk of a GLB; None if there is none.
        used: indices of the items of each kind that were read.
        skipped_extensions: names of optional extensions of the items that were read.
    """

    source: MeshSource
    content: Item
    binary: bool = False
    chunk: memoryview | None = None
    used: dict[str, set[int]] = field(default_factory=lambda: defaultdict(set))
    skipped_extensions: set[str] = field(default_factory=set)

    def items(self, kind: str) -> list[Any]:
        """All items of a kind, e.g. `meshes`."""
        return self.array(self.content, kind, "the file")

    def item(self, kind: str, index: object, place: str) -> Item:
        """An item by its index, which the place refers to."""
        items = self.items(kind)
        name = f"{kind}[{_short(index)}]"
        if isinstance(index, bool) or not isinstance(index, int) or not 0 <= index < len(items):
            self.fail(place, f"a reference to {name}", f"an index of the {len(items)} {kind}")
        if not isinstance(items[index], dict):
            self.fail(name, _short(items[index]), "an object")
        self.used[kind].add(index)
        item: Item = items[index]
        return item

    def array(self, item: Item, key: str, place: str) -> list[Any]:
        """An array of an item; empty if it is missing."""
        value = item.get(key, [])
        if not isinstance(value, list):
            self.fail(f"{place}: {key}", _short(value), "an array")
        return value

    def object(self, item: Item, key: str, place: str) -> Item:
        """An object of an item; empty if it is missing."""
        value = item.get(key, {})
        if not isinstance(value, dict):
            self.fail(f"{place}: {key}", _short(value), "an object")
        return value

    def whole(self, item: Item, key: str, place: str, default: int | None = None) -> int:
        """A whole number of an item, 0 or more."""
        value = item.get(key, default)
        if isinstance(value, float) and value.is_integer():
            value = int(value)  # 3.0 is the integer 3 in JSON
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**53:
            self.fail(f"{place}: {key}", _short(value), "a whole number, 0 or more")
        return value

    def numbers(self, item: Item, key: str, place: str, count: int | None = None) -> Floats | None:
        """Finite numbers of an item; None if they are missing."""
        if key not in item:
            return None
        values = self.array(item, key, place)
        if not all(_is_finite(x) for x in values) or count not in (None, len(values)):
            size = "" if count is None else f"{count} "
            self.fail(f"{place}: {key}", _short(values), f"{size}finite numbers")
        return np.array(values, dtype=np.float64)

    def names(self, key: str) -> list[str]:
        """A list of names of the document."""
        names = self.array(self.content, key, "the file")
        if not all(isinstance(name, str) for name in names):
            self.fail(key, _short(names), "names")
        return names

    def extensions(self, item: Item, place: str, read: tuple[str, ...] = ()) -> Item:
        """The extensions of an item; those that are not read are noted."""
        extensions = self.object(item, "extensions", place)
        self.skipped_extensions.update(
            name[:60] for name in extensions if name not in read and name not in COMPRESSIONS
        )
        return extensions

    def refuse_compression(self, extensions: Item, place: str) -> None:
        """Raise the error of compressed geometry if one of the extensions compresses."""
        for name in extensions:
            if name in COMPRESSIONS:
                method = COMPRESSIONS[name]
                self.fail(
                    place,
                    f"data compressed by {method} ({name})",
                    f"uncompressed data; export without {method} compression",
                )

    def fail(self, place: str, received: str, expected: str) -> NoReturn:
        """Raise the error of an item."""
        self.source.fail(f"{received} in {place}", expected)


def parse_document(source: MeshSource) -> GltfDocument:
    """The document of a glTF file: binary if it has the mark of one, whatever its suffix."""
    if source.data[:4] == b"glTF":
        text, chunk = _chunks(source)
        document = GltfDocument(source, _parse_json(source, text), True, chunk)
    else:
        if source.suffix == ".glb":
            source.fail("no header of binary glTF", "a GLB file; copy or download it again")
        document = GltfDocument(source, _parse_json(source, source.data))
    _check_version(document)
    return document


def _chunks(source: MeshSource) -> tuple[bytes, memoryview | None]:
    """The JSON and the binary chunk of a GLB."""
    data = memoryview(source.data)
    if len(data) < 20:
        source.fail(f"{len(data)} bytes", "a GLB file; it is truncated")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        source.fail(f"binary glTF of version {version}", "version 2; export it again")
    if length != len(data):
        kind = "it is truncated" if length > len(data) else "there are bytes after its end"
        source.fail(f"{len(data)} bytes", f"the {length} bytes that the header states; {kind}")
    chunks: list[tuple[int, memoryview]] = []
    at = 12
    while at < length:
        if at + 8 > length:
            source.fail(f"{length - at} bytes after the last chunk", "a chunk or the end")
        size, kind_code = struct.unpack_from("<II", data, at)
        if at + 8 + size > length:
            source.fail(
                f"a chunk of {size} bytes", f"at most the {length - at - 8} bytes that are left"
            )
        chunks.append((kind_code, data[at + 8 : at + 8 + size]))
        at += 8 + size
    if chunks[0][0] != JSON_CHUNK:
        source.fail("a first chunk of another type", "JSON; export it again")
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == BINARY_CHUNK else None
    return bytes(chunks[0][1]).rstrip(b"\0 "), binary  # several writers fill with zeros


def _parse_json(source: MeshSource, text: bytes) -> Item:
    try:
        content = json.loads(text.decode("utf-8-sig"), parse_constant=_refuse_constant)
    except json.JSONDecodeError as error:
        source.fail(f"invalid JSON ({error.msg})", "a glTF file", line=error.lineno)
    except UnicodeDecodeError:
        source.fail("text that is not UTF-8", "a glTF file; export it again")
    except (ValueError, RecursionError) as error:  # NaN, a number of 5,000 digits, deep nesting
        reason = str(error).splitlines()[0][:80]
        source.fail(f"invalid JSON ({reason})", "a glTF file; export it again")
    if not isinstance(content, dict):
        source.fail("JSON that is no object", "a glTF file")
    return content


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"the number {name}")


def _check_version(document: GltfDocument) -> None:
    if "asset" not in document.content:
        document.source.fail("JSON without `asset`", "a glTF 2.0 file")
    asset = document.object(document.content, "asset", "the file")
    for key in ("version", "minVersion"):
        version = asset.get(key, None if key == "version" else "2.0")
        major, _, minor = str(version).partition(".")
        if major != "2" or (key == "minVersion" and minor != "0"):
            document.fail(f"asset.{key}", _short(version), "2.0; export it as glTF 2.0")


def _is_finite(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer over 1e308
        return False


def _short(value: object) -> str:
    """A value of a file for a message."""
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, list) and len(value) > 16:
        return f"an array of {len(value)}"
    try:
        text = repr(value)
    except ValueError:  # an integer of over 4,300 digits
        return "a long number"
    return text if len(text) <= 60 else text[:60] + "..."

"""Buffers, views and accessors of glTF: arrays of numbers, checked against their sizes."""

from __future__ import annotations

import base64
import binascii
from typing import Any
from urllib.parse import unquote, unquote_to_bytes, urlsplit

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats, Ints

from .files import read_mesh_bytes
from .gltf_document import GltfDocument, Item

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
MAX_IMPLICIT = 1 << 22  # elements of all accessors without a view, which are zeros


class AccessorReader:
    """Arrays of the accessors of a document; each buffer and array is read once."""

    def __init__(self, document: GltfDocument) -> None:
        self.document = document
        self._buffers: dict[int, memoryview] = {}
        self._arrays: dict[int, NDArray[Any]] = {}  # floats as float64, to share the copy
        self._implicit = 0  # elements of accessors without a view

    def floats(self, index: object, kind: str, place: str) -> Floats:
        """Values (n, width) of an accessor, normalized integers as fractions."""
        accessor, array = self._read(index, kind, place)
        if not accessor.get("normalized", False):
            return array.astype(np.float64, copy=False)
        if array.dtype.kind == "f" or array.dtype.itemsize > 2:
            name = f"accessors[{index}]"
            self.document.fail(name, "normalized values of 32 bits", "integers of 8 or 16 bits")
        fractions: Floats = array / float(np.iinfo(array.dtype).max)
        return np.maximum(fractions, -1.0)

    def indices(self, index: object, kind: str, place: str) -> Ints:
        """Unsigned integers (n, width) of an accessor."""
        accessor, array = self._read(index, kind, place)
        if array.dtype.kind != "u" or accessor.get("normalized", False):
            received = f"the component type {accessor.get('componentType')}"
            self.document.fail(f"accessors[{index}]", received, "unsigned integers, for indices")
        return array.astype(np.int64)

    def _read(self, index: object, kind: str, place: str) -> tuple[Item, NDArray[Any]]:
        accessor = self.document.item("accessors", index, place)
        assert isinstance(index, int)
        name = f"accessors[{index}]"
        if accessor.get("type") != kind:
            text = str(accessor.get("type"))[:20]
            self.document.fail(name, f"the type {text}", f"{kind}, for {place}")
        if index not in self._arrays:
            array = self._array(accessor, name)
            if array.dtype.kind == "f":
                with np.errstate(invalid="ignore"):  # a signaling NaN warns; refused below
                    array = array.astype(np.float64)
                if not np.isfinite(array).all():
                    self.document.fail(name, "NaN or infinity", "finite numbers")
            self._arrays[index] = array
        return accessor, self._arrays[index]

    def _array(self, accessor: Item, name: str) -> NDArray[Any]:
        document = self.document
        dtype = self._dtype(accessor, name)
        count, width = document.whole(accessor, "count", name), WIDTHS[accessor["type"]]
        extensions = document.extensions(accessor, name)
        if "bufferView" in accessor:
            offset = document.whole(accessor, "byteOffset", name, 0)
            array = self._view(accessor["bufferView"], offset, count, width, dtype, name)
        elif extensions:
            document.fail(name, "no bufferView", "data; an extension that is not read has them")
        else:
            self._implicit += count
            if self._implicit > MAX_IMPLICIT:
                received = f"over {MAX_IMPLICIT} elements without a bufferView in the file"
                document.fail(name, received, "data")
            array = np.zeros((count, width), dtype)
        return self._replaced(accessor, array, name) if "sparse" in accessor else array

    def _dtype(self, accessor: Item, name: str) -> np.dtype[Any]:
        code = accessor.get("componentType")
        if isinstance(code, bool) or not isinstance(code, int) or code not in COMPONENTS:
            known = ", ".join(map(str, COMPONENTS))
            self.document.fail(name, f"the component type {str(code)[:20]}", f"one of {known}")
        return np.dtype(COMPONENTS[code])

    def _replaced(self, accessor: Item, array: NDArray[Any], name: str) -> NDArray[Any]:
        """The array with the values of `sparse` in place of those at its indices."""
        document, place = self.document, f"{name}.sparse"
        sparse = document.object(accessor, "sparse", name)
        count = document.whole(sparse, "count", place)
        parts = []
        for key, width in (("indices", 1), ("values", array.shape[1])):
            part = document.object(sparse, key, place)
            dtype = self._dtype(part, f"{place}.{key}") if key == "indices" else array.dtype
            offset = document.whole(part, "byteOffset", f"{place}.{key}", 0)
            view = part.get("bufferView")
            parts.append(self._view(view, offset, count, width, dtype, f"{place}.{key}"))
        indices = parts[0][:, 0].astype(np.int64)
        if (indices < 0).any() or (indices >= len(array)).any():
            document.fail(place, "an index out of range", f"indices below {len(array)}")
        array = array.copy()
        array[indices] = parts[1]
        return array

    def _view(
        self, index: object, offset: int, count: int, width: int, dtype: np.dtype[Any], name: str
    ) -> NDArray[Any]:
        """Elements (count, width) of a buffer view, from a byte offset."""
        document = self.document
        view = document.item("bufferViews", index, name)
        place = f"bufferViews[{index}]"
        document.refuse_compression(document.extensions(view, place, ()), place)
        start = document.whole(view, "byteOffset", place, 0)
        length = document.whole(view, "byteLength", place)
        buffer = self._buffer(view.get("buffer"), place)
        if start + length > len(buffer):
            document.fail(
                place, f"bytes {start} to {start + length}", f"at most {len(buffer)}, the buffer"
            )
        size = width * dtype.itemsize
        stride = document.whole(view, "byteStride", place, size)
        if stride < size:
            document.fail(place, f"a byteStride of {stride}", f"at least {size}, for {name}")
        needed = offset + (stride * (count - 1) + size if count else 0)
        if needed > length:
            document.fail(name, f"{count} elements ({needed} bytes)", f"at most {length}, {place}")
        content = buffer[start : start + length]
        array: NDArray[Any] = np.ndarray(
            (count, width), dtype, content, offset, (stride, dtype.itemsize)
        )
        return array

    def _buffer(self, index: object, place: str) -> memoryview:
        buffer = self.document.item("buffers", index, place)
        assert isinstance(index, int)
        if index not in self._buffers:
            self._buffers[index] = self._content(buffer, index)
        return self._buffers[index]

    def _content(self, buffer: Item, index: int) -> memoryview:
        document, name = self.document, f"buffers[{index}]"
        length = document.whole(buffer, "byteLength", name)
        if "uri" in buffer:
            data = memoryview(uri_content(document, buffer["uri"], name))
        elif index == 0 and document.chunk is not None:
            data = document.chunk
        else:
            document.refuse_compression(document.extensions(buffer, name), name)
            document.fail(name, "no data", "a uri, or the binary chunk of a GLB")
        if length > len(data):
            document.fail(
                name,
                f"{len(data)} bytes{_source(buffer)}",
                f"the {length} bytes of its byteLength; it is truncated",
            )
        return data[:length]


def _source(buffer: Item) -> str:
    """The file of a buffer, for messages."""
    uri = buffer.get("uri")
    outside = isinstance(uri, str) and uri[:5].lower() != "data:"
    return f" in the file {str(uri)[:80]!r}" if outside else ""


def uri_content(document: GltfDocument, uri: object, place: str) -> bytes:
    """Bytes of a data URI, or of a file relative to the document."""
    if not isinstance(uri, str):
        document.fail(f"{place}: uri", str(uri)[:20], "text")
    if uri[:5].lower() == "data:":
        return _data_uri(document, uri, place)
    shown = uri if len(uri) <= 80 else uri[:80] + "..."
    if urlsplit_scheme(uri) or uri.startswith(("/", "\\")):
        document.fail(f"{place}: uri", repr(shown), "a path relative to the glTF file")
    path = document.source.path.parent / unquote(uri)
    try:
        return read_mesh_bytes(path)
    except (FileNotFoundError, ValueError) as error:
        reason = str(error).partition(", expected")[0].removeprefix("path: ")
        document.fail(place, f"a file that cannot be read ({reason})", "the buffer's data")


def urlsplit_scheme(uri: str) -> bool:
    """Whether a URI has a scheme or a host, e.g. `http:` or `C:`."""
    try:
        parts = urlsplit(uri)
    except ValueError:  # an invalid host
        return True
    return bool(parts.scheme or parts.netloc)


def _data_uri(document: GltfDocument, uri: str, place: str) -> bytes:
    header, comma, data = uri.partition(",")
    if not comma:
        document.fail(f"{place}: uri", "a data URI without a comma", "data:...;base64,...")
    content = unquote_to_bytes(data)
    if not header.lower().endswith(";base64"):
        return content
    try:
        return base64.b64decode(content, validate=True)
    except (binascii.Error, ValueError):
        document.fail(f"{place}: uri", "invalid base64 data", "a complete file; export it again")

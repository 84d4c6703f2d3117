"""Containers of glTF: text, and the chunks of binary glTF."""

from __future__ import annotations

import json
import struct
from typing import NoReturn

from .content import MeshSource
from .gltf_document import GltfDocument, Item, shown

JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942


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
            document.fail(f"asset.{key}", shown(version), "2.0; export it as glTF 2.0")

"""XML documents of robots, which may be untrusted: regular files of bounded size, no entities."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

from fgenv.collision.mesh_files import MeshSource
from fgenv.collision.mesh_files.xml_tree import Element, parse_xml

MAX_BYTES = 64_000_000
MAX_LINKS = 2000  # pairs of links take time


def read_document(path: Path, expected: str, max_bytes: int = MAX_BYTES) -> Element:
    """The root element of an XML file.

    Args:
        expected: e.g. "an MJCF file", for messages.

    Raises:
        FileNotFoundError: no such file.
        ValueError: not a regular file, too large, malformed XML, or entities; with the line.
    """
    check_regular(path, expected, max_bytes)
    data = path.read_bytes().lstrip()
    if not data:
        raise ValueError(f"path: {path} is empty, expected {expected}")
    return parse_xml(MeshSource(path, path.suffix.lower(), data), data)


def check_regular(path: Path, expected: str, max_bytes: int) -> None:
    """Raise the error of a path that is not a regular file of bounded size."""
    try:
        there, regular = path.exists(), path.is_file()
    except (OSError, ValueError) as error:  # a loop of links, a null character
        reason = getattr(error, "strerror", None) or str(error)
        raise ValueError(f"path: {path} cannot be read ({reason}), expected {expected}") from None
    if not there:
        raise FileNotFoundError(f"path: {path} does not exist, expected {expected}")
    if not regular:
        kind = "folder" if path.is_dir() else "device or pipe"
        error_type = FileNotFoundError if path.is_dir() else ValueError
        raise error_type(f"path: {path} is a {kind}, expected {expected}")
    if path.stat().st_size > max_bytes:
        raise ValueError(f"path: {path}: got over {max_bytes:,} bytes, expected {expected}")


def fail(path: Path, element: Element, received: str, expected: str) -> NoReturn:
    """Raise the ValueError of an element: file, line, element, value received, value expected."""
    raise ValueError(f"{path}: line {element.line}: {element}: {received}, expected {expected}")

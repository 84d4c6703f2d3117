"""XML documents of robots, which may be untrusted: regular files of bounded size, no entities."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

from fgenv.collision.mesh_files import MeshSource
from fgenv.collision.mesh_files.xml_tree import Element, parse_xml
from fgenv.regular_file import read_regular

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
    data = read_regular(path, expected, max_bytes).lstrip()
    if not data:
        raise ValueError(f"path: {path} is empty, expected {expected}")
    return parse_xml(MeshSource(path, path.suffix.lower(), data), data)


def fail(path: Path, element: Element, received: str, expected: str) -> NoReturn:
    """Raise the ValueError of an element: file, line, element, value received, value expected."""
    raise ValueError(f"{path}: line {element.line}: {element}: {received}, expected {expected}")

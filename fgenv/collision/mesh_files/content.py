"""Interface of the readers of mesh files: the bytes of a file, and the mesh in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from fgenv.arrays import Faces, Vertices
from fgenv.printable import printable


@dataclass(frozen=True)
class Unit:
    """A unit of length that a file states, or that its format implies."""

    name: str
    meters: float  # per unit


def ignore_progress(share: float) -> None:
    """Do nothing: no one looks at the progress."""


@dataclass(frozen=True)
class MeshSource:
    """The content of a mesh file.

    Attributes:
        path: the file, for messages and for files that it refers to.
        suffix: lower case, with its dot, of the mesh itself: `.stl` for `part.STL.gz`.
        data: the bytes, unpacked.
        progress: called by readers of long texts with the share that is read.
    """

    path: Path
    suffix: str
    data: bytes
    progress: Callable[[float], None] = ignore_progress

    def fail(self, received: str, expected: str, *, line: int | None = None) -> NoReturn:
        """Raise the ValueError of unreadable content: place, value received, value expected."""
        at = "" if line is None else f" line {line}:"
        raise ValueError(printable(f"path: {self.path}:{at} got {received}, expected {expected}"))


@dataclass(frozen=True)
class FileMesh:
    """The triangles that a mesh file specifies.

    A reader returns vertices in the unit of the file. `read_mesh_file` alone applies the unit, for
    every caller: it returns vertices in meters, and `unit` is the one that it has applied.

    Attributes:
        format: e.g. "binary STL".
        vertices: (n, 3), placed as the scene of the file places them.
        faces: (m, 3), indices of vertices, counter-clockwise seen from outside.
        unit: of lengths; None if the format has none, which means meters.
        up: the up axis that the file states ("x", "y" or "z"); None if the format has none. Axes
            are never converted.
        polygons: number of faces with more than three corners, which were triangulated.
        nonplanar: number of polygons with corners outside one plane.
        notes: sentences on anything else that the file has and the mesh does not.
    """

    format: str
    vertices: Vertices
    faces: Faces
    unit: Unit | None = None
    up: str | None = None
    polygons: int = 0
    nonplanar: int = 0
    notes: tuple[str, ...] = ()

"""Independent readers of mesh files, and the measures that they are compared by."""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.collision.mesh_files import read_mesh_file
from fgenv.collision.mesh_files.report import area_and_volume

Triangles = tuple[Floats, NDArray[np.integer]]  # vertices (n, 3), faces (m, 3)
SINGLE = 1e-5  # relative; assimp and STL have single precision
REFUSED = (Exception, SystemExit)  # readers raise any exception of their parsers


@dataclass(frozen=True)
class Measures:
    """Area, signed volume about the middle of the box, and sorted extents, in meters.

    Vertices without faces do not count.
    """

    faces: int
    area: float
    volume: float
    extents: tuple[float, float, float]

    @classmethod
    def of(cls, triangles: Triangles) -> Measures:
        """Measure triangles; ValueError without any."""
        vertices, faces = triangles
        if len(faces) == 0:
            raise ValueError("no faces")
        used, corners = np.unique(faces, return_inverse=True)
        points = vertices[used]
        area, volume = area_and_volume(points, corners.reshape(-1, 3).astype(np.int64))
        x, y, z = np.sort(np.ptp(points, axis=0)).tolist()
        return cls(len(faces), area, volume, (x, y, z))

    def scaled(self, k: float) -> Measures:
        """Return the measures with all lengths k times as long."""
        x, y, z = (k * length for length in self.extents)
        return Measures(self.faces, k**2 * self.area, k**3 * self.volume, (x, y, z))

    def difference(self, other: Measures) -> str:
        """Return the first measure that differs: extents, area or volume; '' if none does.

        Extents are sorted, since some readers turn the up axis. Volumes are compared in parts of
        the product of area and size, of which the volume of an open surface may be a small part.
        """
        size = max(self.extents)
        if (
            max(abs(a - b) for a, b in zip(self.extents, other.extents, strict=True))
            > SINGLE * size
        ):
            return "extents"
        if abs(self.area - other.area) > 10 * SINGLE * self.area:
            return "area"
        return "volume" if abs(self.volume - other.volume) > SINGLE * self.area * size else ""


def fgenv(path: Path) -> Triangles:
    """Our own reader."""
    mesh = read_mesh_file(path)
    return mesh.vertices, mesh.faces


def assimp(path: Path) -> Triangles:
    """Open Asset Import Library, by assimp-py; it turns the up axis to y."""
    import assimp_py

    flags = assimp_py.Process_Triangulate | assimp_py.Process_PreTransformVertices
    scene = assimp_py.import_file(str(path), flags | assimp_py.Process_SortByPType)
    parts = [
        (np.asarray(m.vertices, np.float64).reshape(-1, 3), np.asarray(m.indices).reshape(-1, 3))
        for m in scene.meshes
    ]
    return joined(parts)


def meshio(path: Path) -> Triangles:
    """Meshio; only of files without polygons of more than four corners."""
    import meshio as reader

    mesh = reader.read(path)
    points = np.asarray(mesh.points, np.float64)[:, :3]
    parts: list[Triangles] = []
    for cells in mesh.cells:
        if cells.type == "quad":
            parts += [(points, cells.data[:, [0, 1, 2]]), (points, cells.data[:, [0, 2, 3]])]
        elif cells.type == "triangle":
            parts.append((points, cells.data))
        elif cells.type not in ("vertex", "line"):
            raise ValueError(f"cells of type {cells.type}")
    return joined(parts)


def trimesh(path: Path) -> Triangles:
    """Trimesh, without its repairs; COLLADA through pycollada."""
    import trimesh as reader

    mesh: Any = reader.load(path, force="mesh", process=False)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


PEERS: dict[str, Callable[[Path], Triangles]] = {
    "assimp": assimp,
    "meshio": meshio,
    "trimesh": trimesh,
}


def measured(read: Callable[[Path], Triangles], path: Path) -> Measures | str:
    """Return the measures of a file, or the reason for which a reader refuses it."""
    with warnings.catch_warnings(), silent():
        warnings.simplefilter("ignore")
        try:
            return Measures.of(read(path))
        except REFUSED as error:
            lines = str(error).strip().splitlines()
            return f"{type(error).__name__}: {lines[0] if lines else ''}"[:200]


def joined(parts: list[Triangles]) -> Triangles:
    """Return all triangles as one mesh."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    faces = [faces + start for (_, faces), start in zip(parts, starts, strict=False)]
    if not faces:
        return np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    return np.concatenate([vertices for vertices, _ in parts]), np.concatenate(faces)


@contextlib.contextmanager
def silent() -> Iterator[None]:
    """Drop what a reader prints."""
    sink: Any = io.StringIO()
    with contextlib.redirect_stdout(sink), contextlib.redirect_stderr(sink):
        yield

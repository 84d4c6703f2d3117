"""Writers of mesh files: STL, OBJ and GLB."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from fgenv.arrays import Floats, Vertices
from fgenv.saving import save_bytes

STL_HEADER = b"fgenv: meters, z up".ljust(80)
FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@dataclass(frozen=True, eq=False)
class PlacedMesh:
    """A mesh at its pose.

    Attributes:
        name: unique in a file, without line breaks.
        vertices: (n, 3), meters.
        faces: (m, 3), indices of vertices.
        pose: (4, 4), from the mesh's frame to the world.
    """

    name: str
    vertices: Vertices
    faces: NDArray[np.integer]
    pose: Floats

    @property
    def points(self) -> Vertices:
        """Vertices in the world, (n, 3); unchanged at the identity."""
        if np.array_equal(self.pose, np.eye(4)):
            return self.vertices
        return np.asarray(self.vertices @ self.pose[:3, :3].T + self.pose[:3, 3])


def write_meshes(meshes: Sequence[PlacedMesh], path: str | Path) -> None:
    """Write meshes to one file; the suffix of its name is the format.

    OBJ and GLB keep each mesh as an object of its name; STL joins them.

    Raises:
        ValueError: no mesh, or an unknown format.
        OSError: the file cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() not in FORMATS:
        expected = ", ".join(FORMATS)
        raise ValueError(f"path: got {path}, expected a name that ends in one of {expected}")
    if not meshes:
        raise ValueError("meshes: got none, expected one or more")
    save_bytes(path, FORMATS[path.suffix.lower()](meshes))


def stl(meshes: Sequence[PlacedMesh]) -> bytes:
    """Return a binary STL file: single precision."""
    facets = np.concatenate([_facets(mesh) for mesh in meshes])
    return STL_HEADER + np.uint32(len(facets)).tobytes() + facets.tobytes()


def obj(meshes: Sequence[PlacedMesh]) -> bytes:
    """Return an OBJ file: the shortest decimals that give the same numbers."""
    out, first = StringIO(), 1
    out.write("# fgenv: meters, z up\n")
    for mesh in meshes:
        out.write(f"o {mesh.name}\n")
        out.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in mesh.points.tolist())
        out.writelines(f"f {a} {b} {c}\n" for a, b, c in (mesh.faces + first).tolist())
        first += len(mesh.vertices)
    return out.getvalue().encode()


def glb(meshes: Sequence[PlacedMesh]) -> bytes:
    """Return a binary glTF file: vertices in single precision, a node with its pose per mesh."""
    scene = trimesh.Scene()
    for mesh in meshes:
        geometry = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        scene.add_geometry(geometry, node_name=mesh.name, geom_name=mesh.name, transform=mesh.pose)
    content: bytes = scene.export(file_type="glb")
    return content


FORMATS: Mapping[str, Callable[[Sequence[PlacedMesh]], bytes]] = {
    ".stl": stl,
    ".obj": obj,
    ".glb": glb,
}


def _facets(mesh: PlacedMesh) -> NDArray[np.void]:
    corners = mesh.points.astype(np.float32)[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets = np.zeros(len(corners), dtype=FACET)
    facets["corners"] = corners
    facets["normal"] = np.divide(normals, lengths, where=lengths > 0, out=np.zeros_like(normals))
    return facets

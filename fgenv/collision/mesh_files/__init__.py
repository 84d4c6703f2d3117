"""Mesh files, read as they specify: one module per format, and one interface (`content`)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from fgenv.collision.feature_graph import is_number

from .collada import read_collada
from .content import FileMesh, MeshSource, Unit, ignore_progress
from .files import open_mesh
from .gltf import read_gltf
from .obj import read_obj
from .off import read_off
from .ply import read_ply
from .report import FileSummary, MeshReport
from .stl import read_stl
from .threemf import read_threemf
from .units import unit_warning

__all__ = [
    "READERS",
    "FileMesh",
    "FileSummary",
    "MeshReport",
    "MeshSource",
    "Unit",
    "read_mesh_file",
    "unit_warning",
]

READERS: Mapping[str, Callable[[MeshSource], FileMesh]] = {
    ".stl": read_stl,
    ".obj": read_obj,
    ".ply": read_ply,
    ".off": read_off,
    ".glb": read_gltf,
    ".gltf": read_gltf,
    ".dae": read_collada,
    ".zae": read_collada,
    ".3mf": read_threemf,
}


def read_mesh_file(
    path: Path, scale: float = 1.0, progress: Callable[[float], None] = ignore_progress
) -> FileMesh:
    """Read a mesh file; vertices are in meters, multiplied by scale after the file's unit.

    A file may be packed: `part.stl.gz`, or a .zip with exactly one mesh. Axes are not converted:
    `FileMesh.up` is the up axis that the file states. `progress` is called with the share of a long
    text that is read.

    Raises:
        FileNotFoundError: no such file.
        ValueError: not a regular file, unknown format, damaged content, or no faces; the message
            names the file, the line or element, and the remedy.
    """
    if not (is_number(scale) and math.isfinite(scale) and scale > 0):
        raise ValueError(f"scale: got {scale!r}, expected a factor over 0")
    source = replace(open_mesh(path, READERS), progress=progress)
    mesh = READERS[source.suffix](source)
    _check(source, mesh)
    factor = scale * (1.0 if mesh.unit is None else mesh.unit.meters)
    return mesh if factor == 1.0 else replace(mesh, vertices=mesh.vertices * factor)


def _check(source: MeshSource, mesh: FileMesh) -> None:
    """Raise the error of a mesh that no reader may return."""
    if not np.isfinite(mesh.vertices).all():
        bad = int(np.flatnonzero(~np.isfinite(mesh.vertices).all(axis=1))[0])
        value = next(float(x) for x in mesh.vertices[bad] if not math.isfinite(x))
        source.fail(f"vertex {bad} (from 0) with the coordinate {value}", "finite coordinates")
    if len(mesh.faces) == 0:
        rest = "; ".join(["export a mesh with faces", *mesh.notes])
        source.fail(f"no faces ({len(mesh.vertices)} vertices)", f"a surface; {rest}")

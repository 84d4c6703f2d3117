"""Mesh files, read as they specify: one module per format, and one interface (`content`)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from fgenv.collision.feature_graph import is_number

from .content import FileMesh, MeshSource, Unit

__all__ = ["FileMesh", "MeshSource", "Unit", "read_mesh_file"]

READERS: Mapping[str, Callable[[MeshSource], FileMesh]] = {}


def read_mesh_file(path: Path, scale: float = 1.0) -> FileMesh:
    """Read a mesh file; vertices are in meters, multiplied by scale after the file's unit.

    Axes are not converted: `FileMesh.up` is the up axis that the file states.

    Raises:
        FileNotFoundError: no such file.
        ValueError: empty, unknown format, unreadable, or without faces.
    """
    if not (is_number(scale) and math.isfinite(scale) and scale > 0):
        raise ValueError(f"scale: got {scale!r}, expected a factor over 0")
    if not path.is_file():
        what = "is a folder" if path.is_dir() else "does not exist"
        raise FileNotFoundError(f"path: {path} {what}, expected a mesh file")
    if path.stat().st_size == 0:
        raise ValueError(f"path: {path} is empty, expected a mesh file")
    suffix = path.suffix.lower()
    if suffix in READERS:
        mesh = READERS[suffix](MeshSource(path, suffix, path.read_bytes()))
    else:
        mesh = _read_by_trimesh(path)
    factor = scale * (1.0 if mesh.unit is None else mesh.unit.meters)
    return mesh if factor == 1.0 else replace(mesh, vertices=mesh.vertices * factor)


def _read_by_trimesh(path: Path) -> FileMesh:
    import trimesh

    known = sorted(trimesh.available_formats())
    if path.suffix.lower().lstrip(".") not in known:
        raise ValueError(f"path: {path} has an unknown format, expected one of {', '.join(known)}")
    try:
        mesh = trimesh.load_mesh(path, process=False)
    except Exception as error:  # trimesh passes on any exception of its readers
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ValueError(f"path: {path} cannot be read ({reason}), export it again") from error
    vertices = np.asarray(getattr(mesh, "vertices", ()), dtype=np.float64)
    faces = np.asarray(getattr(mesh, "faces", ()), dtype=np.int64)
    if faces.size == 0:
        raise ValueError(f"path: {path} has no faces, expected a triangle mesh")
    return FileMesh(path.suffix.lower().lstrip(".").upper(), vertices, faces)

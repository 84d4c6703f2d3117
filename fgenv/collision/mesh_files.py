"""Mesh files, read with trimesh but without its repairs."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .feature_graph import is_number


def read_mesh_file(path: Path, scale: float = 1.0) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices (n, 3) in meters and faces (m, 3) of a mesh file.

    Axes are not converted: a COLLADA or GLB file keeps its own up axis.

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
    return vertices * scale, faces

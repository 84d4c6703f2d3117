"""Meshes of robot links and scenes in pip packages."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

# Folder with meshes and module of each package. The modules are not imported: some print text, and
# some start a simulator.
FOLDERS = {
    "example-robot-data": ("cmeel.prefix/share/example-robot-data/robots", "example_robot_data"),
    "pybullet": ("pybullet_data", "pybullet_data"),
    "gymnasium-robotics": ("gymnasium_robotics/envs/assets", "gymnasium_robotics"),
    "rtb-data": ("rtbdata", "rtbdata"),
}


@dataclass(frozen=True)
class Mesh:
    """Triangles of one body; `vertices` (n, 3) in meters, `faces` (m, 3)."""

    name: str
    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    @property
    def size(self) -> float:
        """Length of the diagonal of the bounding box, meters."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))


def is_installed(package: str) -> bool:
    """Return whether `package` is installed."""
    try:
        distribution(package)
    except PackageNotFoundError:
        return False
    return True


def folder(package: str) -> Path:
    """Return the folder with the meshes of `package`; ModuleNotFoundError if it is missing."""
    path, module = FOLDERS[package]
    if not is_installed(package):
        raise ModuleNotFoundError(
            f'{package}: not installed, it has the meshes; remedy: pip install "fgenv[bench]"',
            name=module,
        )
    return Path(str(distribution(package).locate_file(path)))


@cache
def load(package: str, path: str, scale: float = 1.0) -> Mesh:
    """Load ``path`` inside the mesh folder of `package`; equal vertices are merged."""
    mesh = trimesh.load(folder(package) / path, force="mesh")
    assert isinstance(mesh, trimesh.Trimesh)
    return Mesh(
        Path(path).stem,
        np.ascontiguousarray(mesh.vertices, np.float64) * scale,
        np.ascontiguousarray(mesh.faces, np.int32),
    )

"""Shapes of the mesh files that a robot file refers to, each read once."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.collision import Shape
from fgenv.collision.mesh_files import read_mesh_file
from fgenv.printable import printable

from .mesh_location import PackagePaths, find_mesh


@dataclass
class MeshShapes:
    """Reader of the mesh files of one robot file.

    Attributes:
        path: the robot file, for relative paths and messages.
        packages: folders that are searched first.
        scale: factor of all lengths, after the unit of a mesh file.
        options: of Shape.
    """

    path: Path
    packages: PackagePaths
    scale: float
    options: dict[str, Any]
    shapes: dict[tuple[Path, tuple[float, ...]], Shape] = field(default_factory=dict)

    def shape(self, uri: str, factors: tuple[float, ...], label: str) -> Shape:
        """The shape of a mesh file, scaled along its axes, mirrored by a negative factor.

        Args:
            uri: a path, or file://, model:// or package://.
            factors: (3,), along x, y, z.
            label: of the link, for messages.

        Raises:
            FileNotFoundError: no such file, with the places searched.
            ValueError: a factor of 0, or an invalid mesh file.
        """
        if not (np.isfinite(factors).all() and np.all(factors)):
            raise ValueError(f"{label}: mesh scale: got {factors}, expected numbers but 0")
        try:
            file = find_mesh(uri, self.path, self.packages)
        except FileNotFoundError as error:
            raise FileNotFoundError(f"{label}: {error}") from None
        key = (file, factors)
        if key not in self.shapes:
            mesh = read_mesh_file(file, self.scale)
            faces = mesh.faces[:, ::-1] if np.prod(factors) < 0 else mesh.faces
            vertices = mesh.vertices * np.array(factors)
            try:
                self.shapes[key] = Shape(vertices, faces, name=file.stem, **self.options)
            except ValueError as error:
                raise ValueError(f"{label}: {printable(str(file))}: {error}") from None
        return self.shapes[key]

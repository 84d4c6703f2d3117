"""Meshes that the nodes of a scene place, joined into one."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fgenv.arrays import Faces, Floats, Vertices

from .affine import mirrors, transformed
from .content import MeshSource

MAX_ITEMS = 1 << 26  # vertices, and faces: a small file can instance one mesh without bound
MAX_NODES = 1 << 17  # visits of nodes, for the same reason


@dataclass
class SceneParts:
    """Placed meshes of one file.

    Attributes:
        source: the file.
        notes: sentences on elements that the mesh lacks, each once, in the order of the file.
    """

    source: MeshSource
    notes: dict[str, None] = field(default_factory=dict)
    _vertices: list[Vertices] = field(default_factory=list)
    _faces: list[Faces] = field(default_factory=list)
    _sizes: list[int] = field(default_factory=lambda: [0, 0])
    _visits: int = 0

    def visit(self) -> None:
        """Count the visit of a node; too many are an error."""
        self._visits += 1
        if self._visits > MAX_NODES:
            self.source.fail(
                f"over {MAX_NODES} placed nodes", "a smaller scene; export its parts as files"
            )

    def note(self, sentence: str) -> None:
        """Add a sentence on an element that the mesh lacks."""
        self.notes[sentence] = None

    def add(self, vertices: Vertices, faces: Faces, pose: Floats, place: str) -> None:
        """Add a mesh, placed by an affine matrix (4, 4); a mirror image keeps its outside."""
        if not np.isfinite(pose).all():
            self.source.fail(f"{place} with a transform that overflows", "finite transforms")
        first = self._sizes[0]
        self._sizes[0] += len(vertices)
        self._sizes[1] += len(faces)
        self.check_size(max(self._sizes))
        if not np.array_equal(pose, np.eye(4)):
            vertices = transformed(vertices, pose)
        self._faces.append((faces[:, ::-1] if mirrors(pose) else faces) + first)
        self._vertices.append(vertices)

    def check_size(self, items: int) -> None:
        """Raise the error of a scene with too many vertices or faces."""
        if items > MAX_ITEMS:
            self.source.fail(
                f"a scene of over {MAX_ITEMS} vertices or faces, instances included",
                "a smaller scene; export its parts as files",
            )

    def joined(self) -> tuple[Vertices, Faces]:
        """All meshes as one: vertices (n, 3) and faces (m, 3)."""
        if not self._vertices:
            return np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
        return np.concatenate(self._vertices), np.concatenate(self._faces)

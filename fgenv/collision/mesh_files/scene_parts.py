"""Meshes that the nodes of a scene place, joined into one."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Faces, Floats, Vertices

from .affine import mirrors, transformed
from .content import MeshSource

MAX_ITEMS = 1 << 26  # vertices, and faces
MIN_ITEMS = 1 << 22  # of any file; above, one per byte: a small file can instance without bound
MAX_NODES = 1 << 17  # visits of nodes, for the same reason
CHUNK = 1 << 20  # vertices, or faces, that are placed at once


@dataclass
class SceneParts:
    """Placed meshes of one file.

    Attributes:
        source: the file.
        notes: sentences on elements that the mesh lacks, each once, in the order of the file.
    """

    source: MeshSource
    notes: dict[str, None] = field(default_factory=dict)
    _placed: list[tuple[Vertices, Faces, Floats]] = field(default_factory=list)
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
        """Add a mesh, placed by an affine matrix (4, 4); a mirror image keeps its outside.

        Repeated meshes are placed together, if their arrays are the same objects.
        """
        if not np.isfinite(pose).all():
            self.source.fail(f"{place} with a transform that overflows", "finite transforms")
        self._sizes[0] += len(vertices)
        self._sizes[1] += len(faces)
        self.check_size(max(self._sizes))
        self._placed.append((vertices, faces, pose))

    def check_size(self, items: int) -> None:
        """Raise the error of a scene with too many vertices or faces for the size of its file."""
        most = min(MAX_ITEMS, max(MIN_ITEMS, len(self.source.data)))
        if items > most:
            self.source.fail(
                f"a scene of over {most} vertices or faces, instances included",
                "a smaller scene; export its parts as files",
            )

    def joined(self) -> tuple[Vertices, Faces]:
        """All meshes as one: vertices (n, 3) and faces (m, 3)."""
        vertices, faces = np.empty((self._sizes[0], 3)), np.empty((self._sizes[1], 3), np.int64)
        if not self._placed:
            return vertices, faces
        poses = np.stack([pose for *_, pose in self._placed])
        mirrored, moved = mirrors(poses), (poses != np.eye(4)).any(axis=(1, 2))
        starts = [np.cumsum([0, *(len(part[i]) for part in self._placed)]) for i in (0, 1)]
        for group in self._groups():
            points, corners, _ = self._placed[group[0]]
            size = max(1, CHUNK // (1 + max(len(points), len(corners))))
            for chunk in np.split(group, range(size, len(group), size)):
                first, first_face = (start[chunk][:, None] for start in starts)
                placed = transformed(points, poses[chunk])
                placed[~moved[chunk]] = points
                vertices[first + np.arange(len(points))] = placed
                turned = np.where(mirrored[chunk][:, None, None], corners[:, ::-1], corners)
                faces[first_face + np.arange(len(corners))] = turned + first[:, None]
        return vertices, faces

    def _groups(self) -> list[NDArray[np.int64]]:
        """Indices of the placements of each mesh."""
        groups: dict[tuple[int, int], list[int]] = {}
        for i, (vertices, faces, _) in enumerate(self._placed):
            groups.setdefault((id(vertices), id(faces)), []).append(i)
        return [np.array(group) for group in groups.values()]

"""Embree: each edge of one mesh as a ray against the other (arXiv 2409.09918), in float."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh
from numpy.typing import NDArray

from fgenv.arrays import Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import one_by_one
from fgenv.bench.peers.base import Checker, Peer


class _Model:
    def __init__(self, mesh: Mesh) -> None:
        self.scene = rtcore_scene.EmbreeScene()
        TriangleMesh(self.scene, mesh.vertices.astype(np.float32), mesh.faces)
        sides = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges = np.unique(sides, axis=0)
        self.start = mesh.vertices[edges[:, 0]]
        self.way = mesh.vertices[edges[:, 1]] - self.start

    def crossed_by(self, other: _Model, relative: Poses) -> bool:
        """Whether an edge of `other`, at pose `relative` in this body's frame, meets a face."""
        start = other.start @ relative[:3, :3].T + relative[:3, 3]
        way = other.way @ relative[:3, :3].T
        far: NDArray[np.float32] = np.ones(len(start), np.float32)  # in edge lengths
        hit = self.scene.run(
            start.astype(np.float32), way.astype(np.float32), far, query="OCCLUDED"
        )
        return bool(np.any(hit != -1))


def _pair(a: Any, b: Any, pose_a: Poses) -> Checker:
    to_a = np.linalg.inv(pose_a)

    def collide(pose: Poses) -> bool:
        relative = to_a @ pose
        return bool(a.crossed_by(b, relative) or b.crossed_by(a, np.linalg.inv(relative)))

    return Checker(collide, one_by_one(collide))


PEER = Peer("embree", version("embreex"), "edges in float", _Model, _pair, lambda _: 0)

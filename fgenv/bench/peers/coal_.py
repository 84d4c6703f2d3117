"""coal (once hpp-fcl): BVHModelOBBRSS, requests and results made once."""

from __future__ import annotations

from typing import Any

import coal
import numpy as np

from fgenv.arrays import Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import one_by_one
from fgenv.bench.peers.base import Checker, Peer


def _build(mesh: Mesh) -> Any:
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(mesh.faces), len(mesh.vertices))
    model.addVertices(mesh.vertices)
    model.addTriangles(mesh.faces.astype(np.uint32))
    model.endModel()
    return model


def _pair(a: Any, b: Any, pose_a: Poses) -> Checker:
    fixed = coal.Transform3s(pose_a[:3, :3], pose_a[:3, 3])
    moving = coal.Transform3s()
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    far, found = coal.DistanceRequest(), coal.DistanceResult()

    def collide(pose: Poses) -> bool:
        moving.setRotation(pose[:3, :3])
        moving.setTranslation(pose[:3, 3])
        result.clear()
        return bool(coal.collide(a, fixed, b, moving, request, result))

    def distance(pose: Poses) -> float:
        moving.setRotation(pose[:3, :3])
        moving.setTranslation(pose[:3, 3])
        found.clear()
        return max(float(coal.distance(a, fixed, b, moving, far, found)), 0.0)

    return Checker(
        collide,
        one_by_one(collide),
        lambda poses: np.fromiter(map(distance, poses), np.float64, len(poses)),
        distance,
    )


def _nbytes(model: Any) -> int:
    return int(model.memUsage(False))


PEER = Peer("coal", coal.__version__, "meshes", _build, _pair, _nbytes)

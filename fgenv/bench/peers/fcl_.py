"""python-fcl: BVHModel of OBBRSS boxes, collision objects kept, poses set from NumPy."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import fcl
import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.peers.base import Checker, Peer


def _build(mesh: Mesh) -> Any:
    model = fcl.BVHModel()
    model.beginModel(len(mesh.vertices), len(mesh.faces))
    model.addSubModel(mesh.vertices, mesh.faces)
    model.endModel()
    return model


def _pair(a: Any, b: Any, pose_a: Poses) -> Checker:
    fixed = fcl.CollisionObject(a, fcl.Transform(pose_a[:3, :3], pose_a[:3, 3]))
    moving = fcl.CollisionObject(b)
    # Its quickest form from NumPy poses: requests made once, arrays cut once a batch, rotation and
    # translation set apart (setTransform needs a Transform made first, 0.8 µs more).
    request, far = fcl.CollisionRequest(), fcl.DistanceRequest()
    turn_to, shift_to = moving.setRotation, moving.setTranslation
    meet, apart = fcl.collide, fcl.distance

    def collide(pose: Poses) -> bool:
        turn_to(pose[:3, :3])
        shift_to(pose[:3, 3])
        return bool(meet(fixed, moving, request))

    def collide_all(poses: Poses) -> NDArray[np.bool_]:
        verdicts = []
        for turn, shift in zip(poses[:, :3, :3], poses[:, :3, 3], strict=True):
            turn_to(turn)
            shift_to(shift)
            verdicts.append(meet(fixed, moving, request) > 0)
        return np.array(verdicts, np.bool_)

    def distance(pose: Poses) -> float:
        turn_to(pose[:3, :3])
        shift_to(pose[:3, 3])
        return max(float(apart(fixed, moving, far)), 0.0)

    def distance_all(poses: Poses) -> NDArray[np.float64]:
        found = []
        for turn, shift in zip(poses[:, :3, :3], poses[:, :3, 3], strict=True):
            turn_to(turn)
            shift_to(shift)
            found.append(apart(fixed, moving, far))
        return np.maximum(found, 0.0)

    return Checker(collide, collide_all, distance_all, distance)


PEER = Peer("python-fcl", version("python-fcl"), "meshes", _build, _pair)

"""MuJoCo: meshes are replaced by their convex hulls, so the verdict is about hulls."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from fgenv.arrays import Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import one_by_one
from fgenv.bench.peers.base import Checker, Peer


def _build(mesh: Mesh) -> Mesh:
    return mesh  # MuJoCo compiles whole models, so the hulls are made in _pair


def _pair(a: Any, b: Any, pose_a: Poses) -> Checker:
    spec = mujoco.MjSpec()
    for name, mesh in (("a", a), ("b", b)):
        asset = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
        asset.uservert, asset.userface = mesh.vertices.ravel(), mesh.faces.ravel()
        body = spec.worldbody.add_body(name=name)
        body.add_freejoint()
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:7] = _free_joint(pose_a)

    def collide(pose: Poses) -> bool:
        data.qpos[7:] = _free_joint(pose)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        return bool(data.ncon > 0)

    return Checker(collide, one_by_one(collide))


def _free_joint(pose: Poses) -> Poses:
    """Position, then quaternion w, x, y, z."""
    joint = np.empty(7)
    joint[:3] = pose[:3, 3]
    mujoco.mju_mat2Quat(joint[3:], pose[:3, :3].ravel())
    return joint


PEER = Peer("mujoco", mujoco.__version__, "hulls", _build, _pair, lambda _: 0)

"""trimesh's CollisionManager (python-fcl below), as most Python users call it."""

from __future__ import annotations

from typing import Any

import trimesh

from fgenv.arrays import Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import one_by_one
from fgenv.bench.peers.base import Checker, Peer


def _build(mesh: Mesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


def _pair(a: Any, b: Any, pose_a: Poses) -> Checker:
    manager = trimesh.collision.CollisionManager()
    manager.add_object("a", a, pose_a)
    manager.add_object("b", b)

    def collide(pose: Poses) -> bool:
        manager.set_transform("b", pose)
        return bool(manager.in_collision_internal())

    return Checker(collide, one_by_one(collide))


PEER = Peer("trimesh", str(trimesh.__version__), "meshes", _build, _pair, lambda _: 0)

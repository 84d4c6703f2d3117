"""fgenv itself: one call a batch."""

from __future__ import annotations

import warnings
from typing import Any

import fgenv
from fgenv.arrays import Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.peers.base import Checker, Peer
from fgenv.collision import MeshWarning, Shape, collide, distance


def _build(mesh: Mesh) -> Shape:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)  # the others say nothing about open meshes
        return Shape(mesh.vertices, mesh.faces)


def _pair(a: Any, b: Any, pose_a: Poses) -> Checker:
    return Checker(
        collide=lambda pose: bool(collide(a, pose_a, b, pose)),
        collide_all=lambda poses: collide(a, pose_a, b, poses, threads=1),
        distance=lambda pose: float(distance(a, pose_a, b, pose)),
        distance_all=lambda poses: distance(a, pose_a, b, poses, threads=1),
    )


PEER = Peer("fgenv", fgenv.__version__, "meshes", _build, _pair, lambda shape: int(shape.nbytes))

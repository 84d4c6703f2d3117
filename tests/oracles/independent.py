"""Independent results: python-fcl, coal, solid angles, and integers to settle disagreements."""

from __future__ import annotations

import igl
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fgenv.arrays import Floats
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.peers import Checker, peer
from fgenv.collision import Shape
from oracles import rational


def fcl_checker(a: Mesh, b: Mesh, pose_a: Floats) -> Checker:
    """python-fcl on the two meshes."""
    fcl = peer("python-fcl")
    return fcl.pair(fcl.build(a), fcl.build(b), pose_a)


def coal_verdicts(a: Mesh, b: Mesh, pose_a: Floats, poses: Floats) -> NDArray[np.bool_]:
    """coal's results (n,). It reports gaps under 1e-6 units as hits, hence the small units."""
    checker, _, poses = _coal(a, b, pose_a, poses)
    return checker.collide_all(poses)


def coal_distances(a: Mesh, b: Mesh, pose_a: Floats, poses: Floats) -> Floats:
    """coal's distances (n,), meters."""
    checker, unit, poses = _coal(a, b, pose_a, poses)
    assert checker.distance_all is not None
    return checker.distance_all(poses) / unit


def _coal(a: Mesh, b: Mesh, pose_a: Floats, poses: Floats) -> tuple[Checker, float, Floats]:
    """A checker in units in which bodies measure a million; a power of two changes no digit."""
    coal = peer("coal")
    unit = 2.0 ** round(np.log2(1e6 / max(a.size, b.size)))
    model_a, model_b = (coal.build(Mesh(m.name, m.vertices * unit, m.faces)) for m in (a, b))
    pose_a, poses = pose_a.copy(), poses.copy()
    pose_a[:3, 3] *= unit
    poses[:, :3, 3] *= unit
    return coal.pair(model_a, model_b, pose_a), unit, poses


def surfaces_meet(a: Mesh, pose_a: Floats, b: Mesh, pose_b: Floats) -> bool:
    """Whether the surfaces share a point, in whole numbers."""
    return rational.meshes_meet(a.vertices, a.faces, pose_a, b.vertices, b.faces, pose_b)


def shells(faces: NDArray[np.int32]) -> list[NDArray[np.int32]]:
    """Faces of each part that hangs together by edges."""
    sides = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, edge = np.unique(sides, axis=0, return_inverse=True)
    face = np.repeat(np.arange(len(faces)), 3)
    incidence = coo_array((np.ones(len(face)), (face, edge.ravel()))).tocsr()
    count, label = connected_components(incidence @ incidence.T, directed=False)
    return [faces[label == i] for i in range(count)]


def is_inside(shape: Shape, points: Floats) -> NDArray[np.bool_]:
    """Whether points (n, 3) of the shape's frame, off its surface, are inside its closed shells.

    The solid angle of a closed shell is a whole number of turns.
    """
    turns = np.zeros(len(points), np.int64)
    for faces in shells(shape.faces):
        angle = np.array(
            [igl.winding_number(shape.vertices, faces.astype(np.int64), p[None])[0] for p in points]
            if len(points) < 4
            else igl.winding_number(shape.vertices, faces.astype(np.int64), points)
        )
        whole = np.abs(angle - np.round(angle)) < 1e-6
        turns += np.where(whole, np.round(angle), 0).astype(np.int64)
    return np.asarray(turns != 0)


def one_is_inside(a: Shape, pose_a: Floats, b: Shape, pose_b: Floats) -> bool:
    """Whether a shell of one lies inside the other, given that the surfaces do not meet."""
    for inner, at_inner, outer, at_outer in ((a, pose_a, b, pose_b), (b, pose_b, a, pose_a)):
        relative = np.linalg.inv(at_outer) @ at_inner
        points = np.array([inner.vertices[faces[0, 0]] for faces in shells(inner.faces)])
        if is_inside(outer, points @ relative[:3, :3].T + relative[:3, 3]).any():
            return True
    return False


def truth(a: Shape, pose_a: Floats, b: Shape, pose_b: Floats) -> bool:
    """Whether the bodies collide: surfaces in whole numbers, then containment."""
    meet = rational.meshes_meet(a.vertices, a.faces, pose_a, b.vertices, b.faces, pose_b)
    return meet or one_is_inside(a, pose_a, b, pose_b)


def is_marginal(a: Mesh, pose_a: Floats, b: Mesh, pose_b: Floats) -> bool:
    """Whether moving b by 1e-9 of the size may change whether the surfaces meet."""
    shift = 1e-9 * max(a.size, b.size)
    verdicts = set()
    for direction in (np.indices((3, 3, 3)) - 1).reshape(3, -1).T:
        nudged = pose_b.copy()
        nudged[:3, 3] += shift * direction
        verdicts.add(surfaces_meet(a, pose_a, b, nudged))
    return len(verdicts) > 1


def distances_to_surface(shape: Shape, points: Floats) -> Floats:
    """Distances (n,) of points of the shape's frame to its surface, by libigl."""
    squared = igl.point_mesh_squared_distance(points, shape.vertices, shape.faces.astype(np.int64))
    return np.asarray(np.sqrt(np.atleast_1d(squared[0])))

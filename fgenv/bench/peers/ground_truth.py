"""The truth of a pose, found without fgenv: python-fcl for surfaces, winding numbers for solids.

python-fcl (like all its kind) calls a body inside another free, so free poses are asked again: is
a vertex of one connected part inside the other, watertight, body?
"""

from __future__ import annotations

from math import pi

import numpy as np
import trimesh

from fgenv.arrays import Floats
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.peers import peer


def winding_numbers(points: Floats, mesh: Mesh) -> Floats:
    """How often `mesh` goes around each point (k, 3): the sum of its faces' solid angles over 4 pi.

    Van Oosterom, Strackee, "The solid angle of a plane triangle" (1983).
    """
    corners = mesh.vertices[mesh.faces][None] - points[:, None, None]  # (k, m, 3, 3)
    length = np.linalg.norm(corners, axis=-1)
    a, b, c = np.moveaxis(corners, 2, 0)
    la, lb, lc = np.moveaxis(length, 2, 0)
    volume = (a * np.cross(b, c)).sum(axis=-1)
    ab, bc, ca = ((u * v).sum(axis=-1) for u, v in ((a, b), (b, c), (c, a)))
    angles = 2.0 * np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)
    return np.asarray(angles.sum(axis=1) / (4.0 * pi))


def part_points(mesh: Mesh) -> Floats:
    """One vertex (k, 3) of each connected part of the surface."""
    edges = mesh.faces[:, [0, 1, 1, 2]].reshape(-1, 2)
    labels = trimesh.graph.connected_component_labels(edges, len(mesh.vertices))
    used = np.unique(mesh.faces)
    return mesh.vertices[used[np.unique(labels[used], return_index=True)[1]]]


class Truth:
    """Verdicts on one pair of bodies; a stands at `pose_a` (4, 4)."""

    def __init__(self, a: Mesh, b: Mesh, pose_a: Floats) -> None:
        fcl = peer("python-fcl")
        self.touches = fcl.pair(fcl.build(a), fcl.build(b), pose_a).collide
        self._a, self._b, self._pose_a = a, b, pose_a
        self._parts_a, self._parts_b = part_points(a), part_points(b)
        self._solid_a, self._solid_b = (
            trimesh.Trimesh(m.vertices, m.faces, process=False).is_watertight for m in (a, b)
        )

    def contains(self, pose: Floats) -> bool:
        """Whether part of a body is inside the other, b at `pose`; surfaces must not meet."""
        a_in_b = np.asarray(np.linalg.solve(pose, self._pose_a), np.float64)
        b_in_a = np.asarray(np.linalg.solve(self._pose_a, pose), np.float64)
        return (self._solid_b and _inside(self._parts_a, a_in_b, self._b)) or (
            self._solid_a and _inside(self._parts_b, b_in_a, self._a)
        )

    def collides(self, pose: Floats) -> bool:
        """Whether the bodies share a point, b at `pose` (4, 4)."""
        return self.touches(pose) or self.contains(pose)


def _inside(points: Floats, T: Floats, mesh: Mesh) -> bool:
    placed = points @ T[:3, :3].T + T[:3, 3]
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    near = placed[np.all((low <= placed) & (placed <= high), axis=1)]
    return bool(np.any(np.abs(winding_numbers(near, mesh)) > 0.5))

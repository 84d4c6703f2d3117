"""The published feature-graph algorithm, step by step, in plain NumPy.

Ma Li, Wang Qiang et al., "a collision detection method based on the feature graph of objects",
with its section numbers (2.1 to 2.5). It is the oracle of the native method ``loop``. It is
unsound, as published: chords cut through the body and across concavities, and the target's corners
are not tested. Use ``exact`` for correct results.

Meshes are expected to be repaired, with shared vertices. The definitions:

- Order (2.1). Faces in index order; of each face the edges (0, 1), (1, 2), (2, 0). An edge with
  exactly two faces that run along it in opposite directions is examined at its first face. The end
  points A, B of a feature, in the direction of this first face, are appended unless they are
  already in the list. All other edges (one face, three and more, two with the same winding) have no
  dihedral angle and give no feature points.
- Angle (2.1). n = (P1 - P0) x (P2 - P0), normalized, of the first face (n1) and the other
  (n2); <n1, n2> = atan2(|n1 x n2|, n1 . n2) in [0, pi]. A face of zero area has n = 0.
- Valley or ridge (2.1). Valley if the neighbor's vertex off the edge lies above the face's plane,
  (Q - A) . n1 > 0; otherwise ridge. Valley: theta = pi - <n1, n2>, a feature if
  theta < alpha_valley. Ridge: theta = pi + <n1, n2>, a feature if theta > alpha_ridge. A tie
  within ANGLE_TIE is no feature, so that the result on regular solids does not depend on rounding.
- Cycle (2.2). Points 0-1-2-...-(n-1)-0. n = 2 gives one segment; n < 2 gives none.
- Packed matrix (2.2). The strict upper triangle row by row, bits (0,1), (0,2) ... (0,n-1), (1,2)
  ..., the first in the highest bit of byte 0 (np.packbits).
- Hit (2.5). With n = (V1 - V0) x (V2 - V0) of the face, s1 = (P1 - V0) . n and s2 = (P2 - V0) . n:
  parallel (s1 = s2, so also a segment within the plane) is no hit; else t = s1 / (s1 - s2), a hit
  if t is in [0, 1] and the point P1 + t (P2 - P1) lies on the inner side of, or on, each of the
  three edges. All tests are closed: an end point on the face, or the face's boundary, counts.
  There is no division in the code: results at poses in whole numbers are exact.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats, Ints

Bytes = NDArray[np.uint8]

ALPHA_VALLEY = pi - pi / 6  # rad; features deviate from flat by more than 30 degrees
ALPHA_RIDGE = pi + pi / 6  # rad
ANGLE_TIE = 1e-9  # rad


# 2.1 Feature points ------------------------------------------------------------------------------


def face_normals(vertices: Floats, faces: Ints) -> Floats:
    """Outward normals (m, 3), not normalized: (P1 - P0) x (P2 - P0)."""
    p0, p1, p2 = (vertices[faces[:, k]] for k in range(3))
    return np.cross(p1 - p0, p2 - p0)


def interior_edges(faces: Ints) -> Iterator[tuple[int, int, int, int]]:
    """Edges with a dihedral angle as (A, B, first face, other face), in the order of faces."""
    sides: dict[tuple[int, int], list[tuple[int, int, int]]] = {}
    for f, face in enumerate(faces.tolist()):
        for k in range(3):
            a, b = face[k], face[(k + 1) % 3]
            sides.setdefault((min(a, b), max(a, b)), []).append((a, b, f))
    for uses in sides.values():  # in the order of insertion
        a, b, f = uses[0]
        if len(uses) == 2 and uses[1][:2] == (b, a):
            yield a, b, f, uses[1][2]


def feature_edges(
    vertices: Floats,
    faces: Ints,
    alpha_valley: float = ALPHA_VALLEY,
    alpha_ridge: float = ALPHA_RIDGE,
) -> list[tuple[int, int, str]]:
    """Edges (A, B, "valley" or "ridge") over the thresholds (rad), vertex indices, in order."""
    normals = face_normals(vertices, faces)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = normals / np.where(length > 0.0, length, 1.0)
    found = []
    for a, b, f, g in interior_edges(faces):
        n1, n2 = normals[f], normals[g]
        angle = np.arctan2(np.linalg.norm(np.cross(n1, n2)), n1 @ n2)  # <n1, n2>
        opposite = next((v for v in faces[g].tolist() if v not in (a, b)), a)
        if (vertices[opposite] - vertices[a]) @ n1 > 0.0:
            if pi - angle < alpha_valley - ANGLE_TIE:
                found.append((a, b, "valley"))
        elif pi + angle > alpha_ridge + ANGLE_TIE:
            found.append((a, b, "ridge"))
    return found


def feature_points(
    vertices: Floats,
    faces: Ints,
    alpha_valley: float = ALPHA_VALLEY,
    alpha_ridge: float = ALPHA_RIDGE,
) -> Ints:
    """The feature points V = {v_1 ... v_n} as vertex indices (n,), in the order of their edges."""
    edges = feature_edges(vertices, faces, alpha_valley, alpha_ridge)
    order = dict.fromkeys(v for a, b, _ in edges for v in (a, b))
    return np.fromiter(order, np.int64, len(order))


# 2.2 Feature graph -------------------------------------------------------------------------------


def head_to_tail(n: int) -> Ints:
    """The simple cycle over n points, edges (n, 2); one segment for n = 2, none below."""
    if n < 3:
        return np.array([[0, 1]] if n == 2 else [], np.int64).reshape(-1, 2)
    points = np.arange(n)
    return np.column_stack((points, np.roll(points, -1)))


def bit_of(i: Ints, j: Ints, n: int) -> Ints:
    """Index of entry (i, j) of the symmetric n x n matrix in the packed triangle."""
    low, high = np.minimum(i, j), np.maximum(i, j)
    return np.asarray(low * n - low * (low + 1) // 2 + high - low - 1)


def pack(edges: Ints, n: int) -> Bytes:
    """Pack edges (m, 2) into the upper triangle of the adjacency matrix G."""
    bits = np.zeros(n * (n - 1) // 2, np.uint8)
    bits[bit_of(edges[:, 0], edges[:, 1], n)] = 1
    return np.packbits(bits)


def unpack(packed: Bytes, n: int) -> NDArray[np.bool_]:
    """Unpack to the symmetric matrix G (n, n)."""
    dense = np.zeros((n, n), bool)
    dense[np.triu_indices(n, 1)] = np.unpackbits(packed, count=n * (n - 1) // 2)
    return dense | dense.T


# 2.3 Motion range --------------------------------------------------------------------------------


def motion_box(path: Floats) -> Floats:
    """Project a polyline (k, 3) on the axes: the box (2, 3) of its lowest and highest values."""
    return np.stack((path.min(axis=0), path.max(axis=0)))


def in_box(position: Floats, box: Floats) -> bool:
    """Whether a position (3,) lies in the motion box, its boundary included."""
    return bool(np.all((box[0] <= position) & (position <= box[1])))


# 2.5 (1) The record and the model list; (2), (3) its features ------------------------------------


@dataclass
class Node:
    """One object of the model list."""

    id: int
    name: str
    vertices: Floats  # (n, 3) body frame, meters
    faces: Ints  # (m, 3)
    pose: Floats = field(default_factory=lambda: np.eye(4))  # (4, 4) body in world
    collision_mask: int = 0
    feature_points: Floats = field(default_factory=lambda: np.empty((0, 3)))  # (n, 3) body frame
    feature_graph: Bytes = field(default_factory=lambda: np.empty(0, np.uint8))  # packed

    @property
    def position(self) -> Floats:
        """The object's position (3,), world frame."""
        return np.asarray(self.pose[:3, 3])


def extract(
    model_list: Sequence[Node],
    alpha_valley: float = ALPHA_VALLEY,
    alpha_ridge: float = ALPHA_RIDGE,
) -> None:
    """Compute the feature points and the feature graph of each object of the model list."""
    for node in model_list:
        found = feature_points(node.vertices, node.faces, alpha_valley, alpha_ridge)
        node.feature_points = node.vertices[found]
        node.feature_graph = pack(head_to_tail(len(found)), len(found))


# 2.4 Masks, and 2.5 (4) --------------------------------------------------------------------------


def candidates(model_list: Sequence[Node], mover: Node, path: Floats) -> list[Node]:
    """The set v: all other objects with their position in the motion box of the path (k, 3)."""
    box = motion_box(path)
    return [node for node in model_list if node is not mover and in_box(node.position, box)]


def set_masks(model_list: Sequence[Node], mover: Node, path: Floats) -> None:
    """Set the masks for a motion along the path: 1 for candidates and mover, 0 for all others."""
    clear_masks(model_list)
    for node in (*candidates(model_list, mover, path), mover):
        node.collision_mask = 1


def clear_masks(model_list: Sequence[Node]) -> None:
    """Set all masks to 0, as after a motion."""
    for node in model_list:
        node.collision_mask = 0


def must_test(mover: Node, other: Node) -> bool:
    """Whether the two masks have a common bit (2.5 (5))."""
    return mover.collision_mask & other.collision_mask != 0


# 2.5 (5) The test --------------------------------------------------------------------------------


def depth_first(packed: Bytes, n: int) -> Iterator[tuple[int, int]]:
    """Each edge of the packed graph once, in depth-first order; neighbors in ascending order."""
    left = packed.copy()  # edges that are not visited yet
    points = np.arange(n)
    for start in range(n):
        stack = [start]
        while stack:
            here = stack[-1]
            others = points[points != here]
            bits = bit_of(np.full_like(others, here), others, n)
            edges = np.flatnonzero(left[bits >> 3] >> (7 - (bits & 7)) & 1)
            if len(edges) == 0:
                stack.pop()
                continue
            there, bit = int(others[edges[0]]), int(bits[edges[0]])
            left[bit >> 3] &= ~np.uint8(1 << (7 - (bit & 7)))
            stack.append(there)
            yield here, there


def segment_hits(p1: Floats, p2: Floats, corners: Floats, normals: Floats) -> NDArray[np.bool_]:
    """Mask (m,) of the faces that the segment P1 + t (P2 - P1), t in [0, 1], intersects.

    Formula (3), closed.

    corners (m, 3, 3) of the faces and their normals (m, 3), of any length, in the segment's frame.
    """
    s1 = np.einsum("mi,mi->m", p1 - corners[:, 0], normals)
    s2 = np.einsum("mi,mi->m", p2 - corners[:, 0], normals)
    hits: NDArray[np.bool_] = (np.minimum(s1, s2) <= 0) & (np.maximum(s1, s2) >= 0) & (s1 != s2)
    near = np.flatnonzero(hits)  # the segment intersects the face's plane
    t, w = np.abs(s1[near, None]), np.abs(s1[near, None] - s2[near, None])  # t = 0 ... w
    for k in range(3):
        v, end = corners[near, k], corners[near, (k + 1) % 3]
        from_v = w * (p1 - v) + t * (p2 - p1)  # no division: whole numbers stay exact
        hits[near] &= np.einsum("mi,mi->m", np.cross(end - v, from_v), normals[near]) >= 0.0
    return hits


def collides(mover: Node, target: Node) -> bool:
    """Whether an edge of the mover's graph intersects a face of the target."""
    points = mover.feature_points @ mover.pose[:3, :3].T + mover.pose[:3, 3]
    vertices = target.vertices @ target.pose[:3, :3].T + target.pose[:3, 3]
    corners, normals = vertices[target.faces], face_normals(vertices, target.faces)
    return any(
        segment_hits(points[i], points[j], corners, normals).any()
        for i, j in depth_first(mover.feature_graph, len(points))
    )


@dataclass(frozen=True)
class Collision:
    """The collision handler's data: the pair, the mover's position, its distance along the path."""

    mover: int  # ids
    other: int
    position: Floats  # (3,)
    distance: float  # meters


def move(
    model_list: Sequence[Node], mover: Node, path: Floats, step: float = 0.01
) -> Collision | None:
    """Figure 6: set masks, move along the path (k, 3), test, stop at a collision.

    The mover keeps its rotation and stays at the collision. There are at most `step` meters
    between two tests. Returns the first collision, or None at the goal. Masks are 0 afterwards.
    """
    set_masks(model_list, mover, path)
    try:
        for position, distance in positions(path, step):
            mover.pose = mover.pose.copy()
            mover.pose[:3, 3] = position
            for other in model_list:
                if other is not mover and must_test(mover, other) and collides(mover, other):
                    return Collision(mover.id, other.id, position, distance)
        return None
    finally:
        clear_masks(model_list)


def positions(path: Floats, step: float) -> Iterator[tuple[Floats, float]]:
    """Positions (3,) on the polyline, corners included, with their distance along it (meters)."""
    yield path[0], 0.0
    gone = 0.0
    for start, end in pairwise(path):
        length = float(np.linalg.norm(end - start))
        count = max(1, ceil(length / step))
        for k in range(1, count + 1):
            yield start + (end - start) * (k / count), gone + length * k / count
        gone += length

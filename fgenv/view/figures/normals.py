"""Shading normals: smooth across edges that bend little, sharp at the others."""

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats

SMOOTH = 0.6  # rad: edges that bend less are shaded smoothly


def normal_maps(vertices: Floats, faces: NDArray[np.integer], smooth: float) -> Floats:
    """Return a matrix (m, 3, 4) per face; its product with (x, y, z, 1) is the normal there.

    The normal is interpolated linearly between those of `corner_normals`, without unit length.
    """
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    area = np.maximum(np.einsum("mi,mi->m", normal, normal), 1e-300)[:, None]
    # Barycentric weights are linear too: w_b(p) = grad_b . (p - a), w_a = 1 - w_b - w_c.
    grad_b, grad_c = np.cross(c - a, normal) / area, np.cross(normal, b - a) / area
    weights = np.zeros((len(faces), 3, 4))
    weights[:, 1, :3], weights[:, 2, :3] = grad_b, grad_c
    weights[:, 1:, 3] = -np.einsum("mki,mi->mk", weights[:, 1:, :3], a)
    weights[:, 0] = -weights[:, 1] - weights[:, 2]
    weights[:, 0, 3] += 1.0
    normals = corner_normals(vertices, faces, smooth)
    return np.asarray(np.einsum("mki,mkj->mij", normals, weights))


def corner_normals(vertices: Floats, faces: NDArray[np.integer], smooth: float) -> Floats:
    """Return a unit normal for each corner of each face, (m, 3, 3).

    It is the area-weighted mean over the faces at that vertex that bend less than `smooth` (rad)
    from the corner's own face.
    """
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    weighted = np.cross(b - a, c - a)
    unit = weighted / np.maximum(np.linalg.norm(weighted, axis=1, keepdims=True), 1e-300)
    corner, neighbor = _corners_that_share_a_vertex(faces.ravel())
    close = np.einsum("ni,ni->n", unit[corner // 3], unit[neighbor // 3]) > np.cos(smooth)
    total = np.zeros((faces.size, 3))
    np.add.at(total, corner[close], weighted[neighbor[close] // 3])
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.asarray((total / np.maximum(length, 1e-300)).reshape(-1, 3, 3))


def _corners_that_share_a_vertex(
    vertex: NDArray[np.integer],
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return all ordered pairs of corners at one vertex, each corner with itself included."""
    order = np.argsort(vertex, kind="stable")
    _, first, count = np.unique(vertex[order], return_index=True, return_counts=True)
    degree = np.repeat(count, count)  # for each corner in order: corners at its vertex
    corner = np.repeat(order, degree)
    begin = np.repeat(np.repeat(first, count), degree)
    offset = np.arange(len(corner)) - np.repeat(np.cumsum(degree) - degree, degree)
    return corner, order[begin + offset]

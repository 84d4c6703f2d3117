"""Polygons, strips and fans of mesh files as triangles that keep the winding."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fgenv.arrays import Faces, Flags, Floats, Ints, Vertices

PLANAR = 1e-5  # of a polygon's size: farthest corner from its plane; float32 files stay below
ROUNDING = 1e-6  # of the largest coordinate: six digits in a text file
SLIVER = 1e-12  # of a polygon's area
CHUNK = 1 << 17  # polygons per step, which bounds the memory


class Triangulation(NamedTuple):
    """Triangles of polygons, in the order of the polygons.

    Attributes:
        faces: (m, 3).
        polygons: number of polygons with more than three corners.
        nonplanar: number of polygons with corners outside one plane.
        crossing: number of polygons with sides that cross; their area is ambiguous.
    """

    faces: Faces
    polygons: int
    nonplanar: int
    crossing: int


def triangulated(vertices: Vertices, counts: Ints, corners: Ints) -> Triangulation:
    """Split polygons into triangles.

    Convex polygons become fans from their first corner, other quadrilaterals are cut from their
    reflex corner, and other polygons are cut by ears (Mapbox Earcut).

    Args:
        vertices: (n, 3).
        counts: (k,) corners of each polygon, at least 3.
        corners: (counts.sum(),) valid indices of vertices, polygon after polygon.
    """
    if not (counts > 3).any():
        return Triangulation(corners.reshape(-1, 3).astype(np.int64, copy=False), 0, 0, 0)
    firsts = np.cumsum(counts) - counts
    outputs = firsts - 2 * np.arange(len(counts))
    faces = np.empty((len(corners) - 2 * len(counts), 3), dtype=np.int64)
    nonplanar = crossing = 0
    for n in np.unique(counts):
        same = np.flatnonzero(counts == n)
        for part in np.split(same, range(CHUNK, len(same), CHUNK)):
            polygons = corners[firsts[part][:, None] + np.arange(n)]  # (p, n)
            triangles = _fans(polygons)
            if n > 3:
                bent, crossed = _cut(vertices, polygons, triangles)
                nonplanar, crossing = nonplanar + bent, crossing + crossed
            faces[outputs[part][:, None] + np.arange(n - 2)] = triangles
    return Triangulation(faces, int((counts > 3).sum()), nonplanar, crossing)


def crossing_note(count: int) -> str:
    """The note of a report on polygons with sides that cross."""
    return f"{count} polygons have sides that cross, and are cut from their first corner."


def triangulated_with_holes(vertices: Vertices, rings: Sequence[Ints]) -> Faces:
    """Triangles (m, 3) of one polygon with holes: the outline, then the holes, as indices.

    The outline gives the winding; the direction of the holes does not matter.
    """
    corners = np.concatenate(rings).astype(np.int64)
    points = vertices[corners]
    outline = points[: len(rings[0])]
    plane = _plane(_normals(outline[None] - outline[0]))[0]
    ends = np.cumsum([len(ring) for ring in rings])
    return corners[_ears((points - outline[0]) @ plane, ends)]


def strip_faces(corners: Ints) -> Faces:
    """Triangles of a strip: every second one is turned, so that all face the same side."""
    faces = np.column_stack([corners[:-2], corners[1:-1], corners[2:]]).astype(np.int64)
    faces[1::2, :2] = faces[1::2, 1::-1]
    return faces


def fan_faces(corners: Ints) -> Faces:
    """Triangles of a fan around its first corner."""
    faces: Faces = _fans(corners[None].astype(np.int64))[0]
    return faces


def _fans(polygons: Ints) -> Ints:
    """Polygons (p, n) as fans (p, n - 2, 3)."""
    first = np.broadcast_to(polygons[:, :1], (len(polygons), polygons.shape[1] - 2))
    fans: Ints = np.stack([first, polygons[:, 1:-1], polygons[:, 2:]], axis=-1)
    return fans


def _normals(points: Floats) -> Floats:
    """Twice the area vectors (p, 3) of polygons (p, n, 3) relative to their first corners."""
    total: Floats = np.cross(points[:, 1:-1], points[:, 2:]).sum(axis=1)
    return total


def _cut(vertices: Vertices, polygons: Ints, triangles: Ints) -> tuple[int, int]:
    """Correct the fans of polygons (p, n) in place; count non-planar and crossing polygons."""
    points = vertices[polygons]
    magnitude = np.abs(points).max(axis=(1, 2))
    points -= points[:, :1].copy()
    with np.errstate(invalid="ignore", over="ignore"):  # the caller reports NaN and infinity
        normals = _normals(points)
        lengths = np.linalg.norm(normals, axis=1)
        heights = np.einsum("pni,pi->pn", points, normals) / np.maximum(lengths, 1e-300)[:, None]
        allowed = PLANAR * np.ptp(points, axis=1).max(axis=1) + ROUNDING * magnitude
        nonplanar = int((np.ptp(heights, axis=1) > allowed).sum())
        left = np.flatnonzero(~_fan_covers(points, normals))
    left = left[np.isfinite(points[left]).all(axis=(1, 2))]
    cut = _turned_diagonals if polygons.shape[1] == 4 else _ears_of
    faces = cut(points[left], normals[left])
    triangles[left] = np.take_along_axis(polygons[left][:, None], faces, axis=2)
    return nonplanar, int(_overlap(points[left], normals[left], faces).sum())


def _fan_covers(points: Floats, normals: Floats) -> Flags:
    """Whether the fan from the first corner covers each polygon (p, n, 3) without overlap."""
    a, b = points[:, 1:-1], points[:, 2:]
    areas = np.einsum("pni,pi->pn", np.cross(a, b), normals)  # times the length of the normal
    square = np.einsum("pi,pi->p", normals, normals)
    positive: Flags = (areas > SLIVER * square[:, None]).all(axis=1)
    if points.shape[1] > 5:  # five corners can't wind around the first one twice
        lengths = np.sqrt(square)[:, None]
        angles = np.arctan2(areas, lengths * np.einsum("pni,pni->pn", a, b))
        positive &= angles.sum(axis=1) < 2 * np.pi
    return positive


def _turned_diagonals(points: Floats, normals: Floats) -> Ints:
    """Triangles (p, 2, 3) of quadrilaterals (p, 4, 3) that the fan does not cover, as positions.

    The cut is between the second and the fourth corner, unless that does not help.
    """
    faces = _position_fans(points)
    turned = _fan_covers(np.roll(points, -1, axis=1) - points[:, 1:2], normals)
    faces[turned] = [[1, 2, 3], [1, 3, 0]]
    return faces


def _ears_of(points: Floats, normals: Floats) -> Ints:
    """Triangles (p, n - 2, 3) of polygons (p, n, 3) as positions; fans of crossing polygons."""
    n = points.shape[1]
    flat = np.einsum("pni,pij->pnj", points, _plane(normals))
    fans = _position_fans(points)
    faces = fans.copy()
    for i, ring in enumerate(flat):
        ears = _ears(ring, np.array([n]))
        if len(ears) < n - 2:
            ears = np.vstack([ears, _skipped(ears, n)])
        if len(ears) == n - 2:
            faces[i] = ears
    wrong = _overlap(points, normals, faces)
    faces[wrong] = fans[wrong]
    return faces


def _overlap(points: Floats, normals: Floats, faces: Ints) -> Flags:
    """Whether triangles (p, m, 3) of each polygon (p, n, 3) overlap in its plane."""
    a, b, c = (np.take_along_axis(points, faces[:, :, k, None], axis=1) for k in range(3))
    crosses = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    signed = np.einsum("pmi,pi->pm", crosses, normals) / np.maximum(lengths, 1e-300)[:, None]
    covered = np.abs(signed).sum(axis=1)
    surface = np.linalg.norm(crosses, axis=2).sum(axis=1)
    thin = SLIVER * np.ptp(points, axis=1).max(axis=1) ** 2
    no_side = (lengths <= 1e-6 * surface) & (surface > thin)  # e.g. two equal lobes
    over: Flags = (covered - signed.sum(axis=1) > 1e-6 * covered + thin) | no_side
    return over


def _position_fans(points: Floats) -> Ints:
    """Fans (p, n - 2, 3) of polygons (p, n, 3) as positions of corners."""
    count, n = points.shape[:2]
    return _fans(np.tile(np.arange(n), (count, 1)))


def _plane(normals: Floats) -> Floats:
    """Axes (p, 3, 2) in the planes of normals (p, 3), counter-clockwise seen from their tips."""
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    z = np.where(lengths > 0, normals / np.where(lengths > 0, lengths, 1.0), [0.0, 0.0, 1.0])
    least = np.eye(3)[np.abs(z).argmin(axis=1)]
    x = np.cross(least, z)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([x, np.cross(z, x)], axis=-1)


def _ears(flat: Floats, ends: Ints) -> Ints:
    """Counter-clockwise triangles (m, 3) of rings in the plane, as positions of their corners."""
    from mapbox_earcut import triangulate_float64

    size = np.abs(flat).max() or 1.0  # Earcut multiplies coordinates: keep clear of underflow
    ears = triangulate_float64(np.ascontiguousarray(flat / size), ends.astype(np.uint32))
    return ears.reshape(-1, 3).astype(np.int64)


def _skipped(ears: Ints, n: int) -> Ints:
    """Flat triangles for the corners that Earcut leaves out because they are on a straight side.

    They make each side of the polygon an edge of one triangle, as the neighbors expect.
    """
    sides = np.concatenate([ears[:, [0, 1]], ears[:, [1, 2]], ears[:, [2, 0]]])
    edges = {(int(a), int(b)) for a, b in sides}
    flat = [
        (a, (a + k) % n, (a + k + 1) % n)
        for a, b in sorted(edges)
        if (b, a) not in edges
        for k in range(1, (b - a) % n)
    ]
    return np.array(flat, dtype=np.int64).reshape(-1, 3)

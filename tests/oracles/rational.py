"""Exact, slow intersection tests of closed triangles and of meshes.

Doubles are fractions, so everything is decided in whole numbers over one common denominator: poses
times vertices, planes, crossings. Nothing of fgenv is used, so that it can settle disputes.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats

Point = tuple[int, int, int]
Flat = tuple[int, int]
Triangle = tuple[Point, Point, Point]


def sign(value: int) -> int:
    """-1, 0 or 1."""
    return (value > 0) - (value < 0)


def minus(p: Point, q: Point) -> Point:
    """p - q"""
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def cross(p: Point, q: Point) -> Point:
    """p x q"""
    return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]


def dot(p: Point, q: Point) -> int:
    """p . q"""
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def turn(p: Flat, q: Flat, r: Flat) -> int:
    """1 if p, q, r turn left in the plane, -1 right, 0 in line."""
    return sign((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))


def between(p: Flat, q: Flat, r: Flat) -> bool:
    """Whether r, in line with p and q, lies on the closed segment pq."""
    return all(min(p[i], q[i]) <= r[i] <= max(p[i], q[i]) for i in (0, 1))


def segments_meet(p: Flat, q: Flat, r: Flat, s: Flat) -> bool:
    """Whether the closed segments pq and rs of a plane share a point."""
    a, b, c, d = turn(p, q, r), turn(p, q, s), turn(r, s, p), turn(r, s, q)
    if a * b < 0 and c * d < 0:
        return True
    ends = ((a, p, q, r), (b, p, q, s), (c, r, s, p), (d, r, s, q))
    return any(side == 0 and between(u, v, w) for side, u, v, w in ends)


def in_triangle(p: Flat, corners: tuple[Flat, Flat, Flat]) -> bool:
    """Whether p lies in the closed triangle of a plane (not flat)."""
    a, b, c = corners
    sides = {turn(a, b, p), turn(b, c, p), turn(c, a, p)}
    return not {1, -1} <= sides


def segment_meets(p: Point, q: Point, triangle: Triangle) -> bool:
    """Whether the closed segment pq and the closed triangle (of area not zero) share a point."""
    a, b, c = triangle
    normal = cross(minus(b, a), minus(c, a))
    assert any(normal), "a triangle without area"
    at_p, at_q = dot(normal, minus(p, a)), dot(normal, minus(q, a))
    if sign(at_p) * sign(at_q) > 0:
        return False
    axis = max(range(3), key=lambda i: abs(normal[i]))
    keep = [i for i in range(3) if i != axis]

    def flat(point: Point, scale: int = 1) -> Flat:
        return point[keep[0]] * scale, point[keep[1]] * scale

    if at_p == at_q:  # both 0: the segment lies in the plane
        corners = flat(a), flat(b), flat(c)
        start, end = flat(p), flat(q)
        sides = zip(corners, corners[1:] + corners[:1], strict=True)
        inside = in_triangle(start, corners) or in_triangle(end, corners)
        return inside or any(segments_meet(start, end, *side) for side in sides)
    # The crossing is (p at_q - q at_p) / (at_q - at_p): bring all to that denominator.
    scale = at_q - at_p
    x, y, z = (at_q * p[i] - at_p * q[i] for i in range(3))
    return in_triangle(flat((x, y, z)), (flat(a, scale), flat(b, scale), flat(c, scale)))


def triangles_meet(first: Triangle, second: Triangle) -> bool:
    """Whether two closed triangles share a point: an edge of one then meets the other."""
    for edges, face in ((first, second), (second, first)):
        for i in range(3):
            if segment_meets(edges[i], edges[i - 1], face):
                return True
    return False


def world_points(vertices: Floats, pose: Floats, bits: int) -> list[Point]:
    """Exact `pose` times `vertices`, in units of 2**-bits meters."""
    rows = [[_whole(pose[i, j], bits // 2) for j in range(3)] for i in range(3)]
    shift = [_whole(pose[i, 3], bits) for i in range(3)]

    def moved(vertex: Floats) -> Point:
        point = [_whole(value, bits // 2) for value in vertex]
        x, y, z = (
            sum(r * v for r, v in zip(row, point, strict=True)) + t
            for row, t in zip(rows, shift, strict=True)
        )
        return x, y, z

    return [moved(vertex) for vertex in vertices]


def _whole(value: float, bits: int) -> int:
    above, below = float(value).as_integer_ratio()
    scaled, rest = divmod(above << bits, below)
    assert rest == 0, "more bits are needed"
    return scaled


def _bits(*arrays: Floats) -> int:
    """Binary places that hold every value of the arrays."""
    mantissa, exponent = np.frexp(np.concatenate([array.ravel() for array in arrays]))
    lowest = exponent[mantissa != 0].min(initial=0)
    return max(0, 53 - int(lowest))


def meshes_meet(
    vertices_a: Floats,
    faces_a: NDArray[np.int32],
    pose_a: Floats,
    vertices_b: Floats,
    faces_b: NDArray[np.int32],
    pose_b: Floats,
) -> bool:
    """Whether two surfaces share a point. Faces without area are left out."""
    bits = 2 * _bits(vertices_a, vertices_b, pose_a, pose_b)
    points_a: dict[int, Point] = {}
    points_b: dict[int, Point] = {}

    def exact(
        points: dict[int, Point], vertices: Floats, pose: Floats, face: NDArray[np.int32]
    ) -> Triangle:
        for v in face.tolist():
            if v not in points:
                points[v] = world_points(vertices[v : v + 1], pose, bits)[0]
        a, b, c = (points[v] for v in face.tolist())
        return a, b, c

    for i, j in candidates(vertices_a, faces_a, pose_a, vertices_b, faces_b, pose_b):
        first = exact(points_a, vertices_a, pose_a, faces_a[i])
        second = exact(points_b, vertices_b, pose_b, faces_b[j])
        if _area(first) and _area(second) and triangles_meet(first, second):
            return True
    return False


def _area(triangle: Triangle) -> bool:
    a, b, c = triangle
    return any(cross(minus(b, a), minus(c, a)))


def candidates(
    vertices_a: Floats,
    faces_a: NDArray[np.int32],
    pose_a: Floats,
    vertices_b: Floats,
    faces_b: NDArray[np.int32],
    pose_b: Floats,
) -> Iterator[tuple[int, int]]:
    """Pairs of faces that doubles cannot separate (with a generous allowance for rounding)."""
    a = _corners(vertices_a, faces_a, pose_a)
    b = _corners(vertices_b, faces_b, pose_b)
    reach = max(np.abs(a).max(), np.abs(b).max())
    slack = 1e-12 * reach
    inner_a = _boxes_meet(a, b.reshape(-1, 3), slack)
    inner_b = _boxes_meet(b, a.reshape(-1, 3), slack)
    low_b, high_b = b[inner_b].min(axis=1), b[inner_b].max(axis=1)
    for i in inner_a:
        near = (low_b <= a[i].max(axis=0) + slack) & (high_b >= a[i].min(axis=0) - slack)
        some = inner_b[near.all(axis=1)]
        if len(some):
            yield from ((int(i), int(j)) for j in some[_not_parted(a[i], b[some], slack)])


def _corners(vertices: Floats, faces: NDArray[np.int32], pose: Floats) -> Floats:
    return np.asarray((vertices @ pose[:3, :3].T + pose[:3, 3])[faces])


def _boxes_meet(corners: Floats, others: Floats, slack: float) -> NDArray[np.intp]:
    low, high = others.min(axis=0) - slack, others.max(axis=0) + slack
    return np.flatnonzero(
        ((corners.max(axis=1) >= low) & (corners.min(axis=1) <= high)).all(axis=1)
    )


def _not_parted(triangle: Floats, others: Floats, slack: float) -> NDArray[np.bool_]:
    """Which of `others` (n, 3, 3) are not clearly on one side of the plane of `triangle`."""
    normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
    length = np.linalg.norm(normal)
    if length == 0.0:
        return np.ones(len(others), np.bool_)
    height = (others - triangle[0]) @ (normal / length)
    # the normal of a sliver is far off where its area is small beside its edges
    edge = np.abs(triangle - triangle[0]).max()
    far = max(edge, np.abs(others - triangle[0]).max())
    allow = 8.0 * slack * (1.0 + edge * far / length)
    return np.asarray((height.min(axis=1) <= allow) & (height.max(axis=1) >= -allow))

"""Meshes of boxes, cylinders, spheres, ellipsoids and capsules; round ones are enclosed.

A 'free' verdict must hold for the exact shape, so that meshes are circumscribed, never inscribed.
Lengths are meters, meshes are closed. Sines come from the native core, so that a mesh is the same
on every machine.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv import _core
from fgenv.arrays import Faces, Floats, Vertices
from fgenv.collision import Shape

from .links_joints import number_of

ERROR = 1e-3  # meters
MIN_SIDES, MAX_SIDES = 8, 256  # of a cylinder
MAX_CAPSULE_SIDES = 128
MAX_SUBDIVISIONS = 5  # of an icosahedron: 80 to 20,480 faces
OUTWARD = 1 + 1e-12  # exceeds the rounding error


def box(size: ArrayLike, name: str = "box", **options: Any) -> Shape:
    """A box with edges (3,) along the axes, centered at the origin; `options` of Shape."""
    edges = np.array(size, dtype=np.float64)
    if edges.shape != (3,) or not (np.isfinite(edges).all() and (edges > 0).all()):
        raise ValueError(f"{name}: size: got {size!r}, expected three lengths over 0")
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [f for a, b, c, d in sides for f in ((a, b, c), (a, c, d))]
    return Shape(0.5 * edges * corners, faces, name=name, **options)


def cylinder(
    radius: float, length: float, error: float = ERROR, name: str = "cylinder", **options: Any
) -> tuple[Shape, float]:
    """A prism around a cylinder along z, centered at the origin, and its excess (m).

    Args:
        radius, length: meters, over 0.
        error: upper bound of the excess, meters, unless that needs more than 256 sides.
        name: of the shape.
        options: of Shape.
    """
    radius, length = _length(radius, f"{name}: radius"), _length(length, f"{name}: length")
    error = _length(error, f"{name}: error")
    for sides in range(MIN_SIDES, MAX_SIDES + 1, 4):
        _, cosine = _core.sin_cos(math.pi / sides)
        outer = radius / float(cosine) * OUTWARD
        if outer - radius <= error:
            break
    sines, cosines = _core.sin_cos(2 * math.pi / sides * np.arange(sides))
    ring = np.column_stack([outer * cosines, outer * sines])
    half = np.full((sides, 1), 0.5 * length)
    here, there = np.arange(sides), np.roll(np.arange(sides), -1)
    fan = np.arange(1, sides - 1)
    faces = [
        np.column_stack([here, there, there + sides]),
        np.column_stack([here, there + sides, here + sides]),
        np.column_stack([0 * fan, fan + 1, fan]),
        np.column_stack([0 * fan, fan, fan + 1]) + sides,
    ]
    vertices = np.vstack([np.hstack([ring, -half]), np.hstack([ring, half])])
    return Shape(vertices, np.vstack(faces), name=name, **options), outer - radius


def sphere(
    radius: float, error: float = ERROR, name: str = "sphere", **options: Any
) -> tuple[Shape, float]:
    """A polyhedron around a sphere at the origin, and its excess (m).

    Args:
        radius: meters, over 0.
        error: upper bound of the excess, meters, unless that needs more than 20,480 faces.
        name: of the shape.
        options: of Shape.
    """
    radius, error = _length(radius, f"{name}: radius"), _length(error, f"{name}: error")
    outer, vertices, faces = _around_sphere(radius, error)
    return Shape(outer * vertices, faces, name=name, **options), outer - radius


def ellipsoid(
    radii: ArrayLike, error: float = ERROR, name: str = "ellipsoid", **options: Any
) -> tuple[Shape, float]:
    """A polyhedron around an ellipsoid at the origin, and its excess (m).

    Args:
        radii: (3,), semi-axes along x, y, z, meters, over 0.
        error: upper bound of the excess, meters, unless that needs more than 20,480 faces.
        name: of the shape.
        options: of Shape.
    """
    axes = np.array(radii, dtype=np.float64)
    if axes.shape != (3,) or not (np.isfinite(axes).all() and (axes > 0).all()):
        raise ValueError(f"{name}: radii: got {radii!r}, expected three lengths over 0")
    longest = float(axes.max())
    outer, vertices, faces = _around_sphere(1.0, _length(error, f"{name}: error") / longest)
    outer *= OUTWARD  # the products below are rounded
    return Shape(outer * axes * vertices, faces, name=name, **options), longest * (outer - 1)


def capsule(
    radius: float, length: float, error: float = ERROR, name: str = "capsule", **options: Any
) -> tuple[Shape, float]:
    """A polyhedron around a capsule along z, centered at the origin, and its excess (m).

    Args:
        radius: meters, over 0.
        length: distance of the centers of its half spheres, meters, over 0.
        error: upper bound of the excess, meters, unless that needs more than 128 sides.
        name: of the shape.
        options: of Shape.
    """
    radius, length = _length(radius, f"{name}: radius"), _length(length, f"{name}: length")
    error = _length(error, f"{name}: error")
    for sides in range(MIN_SIDES, MAX_CAPSULE_SIDES + 1, 4):
        heights, widths = _core.sin_cos(2 * math.pi / sides * np.arange(sides // 4 + 1))
        middles = widths * float(_core.sin_cos(math.pi / sides)[1])  # of the chords of each ring
        area = middles[:-1] * heights[1:] - middles[1:] * heights[:-1]
        edge = np.sqrt(np.diff(middles) ** 2 + np.diff(heights) ** 2)
        outer = radius / float(np.min(area / edge)) * OUTWARD
        if outer - radius <= error:
            break
    vertices, faces = _rings(outer * widths[:-1], outer * heights[:-1] + 0.5 * length, sides)
    poles = [(0.0, 0.0, z * (outer + 0.5 * length)) for z in (1, -1)]
    return Shape(np.vstack([vertices, poles]), faces, name=name, **options), outer - radius


def _rings(widths: Floats, heights: Floats, sides: int) -> tuple[Vertices, Faces]:
    """Rings of a surface of revolution that is symmetric in z, and faces with two poles.

    Args:
        widths, heights: of the rings of the upper half, from the equator up, meters.

    Returns:
        Vertices of all rings from the top; faces, with the poles as the next two vertices.
    """
    sines, cosines = _core.sin_cos(2 * math.pi / sides * np.arange(sides))
    w, z = np.concatenate([widths[::-1], widths]), np.concatenate([heights[::-1], -heights])
    rings = [np.outer(w, cosines), np.outer(w, sines), np.repeat(z[:, None], sides, axis=1)]
    here = np.arange(sides)
    there = np.roll(here, -1)
    first = sides * np.arange(len(w) - 1)[:, None]
    a, b = (first + here).ravel(), (first + there).ravel()
    last, north = sides * (len(w) - 1), sides * len(w)
    faces = [
        np.column_stack([a + sides, b + sides, b]),
        np.column_stack([a + sides, b, a]),
        np.column_stack([0 * here + north, here, there]),
        np.column_stack([0 * here + north + 1, last + there, last + here]),
    ]
    return np.stack(rings, axis=-1).reshape(-1, 3), np.vstack(faces)


def _around_sphere(radius: float, error: float) -> tuple[float, Vertices, Faces]:
    """A polyhedron around a sphere: the radius around it, its unit vertices, and its faces."""
    vertices, faces = _icosahedron()
    for _ in range(MAX_SUBDIVISIONS):
        vertices, faces = _subdivided(vertices, faces)
        a, b, c = (vertices[faces[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        nearest = np.min(_dot(normals, a) / np.sqrt(_dot(normals, normals)))
        outer = radius / float(nearest) * OUTWARD
        if outer - radius <= error:
            break
    return outer, vertices, faces


def _length(value: float, name: str) -> float:
    length = number_of(value, name, finite=True)
    if length <= 0:
        raise ValueError(f"{name}: got {value!r}, expected meters, over 0")
    return length


def _dot(a: Vertices, b: Vertices) -> NDArray[np.float64]:
    return a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]


def _on_sphere(points: Vertices) -> Vertices:
    return points / np.sqrt(_dot(points, points))[:, None]


def _icosahedron() -> tuple[Vertices, Faces]:
    g = (1 + math.sqrt(5)) / 2
    corners: list[tuple[float, ...]] = [
        (-1, g, 0),
        (1, g, 0),
        (-1, -g, 0),
        (1, -g, 0),
        (0, -1, g),
        (0, 1, g),
    ]
    corners += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4)]
    faces += [(11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8)]
    faces += [(3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    return _on_sphere(np.array(corners, dtype=np.float64)), np.array(faces)


def _subdivided(vertices: Vertices, faces: Faces) -> tuple[Vertices, Faces]:
    """Each face split into four, with the new vertices on the sphere."""
    n = len(vertices)
    a, b, c = faces.T
    edges = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    pairs, where = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = n + where.reshape(3, -1)
    middles = _on_sphere(vertices[pairs[:, 0]] + vertices[pairs[:, 1]])
    quarters = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return np.vstack([vertices, middles]), np.vstack([np.column_stack(q) for q in quarters])

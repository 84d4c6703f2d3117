"""Queries between two posed shapes.

Poses are homogeneous matrices (..., 4, 4): rigid motions from the shape's frame to the world, in
meters. They broadcast. Arrays run on `threads` threads (default: the environment variable
FGENV_THREADS, else all cores), with the same result bit for bit for any number of them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fgenv import _core
from fgenv.arrays import Floats

from .shape import Shape


class NearestPoints(NamedTuple):
    """Nearest points of two shapes, world frame; leading dimensions are those of the poses."""

    distance: Floats  # (...), meters; 0 if they collide
    point_a: Floats  # (..., 3)
    point_b: Floats  # (..., 3)
    normal: Floats  # (..., 3), unit, from b to a


class ContactPoint(NamedTuple):
    """A contact point and the features that intersect there, world frame."""

    point: Floats  # (3,)
    normal: Floats  # (3,), unit: the direction that moves a off b
    edge: Floats | None  # (2, 3) ends of the feature edge; None: one shape contains the other
    face: int | None  # index of the other shape's face that the edge meets
    edge_of: str | None  # "a" or "b": the shape that the edge belongs to


collide = _core.collide
distance = _core.distance


def nearest_points(
    a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, *, threads: int | None = None
) -> NearestPoints:
    """Nearest points, distance and normal.

    If the shapes collide, the distance is 0 and both points are a contact point.
    """
    return NearestPoints(*_core.nearest_points(a, Ta, b, Tb, threads=threads))


def contact_point(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike) -> ContactPoint | None:
    """A contact point with its feature edge and face; None without a collision.

    Args:
        Ta, Tb: one pose each, (4, 4).
    """
    found = _core.contact_point(a, Ta, b, Tb)
    if found is None:
        return None
    point, normal, edge, face, edge_of_a = found
    if edge is None:
        return ContactPoint(np.array(point), np.array(normal), None, None, None)
    return ContactPoint(
        np.array(point), np.array(normal), np.array(edge), face, "a" if edge_of_a else "b"
    )

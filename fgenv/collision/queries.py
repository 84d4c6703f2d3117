"""Queries between two posed shapes.

Poses are homogeneous matrices (..., 4, 4): rigid motions from the shape's frame to the world, in
meters. They broadcast. Arrays run on `threads` threads (default: the environment variable
FGENV_THREADS, else all cores), with the same result bit for bit for any number of them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv import _core

from .shape import Shape


class Nearest(NamedTuple):
    """Nearest points of two shapes, world frame; leading dimensions are those of the poses."""

    distance: NDArray[np.float64]  # (...), meters; 0 where they collide
    point_a: NDArray[np.float64]  # (..., 3)
    point_b: NDArray[np.float64]  # (..., 3)
    normal: NDArray[np.float64]  # (..., 3), unit, from b to a


class Contact(NamedTuple):
    """What shows a collision, world frame."""

    point: NDArray[np.float64]  # (3,)
    normal: NDArray[np.float64]  # (3,), unit: the way to push a off b
    edge: NDArray[np.float64] | None  # (2, 3) ends of the feature edge; None: one is inside
    face: int | None  # index of the face that it meets, of the other shape
    edge_of: str | None  # "a" or "b": whose feature edge


collide = _core.collide
distance = _core.distance


def nearest(
    a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, *, threads: int | None = None
) -> Nearest:
    """Nearest points, distance and normal.

    Where the shapes collide the distance is 0 and both points are a contact point.
    """
    return Nearest(*_core.nearest(a, Ta, b, Tb, threads))


def contact(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike) -> Contact | None:
    """A contact point with the feature edge and the face that show it; None if free.

    Args:
        Ta, Tb: one pose each, (4, 4).
    """
    found = _core.contact(a, Ta, b, Tb)
    if found is None:
        return None
    point, normal, edge, face, edge_of_a = found
    if edge is None:
        return Contact(np.array(point), np.array(normal), None, None, None)
    return Contact(
        np.array(point), np.array(normal), np.array(edge), face, "a" if edge_of_a else "b"
    )

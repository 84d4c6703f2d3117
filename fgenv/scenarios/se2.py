"""Planar poses: configurations (x, y, yaw) on the floor, and paths of them."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.arrays import Floats


def as_poses(configurations: ArrayLike, height: float = 0.0) -> Floats:
    """Poses (..., 4, 4) of configurations (..., 3): x, y in meters, yaw in radians about z.

    `height` is the z of the body's origin in meters.
    """
    q = np.asarray(configurations, dtype=np.float64)
    if q.shape[-1:] != (3,):
        raise ValueError(f"configurations: got shape {q.shape}, want (..., 3): x, y, yaw")
    cos, sin = np.cos(q[..., 2]), np.sin(q[..., 2])
    poses = np.zeros((*q.shape[:-1], 4, 4))
    poses[..., 0, 0] = poses[..., 1, 1] = cos
    poses[..., 1, 0], poses[..., 0, 1] = sin, -sin
    poses[..., 2, 2] = poses[..., 3, 3] = 1.0
    poses[..., :2, 3], poses[..., 2, 3] = q[..., :2], height
    return poses


def as_path(path: ArrayLike) -> Floats:
    """A path (n, 3) of configurations, n >= 2, its yaw made continuous.

    Between two configurations x, y and yaw run linearly, yaw the short way round, as in OMPL's
    SE2; after this call the difference of neighbors is the turn itself.
    Raises ValueError for another shape, fewer than two configurations, NaN or infinity.
    """
    q = np.array(path, dtype=np.float64)
    if q.ndim != 2 or q.shape[1] != 3 or len(q) < 2:
        raise ValueError(f"path: got shape {q.shape}, want (n, 3) with n >= 2: x, y, yaw")
    if not np.isfinite(q).all():
        raise ValueError("path: got NaN or infinity, want finite x, y, yaw")
    q[:, 2] = np.unwrap(q[:, 2])
    return q


def reach(vertices: Floats) -> float:
    """Meters from a body's z axis to its farthest vertex: what a turn of one radian moves."""
    return float(np.hypot(vertices[:, 0], vertices[:, 1]).max())


def travel(path: Floats, radius: float) -> Floats:
    """For each leg of a path (n, 3): meters (n - 1,) that no point of the body moves beyond.

    The body's points lie within `radius` of its z axis (see `reach`).
    """
    step = np.diff(path, axis=0)
    return np.asarray(np.hypot(step[:, 0], step[:, 1]) + radius * np.abs(step[:, 2]))


def cut(path: Floats, pieces: NDArray[np.int64]) -> Floats:
    """A path (n, 3) with each leg cut into so many equal pieces (n - 1,)."""
    parts = [
        np.linspace(a, b, n, endpoint=False)
        for a, b, n in zip(path[:-1], path[1:], pieces, strict=True)
    ]
    return np.concatenate([*parts, path[-1:]])


def refine(path: Floats, radius: float, step: float) -> Floats:
    """A path cut so that no point of the body moves more than `step` meters in a leg."""
    return cut(path, np.maximum(1, np.ceil(travel(path, radius) / step)).astype(np.int64))

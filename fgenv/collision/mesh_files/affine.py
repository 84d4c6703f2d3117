"""Affine matrices of scene nodes, with the same bits on every machine (no BLAS, no libm)."""

from __future__ import annotations

import math

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats, Vertices


def compose(first: Floats, second: Floats) -> Floats:
    """The product of matrices (4, 4): second is applied before first."""
    with np.errstate(over="ignore", invalid="ignore"):  # infinity is reported where it is used
        product: Floats = (first[:, :, None] * second).sum(axis=1)  # in the order of the rows
    return product


def transformed(vertices: Vertices, poses: Floats) -> Floats:
    """Vertices (n, 3), moved by matrices (..., 4, 4): (..., n, 3)."""
    with np.errstate(over="ignore", invalid="ignore"):
        x, y, z = (vertices[:, k : k + 1] * poses[..., None, :3, k] for k in range(3))
        moved: Floats = x + y + z + poses[..., None, :3, 3]
    return moved


def mirrors(poses: Floats) -> Flags:
    """Whether matrices (..., 3, 3) or (..., 4, 4) turn solids inside out, whatever their scale."""
    linear = poses[..., :3, :3]
    size = np.abs(linear).max(axis=(-1, -2), keepdims=True)
    a, b, c = np.moveaxis(linear / np.where(size > 0, size, 1.0), -1, 0)
    negative: Flags = (np.cross(a, b) * c).sum(axis=-1) < 0
    return negative


def translation(offset: Floats) -> Floats:
    """A translation by (3,) as a matrix (4, 4)."""
    pose = np.eye(4)
    pose[:3, 3] = offset
    return pose


def scaling(factors: Floats) -> Floats:
    """A scaling by (3,) as a matrix (4, 4)."""
    return np.diag([*factors, 1.0])


def quaternion_rotation(quaternion: Floats) -> Floats:
    """The rotation (4, 4) of a quaternion x, y, z, w of a length over 0."""
    x, y, z, w = (quaternion / math.sqrt(float((quaternion * quaternion).sum()))).tolist()
    pose = np.eye(4)
    pose[0, :3] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)
    pose[1, :3] = 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
    pose[2, :3] = 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)
    return pose


def axis_rotation(axis: Floats, degrees: float) -> Floats:
    """The rotation (4, 4) about an axis (3,) of a length over 0."""
    x, y, z = (axis / math.sqrt(float((axis * axis).sum()))).tolist()
    quarters = degrees / 90
    if quarters.is_integer():  # exact zeros
        s, c = ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))[int(quarters % 4)]
    else:
        sines, cosines = _core.sin_cos([math.radians(math.fmod(degrees, 360))])
        s, c = float(sines[0]), float(cosines[0])
    d = 1 - c
    pose = np.eye(4)
    pose[0, :3] = c + x * x * d, x * y * d - z * s, x * z * d + y * s
    pose[1, :3] = y * x * d + z * s, c + y * y * d, y * z * d - x * s
    pose[2, :3] = z * x * d - y * s, z * y * d + x * s, c + z * z * d
    return pose

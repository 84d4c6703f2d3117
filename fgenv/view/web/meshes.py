"""Shapes as a browser draws them: sharp where they are sharp, and poses as viser has them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats, Floats32
from fgenv.collision import Shape
from fgenv.view.figures.normals import corner_normals
from fgenv.view.figures.palette import Color, to_linear
from fgenv.view.figures.surfaces import SMOOTH

DIM = 0.45


def mesh_of(shape: Shape) -> tuple[Floats32, NDArray[np.uint32]]:
    """Vertices (v, 3) and faces (f, 3); a vertex on a sharp edge is there once for each side.

    A browser shades round whatever shares a vertex.
    """
    normals = corner_normals(shape.vertices, shape.faces, SMOOTH).reshape(-1, 3)
    corners = shape.faces.ravel()
    key = np.column_stack([corners, np.rint(normals * 1000)]).astype(np.int64)
    _, first, place = np.unique(key, axis=0, return_index=True, return_inverse=True)
    vertices = shape.vertices[corners[first]].astype(np.float32)
    return vertices, place.reshape(-1, 3).astype(np.uint32)


def quaternions(poses: Floats) -> Floats32:
    """Orientations of poses (..., 4, 4) as viser has them: w, x, y, z, (..., 4), w not below 0."""
    r = poses[..., :3, :3]
    trace = np.trace(r, axis1=-2, axis2=-1)
    diagonal = np.diagonal(r, axis1=-2, axis2=-1)
    # Four times the products of the quaternion's numbers; its longest row is that times a number.
    four = np.empty((*r.shape[:-2], 4, 4))
    four[..., 0, 0] = 1.0 + trace
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        four[..., i + 1, i + 1] = 1.0 + 2.0 * diagonal[..., i] - trace
        four[..., 0, i + 1] = four[..., i + 1, 0] = r[..., k, j] - r[..., j, k]
        four[..., i + 1, j + 1] = four[..., j + 1, i + 1] = r[..., j, i] + r[..., i, j]
    best = np.diagonal(four, axis1=-2, axis2=-1).argmax(axis=-1)
    row = np.take_along_axis(four, best[..., None, None], axis=-2)[..., 0, :]
    row *= np.where(row[..., :1] < 0, -1.0, 1.0)
    return np.asarray(row / np.linalg.norm(row, axis=-1, keepdims=True), dtype=np.float32)


def many_rgb(colors: Sequence[Color]) -> NDArray[np.uint8]:
    """sRGB colors of batched meshes, (n, 3): viser takes their bytes for linear light.

    They are darkened, for viser's light is so strong that it washes them out.
    """
    return np.rint(255 * DIM * to_linear(np.reshape(colors, (-1, 3)))).astype(np.uint8)


def line_rgb(colors: Sequence[Color]) -> NDArray[np.uint8]:
    """sRGB colors of lines, (n, 3): viser takes many, not one for all, for linear light too."""
    return np.rint(255 * to_linear(np.reshape(colors, (-1, 3)))).astype(np.uint8)


def rgb(color: Color) -> tuple[int, int, int]:
    """An sRGB color in bytes."""
    red, green, blue = (round(255 * c) for c in color)
    return red, green, blue

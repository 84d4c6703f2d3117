"""Meshes, poses and colors in the form that viser expects."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats, Floats32
from fgenv.collision import Shape
from fgenv.view.figures.normals import SMOOTH, corner_normals
from fgenv.view.figures.palette import Color, rgba, to_linear

DIM = 0.45  # factor of mesh colors: viser's light washes out brighter ones


def mesh_of(shape: Shape) -> tuple[Floats32, NDArray[np.uint32]]:
    """Return vertices (v, 3) and faces (f, 3) of a mesh that a browser shades like the painter.

    A browser shades smoothly across shared vertices, so vertices on sharp edges are duplicated.
    """
    normals = corner_normals(shape.vertices, shape.faces, SMOOTH).reshape(-1, 3)
    corners = shape.faces.ravel()
    key = np.column_stack([corners, np.rint(normals * 1000)]).astype(np.int64)
    _, first, index = np.unique(key, axis=0, return_index=True, return_inverse=True)
    vertices = shape.vertices[corners[first]].astype(np.float32)
    return vertices, index.reshape(-1, 3).astype(np.uint32)


def quaternions(poses: Floats) -> Floats32:
    """Return the orientations (..., 4) of poses (..., 4, 4) in viser's order w, x, y, z, w >= 0."""
    r = poses[..., :3, :3]
    trace = np.trace(r, axis1=-2, axis2=-1)
    diagonal = np.diagonal(r, axis1=-2, axis2=-1)
    # Four times the products of the components; the longest row is one component times the rest.
    products = np.empty((*r.shape[:-2], 4, 4))
    products[..., 0, 0] = 1.0 + trace
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        products[..., i + 1, i + 1] = 1.0 + 2.0 * diagonal[..., i] - trace
        products[..., 0, i + 1] = products[..., i + 1, 0] = r[..., k, j] - r[..., j, k]
        products[..., i + 1, j + 1] = products[..., j + 1, i + 1] = r[..., j, i] + r[..., i, j]
    best = np.diagonal(products, axis1=-2, axis2=-1).argmax(axis=-1)
    row = np.take_along_axis(products, best[..., None, None], axis=-2)[..., 0, :]
    row *= np.where(row[..., :1] < 0, -1.0, 1.0)
    return np.asarray(row / np.linalg.norm(row, axis=-1, keepdims=True), dtype=np.float32)


def mesh_rgb(colors: Sequence[Color]) -> NDArray[np.uint8]:
    """Return the bytes (n, 3) of sRGB colors of meshes: viser reads them as linear light."""
    return np.rint(255 * DIM * to_linear(np.reshape(colors, (-1, 3)))).astype(np.uint8)


def line_rgb(colors: Sequence[Color]) -> NDArray[np.uint8]:
    """Return the bytes (n, 3) of sRGB colors of lines: viser reads several as linear light too."""
    return np.rint(255 * to_linear(np.reshape(colors, (-1, 3)))).astype(np.uint8)


def rgb(color: Color) -> tuple[int, int, int]:
    """Return an sRGB color as bytes."""
    return rgba(color)[:3]

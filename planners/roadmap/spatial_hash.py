"""Spatial hash: square cells of the xy plane, for a cheap test of which spheres can be near."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fgenv.arrays import Floats, Ints

STRIDE = 1 << 20  # cells along y

Neighborhood = tuple[int, int]  # a cell, and a reach around it in cell sides


class RoadmapCells(NamedTuple):
    """Side of a cell (m), and the neighborhood of each vertex and each edge of a roadmap."""

    side: float
    vertices: list[Neighborhood]
    edges: list[Neighborhood]

    @classmethod
    def from_spheres(
        cls, vertices: tuple[Floats, Floats], edges: tuple[Floats, Floats]
    ) -> RoadmapCells:
        """Cells for the bounding spheres, centers (n, 3) and radii (n,), of vertices and edges."""
        side = float(vertices[1].max())
        reach = np.ceil(edges[1] / side + 1e-6).astype(np.int64).tolist()
        at_edges = zip(cells_at(edges[0], side).tolist(), reach, strict=True)
        return cls(side, [(c, 1) for c in cells_at(vertices[0], side).tolist()], list(at_edges))


def cells_at(center: Floats, side: float) -> Ints:
    """Numbers (n,) of the cells that contain points (n, 3)."""
    cell = np.floor(center[:, :2] / side).astype(np.int64)
    return np.asarray(cell[:, 0] * STRIDE + cell[:, 1])


def cells_near(center: Floats, radius: Floats, side: float, reach: float) -> frozenset[int]:
    """Numbers of the cells where a sphere of radius `reach` (m) can overlap one of the spheres.

    Args:
        center, radius: (n, 3) and (n,), meters.
        side: of a cell, meters.
        reach: meters.
    """
    wide = (radius + reach)[:, None]
    low = np.floor((center[:, :2] - wide) / side).astype(np.int64)
    high = np.floor((center[:, :2] + wide) / side).astype(np.int64)
    count = (high - low).max(0) + 1
    x = low[:, :1] + np.arange(count[0])
    y = low[:, 1:] + np.arange(count[1])
    x, y = np.minimum(x, high[:, :1]), np.minimum(y, high[:, 1:])
    return frozenset(np.unique(x[:, :, None] * STRIDE + y[:, None]).tolist())

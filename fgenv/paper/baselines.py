"""The baselines of the published paper: boxes, sphere, hull and grid. For comparison only.

Each is a class for one pair of meshes with `collides(Ta, Tb)` for world poses (4, 4), and `tests`:
the number of elementary tests (a box, sphere, hull or cell against another) of the last query. All
cover the mesh's surface: they report every contact of surfaces, and false ones. Bounding volumes
also report a body inside another; the grid, which covers surfaces only, does not.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import trimesh
from numpy.typing import NDArray

from fgenv.arrays import Floats

TRIMESH: Any = trimesh  # parts of it have no annotations
CROSS = -np.cross(np.eye(3)[:, None], np.eye(3)[None])  # CROSS[i] @ v = e_i x v
SLACK = 1e-12  # relative to the size; boxes that touch overlap whatever the rounding


class Mesh(Protocol):
    """A mesh, such as `Shape`."""

    @property
    def vertices(self) -> Floats:
        """Vertices (n, 3), meters."""

    @property
    def faces(self) -> NDArray[np.int32]:
        """Faces (m, 3)."""


class Baseline(Protocol):
    """A collision method for one pair of meshes."""

    tests: int  # elementary tests of the last query

    def collides(self, Ta: Floats, Tb: Floats) -> bool:
        """Whether the bounds overlap at world poses (4, 4) of the bodies; touching counts."""


def hull(mesh: Mesh) -> trimesh.Trimesh:
    """The convex hull of the vertices that faces use, with outward winding."""
    used = np.unique(mesh.faces)
    points = np.asarray(mesh.vertices)[used]
    convex: trimesh.Trimesh = TRIMESH.convex.convex_hull(points)
    return convex


def move(T: Floats, points: Floats) -> Floats:
    """Transform points (n, 3) by a pose (4, 4)."""
    return np.asarray(points @ T[:3, :3].T + T[:3, 3])


def boxes_overlap(
    rotation: Floats, offset: Floats, half_a: Floats, half_b: Floats
) -> NDArray[np.bool_]:
    """Whether boxes overlap (...), by the 15 separating axes (Gottschalk, Lin, Manocha 1996).

    Touching counts.

    Args:
        rotation: (3, 3) of b in a's frame.
        offset: (..., 3) from a's center to b's in a's frame.
        half_a, half_b: (3,) half sides.
    """
    crosses = (CROSS @ rotation).transpose(0, 2, 1).reshape(9, 3)
    axes = np.concatenate((np.eye(3), rotation.T, crosses))  # (15, 3)
    reach = np.abs(axes) @ half_a + np.abs(axes @ rotation) @ half_b
    slack = SLACK * (half_a.sum() + half_b.sum())
    return np.asarray(np.all(np.abs(offset @ axes.T) <= reach + slack, axis=-1))


class Aabb:
    """World axis-aligned box of the posed mesh, computed from its hull at each pose."""

    def __init__(self, a: Mesh, b: Mesh) -> None:
        self._a, self._b = (np.array(hull(m).vertices).T.copy() for m in (a, b))  # (3, n)
        self.tests = 0

    def collides(self, Ta: Floats, Tb: Floats) -> bool:
        """One box against one box."""
        self.tests = 1
        a, b = Ta[:3, :3] @ self._a, Tb[:3, :3] @ self._b
        gap = Tb[:3, 3] - Ta[:3, 3]
        below, above = a.min(axis=1) - b.max(axis=1), a.max(axis=1) - b.min(axis=1)
        return bool(((below <= gap) & (gap <= above)).all())


class Obb:
    """The oriented box of least volume around each mesh, by trimesh."""

    def __init__(self, a: Mesh, b: Mesh) -> None:
        (self._box_a, self._half_a), (self._box_b, self._half_b) = self._bound(a), self._bound(b)
        self.tests = 0

    @staticmethod
    def _bound(mesh: Mesh) -> tuple[Floats, Floats]:
        """Pose (4, 4) of the box in the body frame and its half sides (3,)."""
        points = np.asarray(hull(mesh).vertices)
        inverse, _ = TRIMESH.bounds.oriented_bounds(points)
        box = np.linalg.inv(inverse)
        local = move(inverse, points)  # measured again, so that the box contains every vertex
        box[:3, 3] = move(box, 0.5 * (local.min(axis=0) + local.max(axis=0)))
        return box, 0.5 * np.ptp(local, axis=0)

    def collides(self, Ta: Floats, Tb: Floats) -> bool:
        """One box against one box."""
        self.tests = 1
        a, b = Ta @ self._box_a, Tb @ self._box_b
        offset = a[:3, :3].T @ (b[:3, 3] - a[:3, 3])
        return bool(boxes_overlap(a[:3, :3].T @ b[:3, :3], offset, self._half_a, self._half_b))


class Sphere:
    """The smallest sphere around each mesh."""

    def __init__(self, a: Mesh, b: Mesh) -> None:
        (self._center_a, radius_a), (self._center_b, radius_b) = self._bound(a), self._bound(b)
        self._reach = radius_a + radius_b
        self.tests = 0

    @staticmethod
    def _bound(mesh: Mesh) -> tuple[Floats, float]:
        """Center (3,) and radius, measured again so that the sphere contains every vertex."""
        points = np.asarray(hull(mesh).vertices)
        center, _ = TRIMESH.nsphere.minimum_nsphere(points)
        return center, float(np.linalg.norm(points - center, axis=1).max())

    def collides(self, Ta: Floats, Tb: Floats) -> bool:
        """One sphere against one sphere."""
        self.tests = 1
        gap = move(Ta, self._center_a) - move(Tb, self._center_b)
        return bool(gap @ gap <= self._reach * self._reach)


class Hull:
    """Convex hulls, exact up to GJK's tolerance: python-fcl's ``Convex`` (libccd)."""

    def __init__(self, a: Mesh, b: Mesh) -> None:
        try:
            import fcl
        except ImportError:
            raise ModuleNotFoundError(
                'fcl: not installed, expected for hulls; run pip install "fgenv[bench]"'
            ) from None
        self._fcl: Any = fcl
        self._a, self._b = (fcl.CollisionObject(self._convex(hull(m))) for m in (a, b))
        self._request = fcl.CollisionRequest()
        self.tests = 0

    def _convex(self, mesh: trimesh.Trimesh) -> Any:
        polygons = np.insert(mesh.faces, 0, 3, axis=1)  # per face: number of corners, then corners
        return self._fcl.Convex(np.array(mesh.vertices), len(polygons), polygons.ravel())

    def collides(self, Ta: Floats, Tb: Floats) -> bool:
        """One hull against one hull."""
        self.tests = 1
        self._a.setTransform(self._fcl.Transform(Ta[:3, :3], Ta[:3, 3]))
        self._b.setTransform(self._fcl.Transform(Tb[:3, :3], Tb[:3, 3]))
        result = self._fcl.CollisionResult()
        return bool(self._fcl.collide(self._a, self._b, self._request, result) > 0)


class Grid:
    """Boxes of a uniform grid in each body's frame: the cells that intersect its surface.

    Each cell of b is tested against the cells of a that overlap its axis-aligned bound in a's
    frame, until the first hit. `tests` counts these pairs.
    """

    def __init__(self, a: Mesh, b: Mesh, cells: int = 32) -> None:
        """`cells` along the longest side of each body."""
        self._cell_a, self._origin_a, ijk = voxels(a, cells)
        self._filled = np.zeros(ijk.max(axis=0) + 1, bool)  # dense, for one look-up per cell
        self._filled[tuple(ijk.T)] = True
        self._cell_b, origin_b, ijk = voxels(b, cells)
        self._centers_b = origin_b + (ijk + 0.5) * self._cell_b
        self.tests = 0

    def collides(self, Ta: Floats, Tb: Floats) -> bool:
        """Cell boxes against cell boxes."""
        rotation = Ta[:3, :3].T @ Tb[:3, :3]
        centers = move(Tb, self._centers_b) - Ta[:3, 3]
        ijk, b = self._near(centers @ Ta[:3, :3] - self._origin_a, rotation)
        offset = self._offset(centers @ Ta[:3, :3], b, ijk)
        half_a, half_b = np.full(3, 0.5 * self._cell_a), np.full(3, 0.5 * self._cell_b)
        hits = boxes_overlap(rotation, offset, half_a, half_b)
        hit = bool(hits.any())
        self.tests = int(hits.argmax()) + 1 if hit else len(hits)
        return hit

    def _offset(self, centers: Floats, b: NDArray[np.int64], ijk: NDArray[np.int64]) -> Floats:
        """Offsets from the centers of a's cells ijk (k, 3) to b's cells (k,), in a's frame."""
        return centers[b] - (self._origin_a + (ijk + 0.5) * self._cell_a)

    def _near(
        self, centers: Floats, rotation: Floats
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Pairs of cells to test: a's cells (k, 3) and the indices of b's (k,).

        `centers` (n, 3) of b's cells are relative to a's grid, in a's frame.
        """
        reach = 0.5 * self._cell_b * np.abs(rotation).sum(axis=1) + SLACK * self._cell_b
        low = np.floor((centers - reach) / self._cell_a).astype(np.int64)
        span = np.ceil(2.0 * reach / self._cell_a).astype(np.int64) + 1
        block = np.stack(np.meshgrid(*map(np.arange, span), indexing="ij"), -1).reshape(-1, 3)
        near = np.flatnonzero(np.all((low + span > 0) & (low < self._filled.shape), axis=1))
        ijk = (low[near, None] + block).reshape(-1, 3)
        b = np.repeat(near, len(block))
        inside = np.all((ijk >= 0) & (ijk < self._filled.shape), axis=1)
        ijk, b = ijk[inside], b[inside]
        filled = self._filled[tuple(ijk.T)]
        return ijk[filled], b[filled]


def voxels(mesh: Mesh, cells: int) -> tuple[float, Floats, NDArray[np.int64]]:
    """Cell side (meters), origin (3,) and all cells (k, 3) that intersect the surface.

    There are `cells` cells along the longest side of the bounding box. Each triangle is tested
    against the cells of its bound by the other 10 of the 13 separating axes of Akenine-Moller
    (2001).
    """
    corners = np.asarray(mesh.vertices)[mesh.faces]  # (m, 3, 3)
    origin = corners.min(axis=(0, 1))
    side = float((corners.max(axis=(0, 1)) - origin).max()) / cells
    origin = origin - 0.5 * side  # flat outer faces lie within cells, not between two
    corners = (corners - origin) / side  # cells are unit cubes
    edges = np.roll(corners, -1, axis=1) - corners
    crosses = np.cross(edges[:, :, None], np.eye(3)).reshape(-1, 9, 3)
    axes = np.concatenate((crosses, np.cross(edges[:, :1], edges[:, 1:2])), axis=1)  # (m, 10, 3)
    spread = np.einsum("mai,mvi->mva", axes, corners)  # (m, 3, 10)
    reach = 0.5 * np.abs(axes).sum(axis=2) + 1e-9
    low, high = spread.min(axis=1) - reach, spread.max(axis=1) + reach  # of a cell's center
    first = np.floor(corners.min(axis=1)).astype(np.int64)
    count = np.floor(corners.max(axis=1)).astype(np.int64) - first + 1
    filled = []
    for f in range(len(corners)):
        ijk = first[f] + np.indices(count[f]).reshape(3, -1).T
        center = (ijk + 0.5) @ axes[f].T
        filled.append(ijk[np.all((low[f] <= center) & (center <= high[f]), axis=1)])
    return side, origin, np.unique(np.concatenate(filled), axis=0)


BASELINES: dict[str, type[Aabb] | type[Obb] | type[Sphere] | type[Hull] | type[Grid]] = {
    "AABB": Aabb,
    "OBB": Obb,
    "sphere": Sphere,
    "hull": Hull,
    "grid": Grid,
}

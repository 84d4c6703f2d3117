"""What a picture is made of: solids, a floor, a light."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fgenv.arrays import Floats, Ints
from fgenv.collision import Shape
from fgenv.view.figures.normals import normal_maps
from fgenv.view.figures.palette import Color, to_linear

SMOOTH = 0.6  # rad: edges that bend less are shaded round


@dataclass(frozen=True)
class Solid:
    """A shape at a pose (4, 4) in an sRGB color; below opacity 1 a ghost without a shadow.

    Edges that bend less than `smooth` (rad) are shaded round.
    """

    shape: Shape
    pose: Floats
    color: Color
    opacity: float = 1.0
    smooth: float = SMOOTH

    def hits(self, origins: Floats, directions: Floats) -> tuple[Floats, Ints]:
        """First hits of rays: distances (n,), infinite for none, and faces (n,), -1 for none.

        Of origins (n, 3) and unit directions (n, 3) one may be (3,), the same for all rays.
        """
        offset = self._center - origins
        along = directions @ offset if origins.ndim == 1 else _dot(offset, directions)
        beside = _dot(offset, offset) - along**2
        near = np.flatnonzero((beside <= self._radius**2) & (along >= -self._radius))
        distances, faces = np.full(len(along), np.inf), np.full(len(along), -1)
        if len(near):
            starts = origins if origins.ndim == 1 else origins[near]
            ways = directions if directions.ndim == 1 else directions[near]
            distances[near], faces[near] = self.shape.raycast(starts, ways, self.pose)
        return distances, faces

    def normals(self, points: Floats, faces: Ints, rays: Floats) -> Floats:
        """Unit normals (n, 3) for shading at points (n, 3) of faces (n,), world frame, on the side
        that the rays (n, 3) come from."""
        local = (points - self.pose[:3, 3]) @ self.pose[:3, :3]
        maps = self._maps[faces]
        normals = np.einsum("nij,nj->ni", maps[:, :, :3], local) + maps[:, :, 3]
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        # The face itself says which side is seen: a round normal may lean over the rim.
        inside = _dot(self._flat[faces], rays @ self.pose[:3, :3]) > 0
        normals[inside] *= -1.0
        return np.asarray(normals @ self.pose[:3, :3].T)

    @cached_property
    def _flat(self) -> Floats:
        a, b, c = (self.shape.vertices[self.shape.faces[:, k]] for k in range(3))
        return np.cross(b - a, c - a)

    @cached_property
    def _maps(self) -> Floats:
        return normal_maps(self.shape.vertices, self.shape.faces, self.smooth)

    @cached_property
    def _center(self) -> Floats:
        return np.asarray(self.pose[:3, :3] @ self.shape.bounds.mean(axis=0) + self.pose[:3, 3])

    @cached_property
    def _radius(self) -> float:
        return float(np.linalg.norm(np.ptp(self.shape.bounds, axis=0))) / 2 * (1 + 1e-9) + 1e-9


@dataclass(frozen=True)
class Floor:
    """The ground plane z = `height` with a grid every `grid` meters, fading out with distance."""

    height: float = 0.0
    color: Color = (0.91, 0.91, 0.90)
    grid: float = 1.0
    fade: float = 40.0  # meters

    def hits(self, origin: Floats, directions: Floats) -> Floats:
        """Distances (n,) of the plane along rays (n, 3) from one origin, infinite for none."""
        down = directions[:, 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (self.height - origin[2]) / down
        return np.where((down != 0) & (t > 0), t, np.inf)

    def albedo(self, points: Floats, footprint: Floats) -> Floats:
        """Linear colors (n, 3) at points of the plane seen by pixels so many meters wide (n,)."""
        dark = 1.0 - 0.3 * np.maximum(*(self._line(points[:, k], footprint) for k in (0, 1)))
        return np.asarray(to_linear(self.color) * dark[:, None])

    def _line(self, across: Floats, footprint: Floats) -> Floats:
        """How much of each pixel a grid line covers (n,), by the coordinate across the lines."""
        half = 0.01 * self.grid  # of a line's width
        off = np.abs((across / self.grid + 0.5) % 1.0 - 0.5) * self.grid
        blur = np.maximum(half, footprint)
        return np.asarray(np.clip(0.5 + (half - off) / blur, 0.0, 1.0) * (half / blur))


@dataclass(frozen=True)
class Light:
    """A sun in the direction `to` (from the scene), its strength, and the sky around."""

    to: tuple[float, float, float] = (-0.35, -0.55, 0.75)
    sun: float = 0.66
    above: Color = (0.40, 0.43, 0.47)  # linear light of the sky
    below: Color = (0.24, 0.22, 0.20)  # linear light from the ground
    zenith: Color = (0.74, 0.82, 0.90)  # sRGB, as seen
    horizon: Color = (0.96, 0.97, 0.98)

    @property
    def direction(self) -> Floats:
        """The unit vector to the sun."""
        to = np.array(self.to, dtype=np.float64)
        return to / np.linalg.norm(to)


def _dot(a: Floats, b: Floats) -> Floats:
    """Dot products of vectors (..., 3), broadcast."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2])

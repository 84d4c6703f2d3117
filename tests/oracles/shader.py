"""Oracle of the painter: the same scene, rendered in NumPy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fgenv.arrays import Flags, Floats, Ints
from fgenv.view import Camera, Floor, Light, Solid
from fgenv.view.figures.normals import SMOOTH, normal_maps
from fgenv.view.figures.painter import CONTRAST, FADE
from fgenv.view.figures.palette import to_linear

BAND = 50_000  # rays at a time


def render(
    camera: Camera,
    solids: Sequence[Solid],
    *,
    floor: Floor | None = None,
    light: Light | None = None,
    samples: int = 1,
    shadows: bool = True,
) -> tuple[Floats, Floats]:
    """Return linear colors (h, w, 3) and depths (h, w), meters, infinite for the sky.

    With samples > 1 each pixel at an edge is the mean of `samples` squared rays.
    """
    if samples < 1:
        raise ValueError(f"samples: got {samples}, expected 1 or more")
    view = _View(camera, [_Traced(s) for s in solids], floor, light or Light(), shadows)
    middles = camera.pixel_middles()
    color, depth = view.trace(middles.reshape(-1, 2))
    color, depth = color.reshape(*middles.shape[:2], 3), depth.reshape(middles.shape[:2])
    if samples > 1:
        rough = _edges(color)
        spread = (np.arange(samples) + 0.5) / samples - 0.5
        offsets = np.stack(np.meshgrid(spread, spread), axis=-1).reshape(-1, 2)
        fine, _ = view.trace((middles[rough][:, None] + offsets).reshape(-1, 2))
        color[rough] = fine.reshape(-1, samples**2, 3).mean(axis=1)
    return color, depth


def _edges(color: Floats) -> Flags:
    """Pixels (h, w) with a color that differs from a neighbor's."""
    rough = np.zeros(color.shape[:2], dtype=bool)
    across = (np.abs(np.diff(color, axis=1)) > CONTRAST).any(axis=2)
    down = (np.abs(np.diff(color, axis=0)) > CONTRAST).any(axis=2)
    rough[:, 1:] |= across
    rough[:, :-1] |= across
    rough[1:] |= down
    rough[:-1] |= down
    return rough


@dataclass
class _Traced:
    """A solid for ray casts."""

    solid: Solid

    def hits(self, origins: Floats, directions: Floats) -> tuple[Floats, Ints]:
        """First hits of rays: distances (n,), infinite for none, and faces (n,), -1 for none.

        Of origins (n, 3) and unit directions (n, 3) one can be (3,), the same for all rays.
        """
        offset = self._center - origins
        along = directions @ offset if origins.ndim == 1 else _dot(offset, directions)
        beside = _dot(offset, offset) - along**2
        near = np.flatnonzero((beside <= self._radius**2) & (along >= -self._radius))
        distances, faces = np.full(len(along), np.inf), np.full(len(along), -1)
        if len(near):
            starts = origins if origins.ndim == 1 else origins[near]
            ways = directions if directions.ndim == 1 else directions[near]
            distances[near], faces[near] = self.solid.shape.raycast(starts, ways, self.solid.pose)
        return distances, faces

    def normals(self, points: Floats, faces: Ints, rays: Floats) -> Floats:
        """Unit normals (n, 3) at points (n, 3) of faces (n,), on the side that the rays come from.

        All arrays are in the world frame.
        """
        pose = self.solid.pose
        local = (points - pose[:3, 3]) @ pose[:3, :3]
        maps = self._maps[faces]
        normals = np.einsum("nij,nj->ni", maps[:, :, :3], local) + maps[:, :, 3]
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        # The face decides which side is seen: a smooth normal can lean over the rim.
        inside = _dot(self._flat[faces], rays @ pose[:3, :3]) > 0
        normals[inside] *= -1.0
        return np.asarray(normals @ pose[:3, :3].T)

    @cached_property
    def _flat(self) -> Floats:
        shape = self.solid.shape
        a, b, c = (shape.vertices[shape.faces[:, k]] for k in range(3))
        return np.cross(b - a, c - a)

    @cached_property
    def _maps(self) -> Floats:
        return normal_maps(self.solid.shape.vertices, self.solid.shape.faces, SMOOTH)

    @cached_property
    def _center(self) -> Floats:
        pose = self.solid.pose
        return np.asarray(pose[:3, :3] @ self.solid.shape.bounds.mean(axis=0) + pose[:3, 3])

    @cached_property
    def _radius(self) -> float:
        size = np.ptp(self.solid.shape.bounds, axis=0)
        return float(np.linalg.norm(size)) / 2 * (1 + 1e-9) + 1e-9


@dataclass
class _View:
    camera: Camera
    traced: list[_Traced]
    floor: Floor | None
    light: Light
    shadows: bool

    def trace(self, pixels: Floats) -> tuple[Floats, Floats]:
        """Colors (n, 3) and depths (n,) at pixels (n, 2)."""
        bands = np.array_split(pixels, max(1, len(pixels) // BAND))
        seen = [self._band(self.camera.rays(band)) for band in bands]
        return np.concatenate([c for c, _ in seen]), np.concatenate([d for _, d in seen])

    def _band(self, rays: Floats) -> tuple[Floats, Floats]:
        eye = np.array(self.camera.eye, dtype=np.float64)
        color, nearest = self._sky(rays), np.full(len(rays), np.inf)
        owner, face = np.full(len(rays), -1), np.full(len(rays), -1)
        translucent = []
        for index, traced in enumerate(self.traced):
            distance, faces = traced.hits(eye, rays)
            if traced.solid.opacity < 1.0:
                translucent.append((traced, distance, faces))
                continue
            near = distance < nearest
            nearest[near], face[near], owner[near] = distance[near], faces[near], index
        if self.floor is not None:
            self._paint_floor(self.floor, rays, nearest, owner, color)
        for index, traced in enumerate(self.traced):
            seen = np.flatnonzero(owner == index)
            self._paint(traced, rays[seen], nearest[seen], face[seen], color, seen)
        for traced, distance, faces in sorted(translucent, key=lambda t: -float(np.min(t[1]))):
            seen = np.flatnonzero(distance < nearest)
            self._paint(traced, rays[seen], distance[seen], faces[seen], color, seen)
        return color, nearest * (rays @ self.camera.axes[2])

    def _paint(
        self, traced: _Traced, rays: Floats, distance: Floats, face: Ints, color: Floats, seen: Ints
    ) -> None:
        """Blend a solid's color over that of the rays seen (n,), of all (m, 3)."""
        if len(seen) == 0:
            return
        solid, points = traced.solid, self.camera.eye + rays * distance[:, None]
        normals = traced.normals(points, face, rays)
        shade = to_linear(solid.color) * self._lit(points, normals, solid.opacity == 1.0)
        color[seen] += solid.opacity * (shade - color[seen])

    def _paint_floor(
        self, floor: Floor, rays: Floats, nearest: Floats, owner: Ints, color: Floats
    ) -> None:
        """Paint the floor where it is nearest, and update `nearest` and `owner`."""
        fade = FADE if floor.fade is None else floor.fade
        distance = _floor_hits(floor, np.array(self.camera.eye), rays)
        seen = np.flatnonzero(distance < np.minimum(nearest, 4.0 * fade))
        far, slant = distance[seen], np.abs(rays[seen, 2])
        points = self.camera.eye + rays[seen] * far[:, None]
        up = np.zeros_like(points)
        up[:, 2] = np.sign(self.camera.eye[2] - floor.height)
        albedo = _albedo(floor, points, far / slant / self.camera.pixels_per_slope)
        shade, solid = albedo * self._lit(points, up, True), np.exp(-((far / fade) ** 2))
        color[seen] += solid[:, None] * (shade - color[seen])
        nearest[seen], owner[seen] = far, -1

    def _lit(self, points: Floats, normals: Floats, shadows: bool) -> Floats:
        """Light (n, 3) on surface points: the sky by their slope, and the sun outside shadows."""
        sunny = np.maximum(normals @ self.light.direction, 0.0)
        if self.shadows and shadows:
            facing = np.flatnonzero(sunny > 0)
            sunny[facing[self._shaded(points[facing], normals[facing])]] = 0.0
        up = 0.5 + 0.5 * normals[:, 2:3]
        ambient = up * np.array(self.light.above) + (1 - up) * np.array(self.light.below)
        return np.asarray(ambient + self.light.sun * sunny[:, None])

    def _shaded(self, points: Floats, normals: Floats) -> Flags:
        """Points (n, 3) that a solid hides from the sun."""
        # Off the surface by more than the rounding error, by less than a visible distance.
        origins = points + normals * (1e-4 * (1.0 + np.abs(points).max(initial=0.0)))
        dark = np.zeros(len(points), dtype=bool)
        for traced in self.traced:
            if traced.solid.opacity == 1.0:
                left = np.flatnonzero(~dark)
                dark[left] = np.isfinite(traced.hits(origins[left], self.light.direction)[0])
        return dark

    def _sky(self, rays: Floats) -> Floats:
        top, bottom = to_linear(self.light.zenith), to_linear(self.light.horizon)
        height = np.clip(rays[:, 2:3], 0.0, 1.0) ** 0.6
        return np.asarray(bottom + height * (top - bottom))


def _floor_hits(floor: Floor, origin: Floats, directions: Floats) -> Floats:
    """Distances (n,) of the floor along rays (n, 3) from one origin, infinite for none."""
    down = directions[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (floor.height - origin[2]) / down
    return np.where((down != 0) & (t > 0), t, np.inf)


def _albedo(floor: Floor, points: Floats, footprint: Floats) -> Floats:
    """Linear colors (n, 3) at points of the floor that pixels of a width (n,) in meters see."""
    dark = 1.0 - 0.3 * np.maximum(*(_line(floor.grid, points[:, k], footprint) for k in (0, 1)))
    return np.asarray(to_linear(floor.color) * dark[:, None])


def _line(grid: float, across: Floats, footprint: Floats) -> Floats:
    """Share of each pixel that a grid line covers (n,), by the coordinate across the lines."""
    half = 0.01 * grid  # of a line's width
    off = np.abs((across / grid + 0.5) % 1.0 - 0.5) * grid
    blur = np.maximum(half, footprint)
    return np.asarray(np.clip(0.5 + (half - off) / blur, 0.0, 1.0) * (half / blur))


def _dot(a: Floats, b: Floats) -> Floats:
    """Dot products of vectors (..., 3), broadcast."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2])

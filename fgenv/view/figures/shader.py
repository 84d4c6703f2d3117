"""One small shader over `Shape.raycast`: no OpenGL, no window, the same picture everywhere."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats, Ints
from fgenv.view.figures.camera import Camera
from fgenv.view.figures.palette import to_linear
from fgenv.view.figures.surfaces import Floor, Light, Solid

CONTRAST = 0.02  # of linear color between neighbors: more is an edge, and sampled again
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
    """Linear colors (h, w, 3) and depths ahead (h, w), meters, infinite for the sky.

    Solids are Lambert surfaces under a sun with hard shadows and a sky. With samples > 1 each
    pixel at an edge is the mean of that many samples squared.
    """
    if samples < 1:
        raise ValueError(f"samples: got {samples}, want 1 or more")
    view = _View(camera, list(solids), floor, light or Light(), shadows)
    middles = camera.pixel_middles()
    color, depth = view.look(middles.reshape(-1, 2))
    color, depth = color.reshape(*middles.shape[:2], 3), depth.reshape(middles.shape[:2])
    if samples > 1:
        rough = _edges(color)
        spread = (np.arange(samples) + 0.5) / samples - 0.5
        offsets = np.stack(np.meshgrid(spread, spread), axis=-1).reshape(-1, 2)
        fine, _ = view.look((middles[rough][:, None] + offsets).reshape(-1, 2))
        color[rough] = fine.reshape(-1, samples**2, 3).mean(axis=1)
    return color, depth


def _edges(color: Floats) -> NDArray[np.bool_]:
    """Pixels (h, w) that differ from a neighbor."""
    rough = np.zeros(color.shape[:2], dtype=bool)
    across = (np.abs(np.diff(color, axis=1)) > CONTRAST).any(axis=2)
    down = (np.abs(np.diff(color, axis=0)) > CONTRAST).any(axis=2)
    rough[:, 1:] |= across
    rough[:, :-1] |= across
    rough[1:] |= down
    rough[:-1] |= down
    return rough


@dataclass
class _View:
    camera: Camera
    solids: list[Solid]
    floor: Floor | None
    light: Light
    shadows: bool

    def look(self, pixels: Floats) -> tuple[Floats, Floats]:
        """Colors (n, 3) and depths ahead (n,) at pixels (n, 2)."""
        bands = np.array_split(pixels, max(1, len(pixels) // BAND))
        seen = [self._band(self.camera.rays(band)) for band in bands]
        return np.concatenate([c for c, _ in seen]), np.concatenate([d for _, d in seen])

    def _band(self, rays: Floats) -> tuple[Floats, Floats]:
        eye = np.array(self.camera.eye, dtype=np.float64)
        color, nearest = self._sky(rays), np.full(len(rays), np.inf)
        owner, face = np.full(len(rays), -1), np.full(len(rays), -1)
        ghosts = []
        for index, solid in enumerate(self.solids):
            distance, faces = solid.hits(eye, rays)
            if solid.opacity < 1.0:
                ghosts.append((solid, distance, faces))
                continue
            near = distance < nearest
            nearest[near], face[near], owner[near] = distance[near], faces[near], index
        if self.floor is not None:
            self._paint_floor(self.floor, rays, nearest, owner, color)
        for index, solid in enumerate(self.solids):
            seen = np.flatnonzero(owner == index)
            self._paint(solid, rays[seen], nearest[seen], face[seen], color, seen)
        for solid, distance, faces in sorted(ghosts, key=lambda g: -float(np.min(g[1]))):
            seen = np.flatnonzero(distance < nearest)
            self._paint(solid, rays[seen], distance[seen], faces[seen], color, seen)
        return color, nearest * (rays @ self.camera.axes[2])

    def _paint(
        self, solid: Solid, rays: Floats, distance: Floats, face: Ints, color: Floats, seen: Ints
    ) -> None:
        """Lay a solid's color over that of the rays seen (n,), of all (m, 3)."""
        if len(seen) == 0:
            return
        points = self.camera.eye + rays * distance[:, None]
        normals = solid.normals(points, face, rays)
        shade = to_linear(solid.color) * self._lit(points, normals, solid.opacity == 1.0)
        color[seen] += solid.opacity * (shade - color[seen])

    def _paint_floor(
        self, floor: Floor, rays: Floats, nearest: Floats, owner: Ints, color: Floats
    ) -> None:
        """Paint the floor where it is nearest, and say so in `nearest` and `owner`."""
        distance = floor.hits(np.array(self.camera.eye), rays)
        seen = np.flatnonzero(distance < np.minimum(nearest, 4.0 * floor.fade))
        far, slant = distance[seen], np.abs(rays[seen, 2])
        points = self.camera.eye + rays[seen] * far[:, None]
        up = np.zeros_like(points)
        up[:, 2] = np.sign(self.camera.eye[2] - floor.height)
        albedo = floor.albedo(points, far / slant / self.camera.pixels_per_slope)
        shade, solid = albedo * self._lit(points, up, True), np.exp(-((far / floor.fade) ** 2))
        color[seen] += solid[:, None] * (shade - color[seen])
        nearest[seen], owner[seen] = far, -1

    def _lit(self, points: Floats, normals: Floats, shadows: bool) -> Floats:
        """Light (n, 3) on surface points: the sky by their slope, the sun where it gets to."""
        sunny = np.maximum(normals @ self.light.direction, 0.0)
        if self.shadows and shadows:
            facing = np.flatnonzero(sunny > 0)
            sunny[facing[self._shaded(points[facing], normals[facing])]] = 0.0
        up = 0.5 + 0.5 * normals[:, 2:3]
        ambient = up * np.array(self.light.above) + (1 - up) * np.array(self.light.below)
        return np.asarray(ambient + self.light.sun * sunny[:, None])

    def _shaded(self, points: Floats, normals: Floats) -> NDArray[np.bool_]:
        """Which points (n, 3) some solid hides from the sun."""
        # Off the surface by more than rounding, by less than anyone sees.
        origins = points + normals * (1e-4 * (1.0 + np.abs(points).max(initial=0.0)))
        dark = np.zeros(len(points), dtype=bool)
        for solid in self.solids:
            if solid.opacity == 1.0:
                left = np.flatnonzero(~dark)
                dark[left] = np.isfinite(solid.hits(origins[left], self.light.direction)[0])
        return dark

    def _sky(self, rays: Floats) -> Floats:
        top, bottom = to_linear(self.light.zenith), to_linear(self.light.horizon)
        height = np.clip(rays[:, 2:3], 0.0, 1.0) ** 0.6
        return np.asarray(bottom + height * (top - bottom))

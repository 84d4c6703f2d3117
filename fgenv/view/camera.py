"""A pinhole camera: rays for its pixels, and pixels for points."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Point = tuple[float, float, float]


@dataclass(frozen=True)
class Camera:
    """Looks from `eye` at `target` (m, z up), `fov` is the vertical field of view (rad)."""

    eye: Point
    target: Point
    fov: float = 0.7
    width: int = 640
    height: int = 480

    def __post_init__(self) -> None:
        ahead = np.subtract(self.target, self.eye)
        if not np.isfinite(ahead).all() or np.hypot(ahead[0], ahead[1]) < 1e-9 * (
            1.0 + np.abs(self.eye).max()
        ):
            raise ValueError(
                f"target: {self.target} is straight above, below or at the eye {self.eye}; "
                "move it aside a little"
            )
        if not 0.0 < self.fov < np.pi or self.width < 1 or self.height < 1:
            raise ValueError(
                f"fov: got {self.fov}, want between 0 and pi; width, height: got "
                f"{self.width}, {self.height}, want 1 or more"
            )

    @cached_property
    def axes(self) -> Floats:
        """Unit vectors (3, 3) in rows: right, down, ahead."""
        ahead = np.subtract(self.target, self.eye, dtype=np.float64)
        ahead /= np.linalg.norm(ahead)
        right = np.cross(ahead, (0.0, 0.0, 1.0))
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(ahead, right), ahead])

    @property
    def pixels_per_slope(self) -> float:
        """Pixels that one metre takes up at one metre ahead."""
        return self.height / 2 / float(np.tan(self.fov / 2))

    def rays(self, pixels: ArrayLike) -> Floats:
        """Unit directions (..., 3) through pixels (..., 2), in the manner of `project`: the
        middle of the pixel in the top left corner is (0.5, 0.5)."""
        slopes = (np.asarray(pixels, dtype=np.float64) - self._middle) / self.pixels_per_slope
        right, down, ahead = self.axes
        rays = slopes[..., :1] * right + slopes[..., 1:] * down + ahead
        return np.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True))

    def pixel_middles(self) -> Floats:
        """The middle of each pixel, (height, width, 2), rows from the top."""
        columns, rows = np.meshgrid(np.arange(self.width), np.arange(self.height))
        return np.asarray(np.stack([columns, rows], axis=-1) + 0.5, dtype=np.float64)

    def project(self, points: ArrayLike) -> tuple[Floats, Floats]:
        """Pixels (..., 2) from the top left corner, and depths ahead (...,) in metres, of points
        (..., 3). A point behind the eye has a depth below 0 and no meaningful pixel."""
        local = (np.asarray(points, dtype=np.float64) - self.eye) @ self.axes.T
        depth: Floats = np.asarray(local[..., 2], dtype=np.float64)
        safe = np.where(np.abs(depth) > 1e-12, depth, 1e-12)[..., None]
        return self._middle + local[..., :2] / safe * self.pixels_per_slope, depth

    @property
    def _middle(self) -> Floats:
        return np.array([self.width / 2, self.height / 2])

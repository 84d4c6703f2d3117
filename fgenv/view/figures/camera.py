"""A pinhole camera: rays through pixels, and pixels of points."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats

Point = tuple[float, float, float]
AZIMUTH, ELEVATION, FOV = -1.2, 0.8, 0.5  # rad: direction and field of view of an overview
BORDER = 0.03  # of the height: margin of an overview


@dataclass(frozen=True)
class Camera:
    """A camera at `eye` that looks at `target` (m, z up); `fov`: vertical field of view (rad)."""

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
                f"target: got {self.target}, straight above, below or at the eye {self.eye}, "
                "expected a point beside that line; move it aside"
            )
        if not 0.0 < self.fov < np.pi or self.width < 1 or self.height < 1:
            raise ValueError(
                f"fov: got {self.fov}, expected between 0 and pi; width, height: got "
                f"{self.width}, {self.height}, expected 1 or more"
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
        """Width in pixels of one meter at one meter ahead."""
        return self.height / 2 / float(np.tan(self.fov / 2))

    def rays(self, pixels: ArrayLike) -> Floats:
        """Return unit directions (..., 3) through pixels (..., 2).

        The middle of the pixel in the top left corner is (0.5, 0.5).
        """
        slopes = (np.asarray(pixels, dtype=np.float64) - self._middle) / self.pixels_per_slope
        right, down, ahead = self.axes
        rays = slopes[..., :1] * right + slopes[..., 1:] * down + ahead
        return np.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True))

    def pixel_middles(self) -> Floats:
        """Return the middle of each pixel, (height, width, 2), rows from the top."""
        columns, rows = np.meshgrid(np.arange(self.width), np.arange(self.height))
        return np.asarray(np.stack([columns, rows], axis=-1) + 0.5, dtype=np.float64)

    def project(self, points: ArrayLike) -> tuple[Floats, Floats]:
        """Return pixels (..., 2) and depths ahead (...,), in meters, of points (..., 3).

        Pixels count from the top left corner. A point behind the eye has a negative depth, and
        its pixel has no meaning.
        """
        local = (np.asarray(points, dtype=np.float64) - self.eye) @ self.axes.T
        depth: Floats = np.asarray(local[..., 2], dtype=np.float64)
        safe = np.where(np.abs(depth) > 1e-12, depth, 1e-12)[..., None]
        return self._middle + local[..., :2] / safe * self.pixels_per_slope, depth

    @property
    def _middle(self) -> Floats:
        return np.array([self.width / 2, self.height / 2])


def box_corners(low: ArrayLike, high: ArrayLike) -> Floats:
    """Return the corners (..., 8, 3) of boxes from `low` to `high` (..., 3)."""
    low, high = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    ends = np.stack(np.meshgrid(*[(0.0, 1.0)] * 3, indexing="ij"), axis=-1).reshape(8, 3)
    return np.asarray(low[..., None, :] + ends * (high - low)[..., None, :])


def direction(azimuth: float, elevation: float) -> Floats:
    """Return the unit vector (3,) at an azimuth about z and an elevation over the floor (rad)."""
    flat = np.cos(elevation)
    return np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])


def look_at(
    target: Floats,
    distance: float,
    azimuth: float,
    elevation: float,
    fov: float,
    width: int,
    height: int,
) -> Camera:
    """Return a camera at a distance (m) from a target (3,), seen at `azimuth`, `elevation`."""
    x, y, z = (target + distance * direction(azimuth, elevation)).tolist()
    tx, ty, tz = target.tolist()
    return Camera((x, y, z), (tx, ty, tz), fov, width, height)


def overview(
    corners: Floats,
    width: int,
    height: int,
    azimuth: float = AZIMUTH,
    elevation: float = ELEVATION,
) -> Camera:
    """Return the nearest camera from above that sees all corners (n, 3)."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, span = (low + high) / 2, float(np.linalg.norm(high - low))
    frame, border = np.array([width, height]), BORDER * height
    for distance in span * np.linspace(0.8, 4.0, 65):
        for drop in np.linspace(-0.1, 0.1, 9) * span:  # near bodies look larger
            target = middle + (0.0, 0.0, drop)
            camera = look_at(target, distance, azimuth, elevation, FOV, width, height)
            pixels, depth = camera.project(corners)
            if (depth > 0).all() and ((pixels > border) & (pixels < frame - border)).all():
                return camera
    return camera

"""Planar paths (n, 3) of x, y (m) and yaw (rad), refined and timed at a constant speed."""

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats


def as_path(path: ArrayLike) -> Floats:
    """A path (n, 3) with a continuous yaw, n >= 2.

    Between two configurations x, y and yaw are linear; yaw takes the shorter direction, as in
    OMPL's SE2.

    Raises:
        ValueError: another shape, fewer than two configurations, NaN or infinity.
    """
    q = np.array(path, dtype=np.float64)
    if q.ndim != 2 or q.shape[1] != 3 or len(q) < 2:
        raise ValueError(f"path: got shape {q.shape}, expected (n, 3) with n >= 2: x, y, yaw")
    if not np.isfinite(q).all():
        raise ValueError("path: got NaN or infinity, expected finite x, y, yaw")
    q[:, 2] = np.unwrap(q[:, 2])
    return q


def radius_of(vertices: Floats) -> float:
    """Meters from a body's z axis to its farthest vertex."""
    return float(np.hypot(vertices[:, 0], vertices[:, 1]).max())


def travel(path: Floats, radius: float) -> Floats:
    """Upper bound (n - 1,) in meters of the motion of a body's points on each leg of a path (n, 3).

    The points lie within `radius` meters of the body's z axis.
    """
    step = np.diff(path, axis=0)
    return np.asarray(np.hypot(step[:, 0], step[:, 1]) + radius * np.abs(step[:, 2]))


def refine(path: Floats, radius: float, step: float) -> Floats:
    """The path (k, 3) with legs on which no point of the body moves more than `step` meters."""
    pieces = np.maximum(1, np.ceil(travel(path, radius) / step)).astype(np.int64)
    legs = zip(path[:-1], path[1:], pieces, strict=True)
    return np.concatenate([*(np.linspace(a, b, n, endpoint=False) for a, b, n in legs), path[-1:]])


class TimedPath:
    """A path (n, 3) at a constant speed of a holonomic body.

    The speed (m/s) bounds all points within `radius` meters of the body's z axis: it is the speed
    of the origin plus `radius` times the yaw rate.
    """

    def __init__(self, path: ArrayLike, *, speed: float, radius: float) -> None:
        if not speed > 0:
            raise ValueError(f"speed: got {speed}, expected m/s above 0")
        if not radius >= 0:
            raise ValueError(f"radius: got {radius}, expected meters, 0 or more")
        self.path = as_path(path)
        self.speed = speed
        self.times: Floats = np.concatenate([[0.0], np.cumsum(travel(self.path, radius)) / speed])

    @property
    def duration(self) -> float:
        """Seconds from the path's start to its end."""
        return float(self.times[-1])

    def at(self, times: ArrayLike) -> Floats:
        """Configurations (..., 3) at times (...,) in seconds; the path's ends outside of it."""
        t = np.asarray(times, dtype=np.float64)
        return np.stack([np.interp(t, self.times, self.path[:, k]) for k in range(3)], axis=-1)

    def ticks(self, step: float) -> Floats:
        """Times (k,) from start to end at which the path is checked, its corners included.

        Between two of them no point of the body moves more than `step` meters.
        """
        count = max(1, int(np.ceil(self.duration * self.speed / step - 1e-9)))
        return np.union1d(np.linspace(0.0, self.duration, count + 1), self.times)

    def until(self, time: float) -> Floats:
        """The part of the path before a time, (k, 3) with k >= 2."""
        passed = self.path[: max(1, int(np.searchsorted(self.times, time)))]
        return np.concatenate([passed, self.at([time])])

"""Following a path: configurations along a polyline, timed at a constant speed."""

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats
from fgenv.scenarios.se2 import as_path, travel


class PathFollower:
    """Drives a body that can move and turn any way (holonomic) along a path (n, 3).

    The speed (m/s) is that of the path plus `radius` meters times the turn, so that no point
    within `radius` of the body's z axis is ever faster.
    """

    def __init__(self, path: ArrayLike, *, speed: float, radius: float) -> None:
        if not (speed > 0 and radius >= 0):
            raise ValueError(f"speed: got {speed}, want > 0; radius: got {radius}, want >= 0")
        self.path = as_path(path)
        self.speed = speed
        self.times: Floats = np.concatenate([[0.0], np.cumsum(travel(self.path, radius)) / speed])

    @property
    def duration(self) -> float:
        """Seconds from the path's start to its end."""
        return float(self.times[-1])

    def at(self, times: ArrayLike) -> Floats:
        """Configurations (..., 3) at times (...,) in seconds; before 0 the start, then the end."""
        t = np.asarray(times, dtype=np.float64)
        return np.stack([np.interp(t, self.times, self.path[:, k]) for k in range(3)], axis=-1)

    def ticks(self, step: float) -> Floats:
        """Times (k,) from 0 to the end, corners among them; between two of them no point moves
        more than `step` meters, and all on one leg."""
        count = max(1, int(np.ceil(self.duration * self.speed / step - 1e-9)))
        return np.union1d(np.linspace(0.0, self.duration, count + 1), self.times)

    def until(self, time: float) -> Floats:
        """The path driven up to a time, (k, 3) with k >= 2."""
        passed = self.path[: max(1, int(np.searchsorted(self.times, time)))]
        return np.concatenate([passed, self.at([time])])

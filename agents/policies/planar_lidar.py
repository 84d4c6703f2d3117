"""Lidar measurements as points in the plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats, Floats32
from fgenv.envs import View

LEVEL = 1e-6  # of a ray's vertical component; steeper rays are not used


@dataclass(frozen=True)
class PlanarLidar:
    """The horizontal rays of a robot's lidar, and their place in its observation.

    Attributes:
        part: slice of the observation.
        level: mask of the horizontal rays, (all rays,) bool.
        origin: of the rays in the base's frame, (3,), m.
        rays: unit vectors of the horizontal rays, (rays, 3).
        range: m.
    """

    part: slice
    level: Flags
    origin: Floats
    rays: Floats
    range: float

    @classmethod
    def of(cls, view: View, robot: int) -> PlanarLidar:
        """Return the lidar of a robot; it has no rays if the robot observes none."""
        part = next((part.slice for part in view.layouts[robot] if part.name == "lidar"), slice(0))
        origin, rays, reach = view.rays(robot)
        level = np.abs(rays[:, 2]) <= LEVEL
        return cls(part, level, origin, rays[level], reach)

    def points(self, q: Floats, rows: Floats32) -> Floats:
        """Return the end points of rays, (n, rays, 2), m; NaN for rays without a hit.

        Args:
            q: configurations of the robot, (n, nq).
            rows: its observations, (n, size).
        """
        depth = rows[:, self.part].astype(np.float64)[:, self.level]
        sine, cosine = (side[:, None] for side in _core.sin_cos(q[:, 2]))
        x, y = (self.origin[k] + depth * self.rays[:, k] for k in (0, 1))
        points = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1) + q[:, None, :2]
        points[depth >= self.range * (1 - LEVEL)] = np.nan
        return points

"""What robots see by their lidars, as points of the world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats, Floats32
from fgenv.envs import View

LEVEL = 1e-6  # of a ray's direction: those that rise or fall see no walls


@dataclass(frozen=True)
class Lidar:
    """What a robot's flat rays are, and where they are in its row of observations.

    Attributes:
        part: of the row.
        level: which of its rays neither rise nor fall, (all rays,) bool.
        at: where they begin, (3,), base's frame, meters.
        rays: unit vectors of those that are level, (rays, 3).
        range: meters.
    """

    part: slice
    level: Flags
    at: Floats
    rays: Floats
    range: float

    @classmethod
    def of(cls, view: View, robot: int) -> Lidar:
        """A robot's; one with no rays where it observes none."""
        part = next((part.slice for part in view.layouts[robot] if part.name == "lidar"), slice(0))
        at, rays, reach = view.rays(robot)
        level = np.abs(rays[:, 2]) <= LEVEL
        return cls(part, level, at, rays[level], reach)

    def points(self, q: Floats, rows: Floats32) -> Floats:
        """Where rays end from configurations (n, nq) with rows of observations, (n, rays, 2).

        NaN where a ray ends nowhere.
        """
        far = rows[:, self.part].astype(np.float64)[:, self.level]
        sine, cosine = (side[:, None] for side in _core.sin_cos(q[:, 2]))
        x, y = (self.at[k] + far * self.rays[:, k] for k in (0, 1))
        found = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1) + q[:, None, :2]
        found[far >= self.range * (1 - LEVEL)] = np.nan
        return found

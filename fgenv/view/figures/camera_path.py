"""Cameras for episodes: still, from above, after a robot, or around everything."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots.limits import reaches
from fgenv.scenarios import Built
from fgenv.view.figures.camera import AZIMUTH, ELEVATION, FOV, Camera, direction, overview

CAMERAS = ("overview", "top", "follow", "orbit")
UPRIGHT = np.pi / 2 - 1e-3  # rad: straight down would leave open which way is up
SOUTH = -np.pi / 2
HIGH, REACHES, LEAST = 1.0, 15.0, 2.0  # of who follows: elevation, reaches away, meters at least
TURN = 12.0  # seconds around everything


class Tripod:
    """A camera of a kind, for each moment.

    Args:
        corners: (n, 3), meters, of what is to be seen.
        robot: which one is followed.
        azimuth, elevation: rad, of where an overview is from; else its own.
    """

    def __init__(
        self,
        kind: str,
        built: Built,
        corners: Floats,
        width: int,
        height: int,
        robot: int = 0,
        azimuth: float | None = None,
        elevation: float | None = None,
    ) -> None:
        if kind not in CAMERAS:
            raise ValueError(f"camera: got {kind!r}, expected {', '.join(CAMERAS)}")
        if kind != "overview" and (azimuth, elevation) != (None, None):
            raise ValueError(f"azimuth, elevation: of the camera overview, got {kind!r}")
        if elevation is not None and not 0.0 < elevation <= UPRIGHT:
            raise ValueError(f"elevation: got {elevation}, expected over 0, to {UPRIGHT:.4f} rad")
        self.kind, self.robot, self._model = kind, robot, built.robots[robot]
        size = width, height
        look = AZIMUTH if azimuth is None else azimuth
        self._still = overview(corners, *size, look, ELEVATION if elevation is None else elevation)
        if kind == "top":
            self._still = overview(corners, *size, SOUTH, UPRIGHT)
        if kind == "orbit":
            every = [overview(corners, *size, a) for a in np.linspace(0, 2 * np.pi, 12)]
            self._far = max(float(np.linalg.norm(np.subtract(c.eye, c.target))) for c in every)
            self._middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        if kind == "follow":
            self._far = max(LEAST, REACHES * reaches(self._model)[self._model.root])

    def at(self, seconds: float, q: Floats) -> Camera:
        """The camera then; `q` is the followed robot's configuration, (nq,) or longer."""
        if self.kind == "orbit":
            angle = SOUTH + 2 * np.pi * seconds / TURN
            return self._from(self._middle, direction(angle, 0.7))
        if self.kind == "follow":
            place = self._model.forward(q[: self._model.nq], self._model.root)[:3, 3]
            return self._from(place, direction(SOUTH + 0.4, HIGH))
        return self._still

    def _from(self, target: Floats, way: Floats) -> Camera:
        x, y, z = target.tolist()
        a, b, c = (target + self._far * way).tolist()
        return replace(self._still, eye=(a, b, c), target=(x, y, z), fov=FOV)

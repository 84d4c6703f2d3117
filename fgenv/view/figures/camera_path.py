"""Cameras over the time of an episode: still, from above, following a robot, or orbiting."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fgenv.arrays import Floats
from fgenv.scenarios import Built
from fgenv.view.figures.camera import AZIMUTH, ELEVATION, FOV, Camera, direction, overview
from fgenv.view.robot_poses import base_position

CAMERAS = ("overview", "top", "follow", "orbit")
MAX_ELEVATION = np.pi / 2 - 1e-3  # rad; straight down leaves the up direction undefined
SOUTH = -np.pi / 2
# Camera that follows: direction (rad), distance per reach of the robot, minimum distance (m)
FOLLOW_AZIMUTH, FOLLOW_ELEVATION, REACHES, MIN_DISTANCE = SOUTH + 0.4, 1.0, 15.0, 2.0
ORBIT_ELEVATION, ORBIT_PERIOD = 0.7, 12.0  # rad, seconds


class CameraPath:
    """A camera of a kind, as a function of time.

    Args:
        kind: one of `CAMERAS`.
        corners: (n, 3), meters, of the region to show.
        robot: the robot that `follow` follows.
        azimuth, elevation: rad, direction of an `overview`; its defaults if left out.
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
        _check(kind, azimuth, elevation)
        self.kind, self.robot, self._model = kind, robot, built.robots[robot]
        look = (
            AZIMUTH if azimuth is None else azimuth,
            ELEVATION if elevation is None else elevation,
        )
        if kind == "top":
            look = SOUTH, MAX_ELEVATION
        self._still = overview(corners, width, height, *look)
        if kind == "orbit":
            around = [overview(corners, width, height, a) for a in np.linspace(0, 2 * np.pi, 12)]
            self._distance = max(
                float(np.linalg.norm(np.subtract(c.eye, c.target))) for c in around
            )
            self._center = (corners.min(axis=0) + corners.max(axis=0)) / 2
        if kind == "follow":
            self._distance = max(MIN_DISTANCE, REACHES * self._model.reach[self._model.root])

    def at(self, seconds: float, q: Floats) -> Camera:
        """Return the camera at a time; `q`: configuration of the followed robot."""
        if self.kind == "orbit":
            angle = SOUTH + 2 * np.pi * seconds / ORBIT_PERIOD
            return self._look_at(self._center, direction(angle, ORBIT_ELEVATION))
        if self.kind == "follow":
            base = base_position(self._model, q)
            return self._look_at(base, direction(FOLLOW_AZIMUTH, FOLLOW_ELEVATION))
        return self._still

    def _look_at(self, target: Floats, toward: Floats) -> Camera:
        x, y, z = target.tolist()
        a, b, c = (target + self._distance * toward).tolist()
        return replace(self._still, eye=(a, b, c), target=(x, y, z), fov=FOV)


def _check(kind: str, azimuth: float | None, elevation: float | None) -> None:
    if kind not in CAMERAS:
        raise ValueError(f"camera: got {kind!r}, expected {', '.join(CAMERAS)}")
    if kind != "overview" and (azimuth, elevation) != (None, None):
        raise ValueError(f"azimuth, elevation: got camera {kind!r}, expected camera 'overview'")
    if elevation is not None and not 0.0 < elevation <= MAX_ELEVATION:
        expected = f"over 0, at most {MAX_ELEVATION:.4f} rad"
        raise ValueError(f"elevation: got {elevation}, expected {expected}")

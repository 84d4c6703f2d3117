"""Lines and dots in a viser scene that are drawn anew again and again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats
from fgenv.view.figures.palette import Color

from .meshes import line_rgb, rgb

if TYPE_CHECKING:
    from viser import LineSegmentsHandle, PointCloudHandle, SceneApi


class Lines:
    """Segments, so many pixels wide."""

    def __init__(self, scene: SceneApi, name: str, width: float) -> None:
        self._scene, self._name, self._width = scene, name, width
        self._handle: LineSegmentsHandle | None = None

    def draw(self, ends: Floats, colors: Sequence[Color]) -> None:
        """In place of what was there: segments (n, 2, 3), a color each."""
        if not len(ends):
            self.wipe()
            return
        inks = np.repeat(line_rgb(colors)[:, None], 2, axis=1)
        points = np.asarray(ends, dtype=np.float32)
        if self._handle is None:
            self._handle = self._scene.add_line_segments(
                self._name, points, inks, thickness=self._width, thickness_units="screen"
            )
            return
        self._handle.points = points
        self._handle.colors = inks

    def wipe(self) -> None:
        """Nothing is there."""
        if self._handle is not None:
            self._handle.remove()
        self._handle = None


class Dots:
    """Points, `size` meters wide."""

    def __init__(self, scene: SceneApi, name: str, size: float) -> None:
        self._scene, self._name, self._size = scene, name, size
        self._handle: PointCloudHandle | None = None

    def draw(self, points: Floats, colors: Sequence[Color]) -> None:
        """In place of what was there: points (n, 3), a color each."""
        if not len(points):
            self.wipe()
            return
        inks = np.array([rgb(color) for color in colors], dtype=np.uint8)
        places = np.asarray(points, dtype=np.float32)
        if self._handle is None:
            self._handle = self._scene.add_point_cloud(
                self._name, places, inks, point_size=self._size, point_shape="circle"
            )
            return
        self._handle.points = places
        self._handle.colors = inks

    def wipe(self) -> None:
        """Nothing is there."""
        if self._handle is not None:
            self._handle.remove()
        self._handle = None

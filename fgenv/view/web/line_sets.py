"""Lines and points in a viser scene that are redrawn after each step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats, Floats32
from fgenv.view.figures.palette import Color

from .meshes import line_rgb, rgb

if TYPE_CHECKING:
    from viser import LineSegmentsHandle, PointCloudHandle, SceneApi


class LineSet:
    """Segments of a width in pixels."""

    def __init__(self, scene: SceneApi, name: str, width: float) -> None:
        self._scene, self._name, self._width = scene, name, width
        self._handle: LineSegmentsHandle | PointCloudHandle | None = None

    def draw(self, points: Floats, colors: Sequence[Color]) -> None:
        """Replace the drawing by segments (n, 2, 3), or points (n, 3), with a color each."""
        if not len(points):
            self.clear()
            return
        vertices, inks = np.asarray(points, dtype=np.float32), self._inks(colors)
        if self._handle is None:
            self._handle = self._add(vertices, inks)
            return
        self._handle.points = vertices
        self._handle.colors = inks

    def clear(self) -> None:
        """Remove the drawing."""
        if self._handle is not None:
            self._handle.remove()
        self._handle = None

    def _inks(self, colors: Sequence[Color]) -> NDArray[np.uint8]:
        return np.repeat(line_rgb(colors)[:, None], 2, axis=1)

    def _add(
        self, ends: Floats32, inks: NDArray[np.uint8]
    ) -> LineSegmentsHandle | PointCloudHandle:
        return self._scene.add_line_segments(
            self._name, ends, inks, thickness=self._width, thickness_units="screen"
        )


class PointSet(LineSet):
    """Points of a width in meters."""

    def _inks(self, colors: Sequence[Color]) -> NDArray[np.uint8]:
        return np.array([rgb(color) for color in colors], dtype=np.uint8)

    def _add(
        self, points: Floats32, inks: NDArray[np.uint8]
    ) -> LineSegmentsHandle | PointCloudHandle:
        return self._scene.add_point_cloud(
            self._name, points, inks, point_size=self._width, point_shape="circle"
        )

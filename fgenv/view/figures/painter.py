"""The renderer: bodies at poses become a picture, in native code and without OpenGL."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.view.figures.camera import Camera, box_corners, overview
from fgenv.view.figures.normals import SMOOTH, normal_maps
from fgenv.view.figures.palette import Color, to_linear
from fgenv.view.figures.surfaces import Floor, Light

FLOOR, LIGHT = Floor(), Light()
FADE = 40.0  # meters over which a floor fades out by default
FADE_RATIO = 2.5  # by default a floor fades out no nearer than this times the camera's distance
CONTRAST = 0.02  # of linear color: pixels that differ more are at an edge


class Mark(NamedTuple):
    """A ring on the floor around (x, y), meters, filled with a paler disc; shows a goal."""

    x: float
    y: float
    radius: float
    color: Color  # sRGB


class Painter:
    """Paints bodies in native code on all cores; bodies can move between two pictures.

    Bodies are Lambert surfaces under a sun with hard shadows and a sky. A picture does not depend
    on the number of threads or the instruction set.

    Args:
        shapes, colors: shape and sRGB color of each body; bodies can share a shape.
        camera: the camera. None: an overview of all bodies and marks of the first picture, of
            `width` by `height` pixels. These sizes have no effect if a camera is given.
        opacities: of each body, over 0, at most 1; 1 if left out. A body with less than 1 is
            translucent, receives no shadow and casts none.
        floor: the floor; None: no floor, and marks are an error.
        samples: `samples` squared rays are cast per pixel at an edge; 1: no antialiasing.
        smooth: edges that bend less (rad) are shaded smoothly; 0: flat shading.

    Raises:
        ValueError, TypeError: an invalid argument, by name.
    """

    def __init__(
        self,
        shapes: Sequence[Shape],
        colors: Sequence[Color],
        camera: Camera | None = None,
        *,
        opacities: Sequence[float] | None = None,
        floor: Floor | None = FLOOR,
        light: Light = LIGHT,
        width: int = 480,
        height: int = 360,
        samples: int = 2,
        smooth: float = SMOOTH,
    ) -> None:
        _check(shapes, colors, width, height)
        self.camera = camera
        self.samples = samples
        self._size, self._floor = (width, height), floor
        self._floor_color = None if floor is None else _linear(floor.color, "floor")
        self._bounds = np.array([s.bounds for s in shapes]).reshape(-1, 2, 3)
        unique = list({id(s): s for s in shapes}.values())
        index = {id(s): i for i, s in enumerate(unique)}
        maps = [normal_maps(s.vertices, s.faces, smooth) if smooth > 0 else None for s in unique]
        self._core = _core.Painter(
            unique,
            maps,
            [index[id(s)] for s in shapes],
            colors=_linear(colors, "colors"),
            opacities=[1.0] * len(shapes) if opacities is None else list(opacities),
            sun=light.direction,
            strength=light.sun,
            ambient=[light.above, light.below],
            sky=_linear([light.zenith, light.horizon], "light"),
        )

    def paint(
        self, poses: ArrayLike, marks: Sequence[Mark] = (), *, threads: int | None = None
    ) -> NDArray[np.uint8]:
        """Return the picture (height, width, 3), sRGB bytes, of the bodies at poses (n, 4, 4).

        Args:
            marks: rings on the floor.
            threads: number of threads. None: FGENV_THREADS, else all cores.
        """
        return self._paint(poses, marks, threads, with_depth=False)[0]

    def paint_with_depth(
        self, poses: ArrayLike, marks: Sequence[Mark] = (), *, threads: int | None = None
    ) -> tuple[NDArray[np.uint8], Floats]:
        """Return the picture of `paint` and its depths (height, width), in meters.

        A depth is measured along the camera's axis to the opaque surface at the middle of the
        pixel. It is infinite for the sky.
        """
        return self._paint(poses, marks, threads, with_depth=True)

    def _paint(
        self, poses: ArrayLike, marks: Sequence[Mark], threads: int | None, with_depth: bool
    ) -> tuple[NDArray[np.uint8], Floats]:
        if len(marks) and self._floor is None:
            raise ValueError(f"marks: got {len(marks)}, expected none for a painter without floor")
        colors = _linear([mark.color for mark in marks], "marks")
        circles = np.array([mark[:3] for mark in marks], dtype=np.float64).reshape(-1, 3)
        camera = self.camera or self._overview(np.asarray(poses, dtype=np.float64), circles)
        picture = self._core.paint(
            poses,
            eye=camera.eye,
            axes=camera.axes,
            pixels_per_slope=camera.pixels_per_slope,
            width=camera.width,
            height=camera.height,
            floor=self._ground(camera),
            marks=np.hstack([circles, colors]),
            samples=self.samples,
            contrast=CONTRAST,
            with_depth=with_depth,
            threads=threads,
        )
        self.camera = camera
        return picture

    def _ground(self, camera: Camera) -> Floats | None:
        """Height, grid, fade and linear color of the floor, (6,)."""
        floor, color = self._floor, self._floor_color
        if floor is None or color is None:
            return None
        fade = floor.fade
        if fade is None:
            distance = float(np.linalg.norm(np.subtract(camera.target, camera.eye)))
            fade = min(max(FADE, FADE_RATIO * distance), 1e12)
        return np.array([floor.height, floor.grid, fade, *color])

    def _overview(self, poses: Floats, circles: Floats) -> Camera:
        """A camera that sees all bodies and marks, or the origin if there are none."""
        if poses.shape != (len(self._bounds), 4, 4) or not np.isfinite(poses).all():
            poses = np.tile(np.eye(4), (len(self._bounds), 1, 1))  # the core raises the error
        local = box_corners(self._bounds[:, 0], self._bounds[:, 1])
        corners = (local @ poses[:, :3, :3].swapaxes(1, 2) + poses[:, None, :3, 3]).reshape(-1, 3)
        height = self._floor.height if self._floor else 0.0
        centers = np.column_stack([circles[:, :2], np.full(len(circles), height)])
        radii = circles[:, 2:] * (1.0, 1.0, 0.0)
        corners = np.concatenate([corners, centers - radii, centers + radii])
        if len(corners) == 0:
            corners = box_corners(np.full(3, -1.0), np.full(3, 1.0))
        return overview(corners, *self._size)


def _check(shapes: Sequence[Shape], colors: Sequence[Color], width: int, height: int) -> None:
    for i, shape in enumerate(shapes):
        if not isinstance(shape, Shape):
            raise TypeError(f"shapes[{i}]: got {type(shape).__name__}, expected a Shape")
    if len(shapes) != len(colors):
        raise ValueError(f"colors: got {len(colors)}, expected {len(shapes)}, one for each shape")
    if width < 1 or height < 1:
        raise ValueError(f"width, height: got {width}, {height}, expected 1 or more")


def _linear(colors: ArrayLike, name: str) -> Floats:
    """Return sRGB colors (0 to 1), one or in rows, as linear light."""
    rows = np.asarray(colors, dtype=np.float64)
    if rows.size == 0:
        return np.empty((0, 3))
    if rows.shape[-1] != 3:
        raise ValueError(f"{name}: got {rows.shape[-1]} numbers per color, expected 3: R, G, B")
    bad = ~((rows >= 0.0) & (rows <= 1.0))
    if bad.any():
        raise ValueError(f"{name}: got a color with {rows[bad][0]}, expected sRGB from 0 to 1")
    return to_linear(rows)

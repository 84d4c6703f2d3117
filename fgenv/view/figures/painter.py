"""Fast pictures of bodies that move: one painter, and a frame for each set of poses. No OpenGL."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.view.figures.camera import Camera, box_corners, overview
from fgenv.view.figures.normals import normal_maps
from fgenv.view.figures.palette import Color, to_linear
from fgenv.view.figures.shader import CONTRAST
from fgenv.view.figures.surfaces import SMOOTH, Floor, Light

FLOOR, LIGHT = Floor(), Light()
FAR = 2.5  # times as far as the camera looks, a floor fades out if it does not say where


class Mark(NamedTuple):
    """A ring on the floor around (x, y), meters, filled with a paler disc: a goal, say."""

    x: float
    y: float
    radius: float
    color: Color  # sRGB


class Painter:
    """Paints bodies where they stand, in native code on all cores, with the look of `render`.

    Lambert surfaces under a sun with hard shadows and a sky. A picture does not depend on the
    number of threads, nor on the instruction set.

    Args:
        shapes, colors: of the bodies; bodies may share a shape. Colors are sRGB.
        camera: looks at them; None: one that sees all bodies and marks of the first picture, of
            `width` by `height` pixels, which are of no use otherwise.
        floor: fades out farther than by default where the camera is far, unless it says where;
            None: there is no floor, and marks are an error.
        samples: squared, rays for each pixel at an edge; 1 is faster, and jagged.
        smooth: edges that bend less (rad) are shaded round; 0: every face is flat.

    Raises:
        ValueError, TypeError: a bad argument, by name.
    """

    def __init__(
        self,
        shapes: Sequence[Shape],
        colors: Sequence[Color],
        camera: Camera | None = None,
        *,
        floor: Floor | None = FLOOR,
        light: Light = LIGHT,
        width: int = 480,
        height: int = 360,
        samples: int = 2,
        smooth: float = SMOOTH,
    ) -> None:
        for i, shape in enumerate(shapes):
            if not isinstance(shape, Shape):
                raise TypeError(f"shapes[{i}]: {type(shape).__name__}, want a Shape")
        if len(shapes) != len(colors):
            raise ValueError(f"colors: {len(colors)} for {len(shapes)} shapes, want one for each")
        if width < 1 or height < 1:
            raise ValueError(f"width, height: got {width}, {height}, want 1 or more")
        self.camera = camera
        self.samples = samples
        self._size, self._floor = (width, height), floor
        self._floor_color = None if floor is None else _linear(floor.color, "floor")
        self._bounds = np.array([s.bounds for s in shapes]).reshape(-1, 2, 3)
        unique = list({id(s): s for s in shapes}.values())
        place = {id(s): i for i, s in enumerate(unique)}
        maps = [normal_maps(s.vertices, s.faces, smooth) if smooth > 0 else None for s in unique]
        which = [place[id(s)] for s in shapes]
        self._core = _core.Painter(
            unique,
            maps,
            which,
            _linear(colors, "colors"),
            light.direction,
            light.sun,
            [light.above, light.below],
            _linear([light.zenith, light.horizon], "light"),
        )

    def paint(
        self, poses: ArrayLike, marks: Sequence[Mark] = (), *, threads: int | None = None
    ) -> NDArray[np.uint8]:
        """The picture (height, width, 3), sRGB bytes, of the bodies at poses (n, 4, 4).

        Args:
            marks: drawn on the floor.
            threads: None: FGENV_THREADS, else all cores.
        """
        if len(marks) and self._floor is None:
            raise ValueError(f"marks: {len(marks)} of them, but the painter has no floor")
        colors = _linear([mark.color for mark in marks], "marks")
        places = np.array([mark[:3] for mark in marks], dtype=np.float64).reshape(-1, 3)
        camera = self.camera or self._overview(np.asarray(poses, dtype=np.float64), places)
        picture = self._core.paint(
            poses,
            camera.eye,
            camera.axes,
            camera.pixels_per_slope,
            camera.width,
            camera.height,
            self._ground(camera),
            np.hstack([places, colors]),
            self.samples,
            CONTRAST,
            threads,
        )
        self.camera = camera
        return picture

    def _ground(self, camera: Camera) -> Floats | None:
        """Height, grid, fade and linear color of the floor, for the core."""
        floor, color = self._floor, self._floor_color
        if floor is None or color is None:
            return None
        fade = floor.fade
        if fade == Floor.fade:
            far = float(np.linalg.norm(np.subtract(camera.target, camera.eye)))
            fade = min(max(fade, FAR * far), 1e12)
        return np.array([floor.height, floor.grid, fade, *color])

    def _overview(self, poses: Floats, places: Floats) -> Camera:
        """Of all bodies and marks; of what is around the origin if there are none."""
        if poses.shape != (len(self._bounds), 4, 4) or not np.isfinite(poses).all():
            poses = np.tile(np.eye(4), (len(self._bounds), 1, 1))  # the core tells what is wrong
        local = box_corners(self._bounds[:, 0], self._bounds[:, 1])
        corners = (local @ poses[:, :3, :3].swapaxes(1, 2) + poses[:, None, :3, 3]).reshape(-1, 3)
        height = self._floor.height if self._floor else 0.0
        flat = np.column_stack([places[:, :2], np.full(len(places), height)])
        reach = places[:, 2:] * (1.0, 1.0, 0.0)
        corners = np.concatenate([corners, flat - reach, flat + reach])
        if len(corners) == 0:
            corners = box_corners(np.full(3, -1.0), np.full(3, 1.0))
        return overview(corners, *self._size)


def _linear(colors: ArrayLike, name: str) -> Floats:
    """sRGB colors, 0 to 1, one or in rows, as linear light."""
    rows = np.asarray(colors, dtype=np.float64)
    if rows.size == 0:
        return np.empty((0, 3))
    if rows.shape[-1] != 3:
        raise ValueError(f"{name}: {rows.shape[-1]} numbers a color, want red, green and blue")
    bad = ~((rows >= 0.0) & (rows <= 1.0))
    if bad.any():
        raise ValueError(f"{name}: a color with {rows[bad][0]}, want sRGB from 0 to 1")
    return to_linear(rows)

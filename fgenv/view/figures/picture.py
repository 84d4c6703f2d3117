"""A picture: a painted scene with lines, points and labels drawn over it."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFont

from fgenv.arrays import Flags, Floats
from fgenv.saving import atomic
from fgenv.view.figures.camera import Camera
from fgenv.view.figures.painter import FADE, LIGHT, Painter
from fgenv.view.figures.palette import INK, WHITE, Color, rgba
from fgenv.view.figures.surfaces import Floor, Light, Solid

NEAR = 1e-3  # meters: points nearer to the eye are not drawn
FINE = 3  # overlays are drawn at this multiple of the picture's size, for smooth lines


class Picture:
    """Paints solids once; lines, points and labels can then be drawn over them.

    Drawings are tested against the depth of the painted scene. `hidden` is the opacity of the
    parts behind a surface: 0 omits them, 1 draws them as if there were no surface.
    """

    def __init__(
        self,
        camera: Camera,
        solids: Sequence[Solid],
        *,
        floor: Floor | None = None,
        light: Light = LIGHT,
        samples: int = 3,
    ) -> None:
        self.camera = camera
        if floor is not None and floor.fade is None:
            floor = replace(floor, fade=FADE)
        painter = Painter(
            [solid.shape for solid in solids],
            [solid.color for solid in solids],
            camera,
            opacities=[solid.opacity for solid in solids],
            floor=floor,
            light=light,
            samples=samples,
        )
        poses = np.reshape([solid.pose for solid in solids], (-1, 4, 4))
        painted, depth = painter.paint_with_depth(poses)
        self._base = Image.fromarray(painted)
        # A line on a silhouette is visible if it is visible in any neighbor of the pixel.
        around = np.lib.stride_tricks.sliding_window_view(np.pad(depth, 1, mode="edge"), (3, 3))
        self._depth: Floats = around.max(axis=(2, 3))
        self._layer = Image.new("RGBA", (FINE * camera.width, FINE * camera.height))
        self._draw = ImageDraw.Draw(self._layer)
        self._labels: list[tuple[tuple[float, float], str, Color, float]] = []

    def segments(
        self,
        ends: ArrayLike,
        color: Color,
        *,
        width: float = 1.0,
        opacity: float = 1.0,
        hidden: float = 0.0,
    ) -> None:
        """Draw segments (n, 2, 3), in meters; `width` in pixels."""
        thick = max(1, round(width * FINE))
        for pixels, seen in self._traces(np.asarray(ends, dtype=np.float64).reshape(-1, 2, 3)):
            ink = opacity if seen else hidden
            if ink > 0.0:
                self._draw.line(pixels, fill=rgba(color, ink), width=thick)

    def polyline(
        self, points: ArrayLike, color: Color, *, width: float = 2.0, hidden: float = 0.0
    ) -> None:
        """Draw a line through points (n, 3)."""
        p = np.asarray(points, dtype=np.float64)
        self.segments(np.stack([p[:-1], p[1:]], axis=1), color, width=width, hidden=hidden)

    def points(
        self, points: ArrayLike, color: Color, *, radius: float = 2.0, hidden: float = 0.0
    ) -> None:
        """Draw points (n, 3) as discs; `radius` in pixels."""
        pixels, depth = self.camera.project(np.asarray(points, dtype=np.float64).reshape(-1, 3))
        seen = self._visible(pixels, depth)
        inside = (depth > NEAR) & ((pixels > -radius) & (pixels < self._size + radius)).all(axis=1)
        r = radius * FINE
        for (x, y), visible in zip(pixels[inside] * FINE, seen[inside], strict=True):
            opacity = 1.0 if visible else hidden
            if opacity > 0.0:
                self._draw.ellipse((x - r, y - r, x + r, y + r), fill=rgba(color, opacity))

    def label(self, point: ArrayLike, text: str, *, color: Color = INK, size: float = 14.0) -> None:
        """Write a text centered at a point (3,); `size` in pixels."""
        pixel, depth = self.camera.project(point)
        if depth > NEAR:
            self._labels.append(((float(pixel[0]), float(pixel[1])), text, color, size))

    def image(self) -> Image.Image:
        """Return the picture with its overlays at the camera's size."""
        done = self._base.convert("RGBA")
        done.alpha_composite(self._layer.reduce(FINE))
        draw = ImageDraw.Draw(done)
        for place, text, color, size in self._labels:
            font = ImageFont.load_default(size)
            ink, halo = rgba(color, 1.0), rgba(WHITE, 1.0)
            draw.text(place, text, ink, font, anchor="mm", stroke_width=2, stroke_fill=halo)
        return done.convert("RGB")

    def pixels(self) -> NDArray[np.uint8]:
        """Return the picture with its overlays, (height, width, 3) bytes."""
        return np.asarray(self.image())

    def save(self, path: str | Path) -> None:
        """Write the picture with its overlays; the suffix of the name sets the format."""
        with atomic(path) as partial:
            self.image().save(partial)

    @property
    def _size(self) -> Floats:
        return np.array([self.camera.width, self.camera.height], dtype=np.float64)

    def _traces(self, ends: Floats) -> Iterator[tuple[list[float], bool]]:
        """Yield lines (x, y, x, y) on the layer for segments (n, 2, 3), and their visibility."""
        ends = self._ahead(ends)
        pixels, depth = self.camera.project(ends)
        outside = (pixels.max(axis=1) < 0) | (pixels.min(axis=1) > self._size)
        keep = ~outside.any(axis=1)
        pixels, depth = pixels[keep], depth[keep]
        length = np.linalg.norm(pixels[:, 1] - pixels[:, 0], axis=1)
        count = np.clip(np.ceil(length), 2, 4096).astype(int)
        line = np.repeat(np.arange(len(count)), count)
        first = np.cumsum(count) - count
        t = (np.arange(len(line)) - first[line]) / (count[line] - 1)
        # A segment is straight on the picture, and the inverse of its depth is linear along it.
        places = pixels[line, 0] + t[:, None] * (pixels[line, 1] - pixels[line, 0])
        inverse = 1 / depth[line, 0] + t * (1 / depth[line, 1] - 1 / depth[line, 0])
        seen = self._visible(places, 1 / inverse)
        cuts = np.flatnonzero((line[1:] != line[:-1]) | (seen[1:] != seen[:-1])) + 1
        for low, high in zip([0, *cuts.tolist()], [*cuts.tolist(), len(line)], strict=True):
            if low < high:
                last = high if high < len(line) and line[high] == line[low] else high - 1
                yield (places[[low, last]] * FINE).ravel().tolist(), bool(seen[low])

    def _ahead(self, ends: Floats) -> Floats:
        """Clip segments (n, 2, 3) to the half-space before the eye; omit those behind it."""
        depth = self.camera.project(ends)[1]
        ends, depth = ends[depth.max(axis=1) > NEAR], depth[depth.max(axis=1) > NEAR]
        for k in (0, 1):
            behind = depth[:, k] < NEAR
            here, other = depth[behind, k], depth[behind, 1 - k]
            t = ((2 * NEAR - here) / (other - here)).clip(0, 1)[:, None]
            ends[behind, k] += t * (ends[behind, 1 - k] - ends[behind, k])
        return ends

    def _visible(self, pixels: Floats, depth: Floats) -> Flags:
        rows, columns = self._depth.shape
        x = np.clip(pixels[:, 0], 0, columns - 1).astype(int)
        y = np.clip(pixels[:, 1], 0, rows - 1).astype(int)
        return np.asarray((depth > NEAR) & (depth <= self._depth[y, x] * 1.002 + 1e-4))

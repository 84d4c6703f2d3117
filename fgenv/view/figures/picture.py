"""A picture: a rendered scene with lines, points and labels drawn over it."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFont

from fgenv.arrays import Floats
from fgenv.view.figures.camera import Camera
from fgenv.view.figures.palette import INK, WHITE, Color, to_srgb
from fgenv.view.figures.shader import render
from fgenv.view.figures.surfaces import Floor, Light, Solid

NEAR = 1e-3  # meters: what is nearer to the eye than this is not drawn
FINE = 3  # overlays are drawn so many times larger, for smooth lines


class Picture:
    """Renders at once; then draw over it, and take it with `image`, `pixels` or `save`.

    Drawings are tested against the depth of what was rendered: `hidden` is the opacity of what
    lies behind a surface (0 leaves it out, 1 draws it as if nothing were in front).
    """

    def __init__(
        self,
        camera: Camera,
        solids: Sequence[Solid],
        *,
        floor: Floor | None = None,
        light: Light | None = None,
        samples: int = 3,
    ) -> None:
        self.camera = camera
        color, depth = render(camera, solids, floor=floor, light=light, samples=samples)
        self._base = Image.fromarray((to_srgb(color) * 255 + 0.5).astype(np.uint8))
        # A line on a silhouette is seen if any neighbor lets it be seen.
        around = np.lib.stride_tricks.sliding_window_view(np.pad(depth, 1, mode="edge"), (3, 3))
        self._depth: NDArray[np.float64] = around.max(axis=(2, 3))
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
        """Draw segments (n, 2, 3), meters; width in pixels."""
        thick = max(1, round(width * FINE))
        for pixels, seen in self._traces(np.asarray(ends, dtype=np.float64).reshape(-1, 2, 3)):
            ink = opacity if seen else hidden
            if ink > 0.0:
                self._draw.line(pixels, fill=_rgba(color, ink), width=thick)

    def polyline(
        self, points: ArrayLike, color: Color, *, width: float = 2.0, hidden: float = 0.0
    ) -> None:
        """Draw a line through points (n, 3)."""
        p = np.asarray(points, dtype=np.float64)
        self.segments(np.stack([p[:-1], p[1:]], axis=1), color, width=width, hidden=hidden)

    def points(
        self, points: ArrayLike, color: Color, *, radius: float = 2.0, hidden: float = 0.0
    ) -> None:
        """Draw points (n, 3) as discs; radius in pixels."""
        pixels, depth = self.camera.project(np.asarray(points, dtype=np.float64).reshape(-1, 3))
        seen = self._visible(pixels, depth)
        inside = (depth > NEAR) & ((pixels > -radius) & (pixels < self._size + radius)).all(axis=1)
        r = radius * FINE
        for (x, y), visible in zip(pixels[inside] * FINE, seen[inside], strict=True):
            opacity = 1.0 if visible else hidden
            if opacity > 0.0:
                self._draw.ellipse((x - r, y - r, x + r, y + r), fill=_rgba(color, opacity))

    def label(self, point: ArrayLike, text: str, *, color: Color = INK, size: float = 14.0) -> None:
        """Write with the text's middle at a point (3,); size in pixels."""
        pixel, depth = self.camera.project(point)
        if depth > NEAR:
            self._labels.append(((float(pixel[0]), float(pixel[1])), text, color, size))

    def image(self) -> Image.Image:
        """The finished picture at the camera's size."""
        done = self._base.convert("RGBA")
        done.alpha_composite(self._layer.reduce(FINE))
        draw = ImageDraw.Draw(done)
        for place, text, color, size in self._labels:
            font = ImageFont.load_default(size)
            ink, halo = _rgba(color, 1.0), _rgba(WHITE, 1.0)
            draw.text(place, text, ink, font, anchor="mm", stroke_width=2, stroke_fill=halo)
        return done.convert("RGB")

    def pixels(self) -> NDArray[np.uint8]:
        """The finished picture, (height, width, 3) bytes."""
        return np.asarray(self.image())

    def save(self, path: str | Path) -> None:
        """Write the finished picture; the name's ending says the format."""
        self.image().save(path)

    @property
    def _size(self) -> Floats:
        return np.array([self.camera.width, self.camera.height], dtype=np.float64)

    def _traces(self, ends: Floats) -> Iterator[tuple[list[float], bool]]:
        """Lines (x, y, x, y) on the layer for segments (n, 2, 3), cut where they are hidden."""
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
        # Straight on the picture; the inverse of the depth runs linearly there.
        places = pixels[line, 0] + t[:, None] * (pixels[line, 1] - pixels[line, 0])
        inverse = 1 / depth[line, 0] + t * (1 / depth[line, 1] - 1 / depth[line, 0])
        seen = self._visible(places, 1 / inverse)
        cuts = np.flatnonzero((line[1:] != line[:-1]) | (seen[1:] != seen[:-1])) + 1
        for low, high in zip([0, *cuts.tolist()], [*cuts.tolist(), len(line)], strict=True):
            if low < high:
                last = high if high < len(line) and line[high] == line[low] else high - 1
                yield (places[[low, last]] * FINE).ravel().tolist(), bool(seen[low])

    def _ahead(self, ends: Floats) -> Floats:
        """Segments (n, 2, 3) cut to what lies ahead of the eye; those all behind it left out."""
        depth = self.camera.project(ends)[1]
        ends, depth = ends[depth.max(axis=1) > NEAR], depth[depth.max(axis=1) > NEAR]
        for k in (0, 1):
            behind = depth[:, k] < NEAR
            here, other = depth[behind, k], depth[behind, 1 - k]
            t = ((2 * NEAR - here) / (other - here)).clip(0, 1)[:, None]
            ends[behind, k] += t * (ends[behind, 1 - k] - ends[behind, k])
        return ends

    def _visible(self, pixels: Floats, depth: Floats) -> NDArray[np.bool_]:
        rows, columns = self._depth.shape
        x = np.clip(pixels[:, 0], 0, columns - 1).astype(int)
        y = np.clip(pixels[:, 1], 0, rows - 1).astype(int)
        return np.asarray((depth > NEAR) & (depth <= self._depth[y, x] * 1.002 + 1e-4))


def _rgba(color: Color, opacity: float) -> tuple[int, int, int, int]:
    red, green, blue = (round(255 * c) for c in color)
    return red, green, blue, round(255 * opacity)

"""A clear sheet over a frame, on which lines, rings, dots and words are drawn."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fgenv.arrays import Floats
from fgenv.view.figures.camera import Camera
from fgenv.view.figures.movie import Frame
from fgenv.view.figures.palette import BLACK, WHITE, Color

FINE = 2  # drawn so many times larger, for smooth lines


class Sheet:
    """What is drawn is laid over the frame in the end; all places are meters, all sizes pixels."""

    def __init__(self, frame: Frame, camera: Camera) -> None:
        self.camera, self._image = camera, Image.fromarray(frame).convert("RGBA")
        self._layer = Image.new("RGBA", (FINE * camera.width, FINE * camera.height))
        self._draw = ImageDraw.Draw(self._layer)
        self._words: list[tuple[float, float, str, Color]] = []

    def line(
        self, points: Floats, color: Color, width: float, opacity: float = 1.0, halo: float = 0.0
    ) -> None:
        """Through points (n, 3), with a white halo; left out where one is behind the eye."""
        pixels, depth = self.camera.project(points)
        if (depth > 0).all():
            places = (pixels * FINE).ravel().tolist()
            if halo > 0:
                self._draw.line(places, ink(WHITE), round((width + 2 * halo) * FINE), "curve")
            self._draw.line(places, ink(color, opacity), round(width * FINE), "curve")

    def dot(self, point: Floats, color: Color, radius: float) -> None:
        """A disc with a white rim at a point (3,)."""
        self._disc(point, radius, fill=ink(color), outline=ink(WHITE), width=FINE)

    def ring(self, point: Floats, radius: float = 7.0) -> None:
        """Around a point (3,)."""
        self._disc(point, radius, outline=ink(BLACK), width=2 * FINE)

    def text(self, x: float, y: float, words: str, color: Color) -> None:
        """Words from there on, pixels."""
        self._words.append((x, y, words, color))

    def frame(self) -> Frame:
        """The frame with all that."""
        self._image.alpha_composite(self._layer.reduce(FINE))
        draw = ImageDraw.Draw(self._image)
        font = ImageFont.load_default(14)
        for x, y, words, color in self._words:
            draw.text((x, y), words, ink(color), font, stroke_width=2, stroke_fill=ink(WHITE))
        return np.asarray(self._image.convert("RGB"))

    def _disc(self, point: Floats, radius: float, **look: object) -> None:
        pixel, depth = self.camera.project(point)
        if depth > 0:
            box = np.concatenate([pixel - radius, pixel + radius]) * FINE
            self._draw.ellipse(box.tolist(), **look)  # type: ignore[arg-type]


def ink(color: Color, opacity: float = 1.0) -> tuple[int, int, int, int]:
    """An sRGB color in bytes."""
    red, green, blue, alpha = (round(255 * c) for c in (*color, opacity))
    return red, green, blue, alpha

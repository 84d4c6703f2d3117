"""A transparent layer over a frame for lines, rings, dots and text."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fgenv.arrays import Floats
from fgenv.view.figures.camera import Camera
from fgenv.view.figures.movie import Frame
from fgenv.view.figures.palette import BLACK, WHITE, Color, rgba

FINE = 2  # the layer is drawn at this multiple of the frame's size, for smooth lines


class Overlay:
    """A layer to composite over the frame; positions in meters, sizes in pixels."""

    def __init__(self, frame: Frame, camera: Camera) -> None:
        self.camera, self._image = camera, Image.fromarray(frame).convert("RGBA")
        self._layer = Image.new("RGBA", (FINE * camera.width, FINE * camera.height))
        self._draw = ImageDraw.Draw(self._layer)
        self._texts: list[tuple[float, float, str, Color]] = []

    def line(
        self, points: Floats, color: Color, width: float, opacity: float = 1.0, halo: float = 0.0
    ) -> None:
        """Draw a line through points (n, 3) with a white halo, unless one is behind the eye."""
        pixels, depth = self.camera.project(points)
        if (depth > 0).all():
            places = (pixels * FINE).ravel().tolist()
            if halo > 0:
                self._draw.line(places, rgba(WHITE), round((width + 2 * halo) * FINE), "curve")
            self._draw.line(places, rgba(color, opacity), round(width * FINE), "curve")

    def dot(self, point: Floats, color: Color, radius: float) -> None:
        """Draw a disc with a white rim at a point (3,)."""
        self._disc(point, radius, fill=rgba(color), outline=rgba(WHITE), width=FINE)

    def ring(self, point: Floats, radius: float = 7.0) -> None:
        """Draw a ring around a point (3,)."""
        self._disc(point, radius, outline=rgba(BLACK), width=2 * FINE)

    def text(self, x: float, y: float, text: str, color: Color) -> None:
        """Write a text with its top left corner at a pixel."""
        self._texts.append((x, y, text, color))

    def frame(self) -> Frame:
        """Return the frame with the layer."""
        self._image.alpha_composite(self._layer.reduce(FINE))
        draw = ImageDraw.Draw(self._image)
        font = ImageFont.load_default(14)
        for x, y, text, color in self._texts:
            draw.text((x, y), text, rgba(color), font, stroke_width=2, stroke_fill=rgba(WHITE))
        return np.asarray(self._image.convert("RGB"))

    def _disc(self, point: Floats, radius: float, **look: object) -> None:
        pixel, depth = self.camera.project(point)
        if depth > 0:
            box = np.concatenate([pixel - radius, pixel + radius]) * FINE
            self._draw.ellipse(box.tolist(), **look)  # type: ignore[arg-type]

"""Color quantization for small files: each pixel gets the nearest palette color, no dithering."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from fgenv.view.figures.palette import Color

COMMON = 176  # palette colors by frequency in the picture; the others are far apart
SHADES = np.linspace(0.55, 1.0, 4)  # brightness of a color from shade to sun
SWATCH = 2  # pixels high
UNKNOWN = 255
BAND = 4096  # colors at a time


def quantize(image: Image.Image) -> Image.Image:
    """Return the picture in 255 colors of its own."""
    return Palette(image).apply(image)


class Palette:
    """255 colors for a picture: most of them frequent in it, the others far apart.

    Args:
        also: colors to include, lit and shaded, even if the picture lacks them.
    """

    def __init__(self, image: Image.Image, also: Sequence[Color] = ()) -> None:
        sample = with_swatches(image.convert("RGB"), also)
        common = sample.quantize(COMMON, Image.Quantize.MEDIANCUT)
        apart = sample.quantize(UNKNOWN - COMMON, Image.Quantize.MAXCOVERAGE)
        colors = [palette_colors(common), palette_colors(apart)]
        self.colors: NDArray[np.uint8] = np.concatenate(colors)[:UNKNOWN]
        self._nearest = np.full(1 << 24, UNKNOWN, dtype=np.uint8)  # by 24-bit color

    def apply(self, image: Image.Image) -> Image.Image:
        """Return the picture in these colors; index 255 stays unused."""
        pixels = np.asarray(image.convert("RGB"), dtype=np.uint32)
        codes = pixels[..., 0] << 16 | pixels[..., 1] << 8 | pixels[..., 2]
        self._find_nearest(np.unique(codes[self._nearest[codes] == UNKNOWN]))
        quantized = Image.fromarray(self._nearest[codes]).convert("P")
        quantized.putpalette(self.colors.tobytes())
        return quantized

    def _find_nearest(self, codes: NDArray[np.uint32]) -> None:
        """Store the nearest palette color of each of these colors."""
        own = self.colors.astype(np.float64)
        for band in np.array_split(codes, len(codes) // BAND + 1):
            rows = np.stack([band >> 16, band >> 8 & 255, band & 255], axis=1).astype(np.float64)
            # |a - b|² without |a|², which does not depend on b
            distance = np.einsum("ci,ci->c", own, own) - 2.0 * rows @ own.T
            self._nearest[band] = distance.argmin(axis=1)


def palette_colors(image: Image.Image) -> NDArray[np.uint8]:
    """Return the palette (n, 3) of an image that has one."""
    return np.array(image.getpalette() or [], dtype=np.uint8).reshape(-1, 3)


def with_swatches(image: Image.Image, colors: Sequence[Color]) -> Image.Image:
    """Return the image above swatches of colors, lit and shaded."""
    if len(colors) == 0:
        return image
    shades = np.round(255 * SHADES[:, None, None] * np.array(colors)).astype(np.uint8)
    size = image.width, SWATCH * len(SHADES)
    extended = Image.new("RGB", (image.width, image.height + size[1]))
    extended.paste(image)
    swatches = Image.fromarray(shades).resize(size, Image.Resampling.NEAREST)
    extended.paste(swatches, (0, image.height))
    return extended

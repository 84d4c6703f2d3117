"""Pictures in few colors, for small files: each pixel in the nearest of them, none dithered."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from fgenv.view.figures.palette import Color

COMMON = 176  # colors of a palette that are common in the picture; the others are far apart
SHADES = np.linspace(0.55, 1.0, 4)  # of a color, from the shade into the sun
SWATCH = 2  # pixels high
UNKNOWN = 255
BAND = 4096  # colors at a time


def small(image: Image.Image) -> Image.Image:
    """The picture in 255 colors of its own."""
    return Palette(image).apply(image)


class Palette:
    """255 colors for a picture: most of them common in it, the others far apart.

    Args:
        also: colors that are to be in it, lit and in the shade, though the picture lacks them.
    """

    def __init__(self, image: Image.Image, also: Sequence[Color] = ()) -> None:
        sample = with_swatches(image.convert("RGB"), also)
        common = sample.quantize(COMMON, Image.Quantize.MEDIANCUT)
        apart = sample.quantize(UNKNOWN - COMMON, Image.Quantize.MAXCOVERAGE)
        found = [colors_of(common), colors_of(apart)]
        self.colors: NDArray[np.uint8] = np.concatenate(found)[:UNKNOWN]
        self._nearest = np.full(1 << 24, UNKNOWN, dtype=np.uint8)  # of each color that there is

    def apply(self, image: Image.Image) -> Image.Image:
        """The picture in these colors; index 255 stays unused."""
        pixels = np.asarray(image.convert("RGB"), dtype=np.uint32)
        codes = pixels[..., 0] << 16 | pixels[..., 1] << 8 | pixels[..., 2]
        self._learn(np.unique(codes[self._nearest[codes] == UNKNOWN]))
        done = Image.fromarray(self._nearest[codes]).convert("P")
        done.putpalette(self.colors.tobytes())
        return done

    def _learn(self, codes: NDArray[np.uint32]) -> None:
        """Find the nearest of the palette to each of these colors."""
        own = self.colors.astype(np.float64)
        for band in np.array_split(codes, len(codes) // BAND + 1):
            rows = np.stack([band >> 16, band >> 8 & 255, band & 255], axis=1).astype(np.float64)
            # |a - b|² less |a|², which is the same for all b
            far = np.einsum("ci,ci->c", own, own) - 2.0 * rows @ own.T
            self._nearest[band] = far.argmin(axis=1)


def colors_of(image: Image.Image) -> NDArray[np.uint8]:
    """The palette (n, 3) of an image that has one."""
    return np.array(image.getpalette() or [], dtype=np.uint8).reshape(-1, 3)


def with_swatches(image: Image.Image, colors: Sequence[Color]) -> Image.Image:
    """The image above swatches of colors, in the sun and in the shade."""
    if len(colors) == 0:
        return image
    shades = np.round(255 * SHADES[:, None, None] * np.array(colors)).astype(np.uint8)
    size = image.width, SWATCH * len(SHADES)
    sheet = Image.new("RGB", (image.width, image.height + size[1]))
    sheet.paste(image)
    swatches = Image.fromarray(shades).resize(size, Image.Resampling.NEAREST)
    sheet.paste(swatches, (0, image.height))
    return sheet

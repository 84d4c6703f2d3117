"""Quantization: each pixel in its nearest color, with the required colors in the palette."""

import numpy as np
from PIL import Image

from fgenv.view.figures.palette import TEAM
from fgenv.view.figures.quantize import UNKNOWN, Palette, quantize

RNG = np.random.default_rng(0)
NOISE = Image.fromarray(RNG.integers(0, 256, (40, 60, 3), dtype=np.uint8))


def test_each_pixel_is_in_the_nearest_color() -> None:
    palette = Palette(NOISE)
    done = np.asarray(palette.apply(NOISE))
    own, pixels = palette.colors.astype(int), np.asarray(NOISE).astype(int)
    far = ((pixels[:, :, None] - own) ** 2).sum(axis=3)
    chosen = np.take_along_axis(far, done[..., None].astype(int), axis=2)[..., 0]
    assert done.max() < UNKNOWN
    np.testing.assert_array_equal(chosen, far.min(axis=2))


def test_few_colors_stay_as_they_are() -> None:
    shades = np.repeat(np.arange(0, 240, 4, dtype=np.uint8)[None, :, None], 3, axis=2)
    image = Image.fromarray(np.tile(shades, (8, 1, 1)))
    worst = np.abs(np.asarray(quantize(image).convert("RGB")).astype(int) - np.asarray(image)).max()
    assert worst <= 2


def test_robots_colors_are_kept_though_the_first_frame_lacks_them() -> None:
    gray = Image.new("RGB", (600, 400), (230, 232, 233))
    team = np.round(255 * np.array(TEAM)).astype(np.uint8)[None]
    kept = np.asarray(Palette(gray, TEAM).apply(Image.fromarray(team)).convert("RGB"))
    assert np.abs(kept.astype(int) - team).max() <= 3

"""Movies from frames: GIF with Pillow, MP4 (H.264) with the encoder of imageio-ffmpeg."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from fgenv.saving import atomic
from fgenv.view.figures.palette import TEAM
from fgenv.view.figures.quantize import Palette

Frame = NDArray[np.uint8]  # (height, width, 3), rows from the top
SUFFIXES = (".gif", ".mp4")
MIN_DELAY = 0.02  # seconds between two frames of a GIF


def frame_seconds(path: str | Path, fps: float) -> float:
    """Return the duration of a frame in seconds, as near to 1 / fps as the format allows.

    Raises:
        ValueError: an unknown format, or fps out of range.
        ImportError: an encoder is missing, with the remedy.
    """
    check_format(Path(path))
    if not 0 < fps <= 1000:
        raise ValueError(f"fps: got {fps!r}, expected frames per second, over 0, at most 1000")
    if Path(path).suffix == ".gif":
        return max(MIN_DELAY, round(100 / fps) / 100)
    return 1 / fps


def write_movie(path: str | Path, frames: Iterable[Frame], fps: float = 10.0) -> int:
    """Write a movie and return the number of frames. Frames are consumed one by one.

    Args:
        path: file that ends in .gif or .mp4; it is replaced once the movie is complete.
        frames: (height, width, 3) bytes, all of one size; an even size for MP4.
        fps: frames per second; delays of a GIF are multiples of 0.01 s.

    Raises:
        ValueError: another suffix, no frames, or frames of different sizes.
        ImportError: an encoder is missing, with the remedy.
        OSError: the file cannot be written.
    """
    path, count = Path(path), itertools.count()
    seconds = frame_seconds(path, fps)
    checked = checked_frames(frames, count, even=path.suffix == ".mp4")
    with atomic(path) as partial:
        (write_gif if path.suffix == ".gif" else write_mp4)(partial, checked, seconds)
    return next(count)


def check_format(path: Path) -> None:
    """Raise the errors of `frame_seconds` that concern the path."""
    if path.suffix not in SUFFIXES:
        raise ValueError(f"movie: got {path}, expected a name that ends in {' or '.join(SUFFIXES)}")
    if path.suffix == ".mp4":
        encoder()


def encoder() -> Any:
    """Return the module that writes MP4."""
    try:
        import imageio_ffmpeg
    except ImportError:
        remedy = "pip install 'fgenv[view]', or use a name that ends in .gif"
        raise ImportError(f"MP4 needs imageio-ffmpeg; remedy: {remedy}") from None
    return imageio_ffmpeg


def checked_frames(frames: Iterable[Frame], count: Iterator[int], even: bool) -> Iterator[Frame]:
    """Yield the frames once each is checked, and count them."""
    shape: tuple[int, ...] = ()
    for frame in frames:
        wrong = frame.ndim != 3 or frame.shape[2] != 3 or frame.dtype != np.uint8
        if wrong or (shape and frame.shape != shape):
            expected = str(shape) if shape else "(height, width, 3)"
            got = f"{frame.dtype} {frame.shape}"
            raise ValueError(f"frame: got {got}, expected uint8 {expected}")
        shape = frame.shape
        if even and (shape[0] % 2 or shape[1] % 2):
            size = f"{shape[1]} x {shape[0]} pixels"
            raise ValueError(f"frame: got {size}, expected even numbers for MP4")
        next(count)
        yield frame
    if not shape:
        raise ValueError("frames: got none, expected one or more")


def write_gif(path: Path, frames: Iterator[Frame], seconds: float) -> None:
    """Write a GIF with one palette, of the first frame and the robots, so that nothing flickers.

    One color is reserved for pixels that did not change, which makes the file small.
    """
    begin = Image.fromarray(next(frames))
    palette = Palette(begin, TEAM)
    rest = (palette.apply(Image.fromarray(frame)) for frame in frames)
    delay = round(1000 * seconds)
    first = palette.apply(begin)
    first.save(path, save_all=True, append_images=rest, duration=delay, loop=0, optimize=True)


def write_mp4(path: Path, frames: Iterator[Frame], seconds: float) -> None:
    """Write H.264 that browsers play."""
    first = next(frames)
    size = first.shape[1], first.shape[0]
    writer = encoder().write_frames(
        str(path), size, fps=1 / seconds, codec="libx264", macro_block_size=2, quality=7
    )
    with contextlib.closing(writer):
        writer.send(None)
        for frame in itertools.chain([first], frames):
            writer.send(np.ascontiguousarray(frame))

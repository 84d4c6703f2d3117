"""Movies from frames: GIF by Pillow, MP4 (H.264) by the encoder of imageio-ffmpeg."""

from __future__ import annotations

import contextlib
import itertools
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from fgenv.view.figures.palette import TEAM
from fgenv.view.figures.quantize import Palette

Frame = NDArray[np.uint8]  # (height, width, 3), rows from the top
SUFFIXES = (".gif", ".mp4")
LEAST_DELAY = 0.02  # seconds between two frames of a GIF, which counts in hundredths


def frame_seconds(path: str | Path, fps: float) -> float:
    """Seconds that each frame is shown for, as near to 1 / fps as the format can.

    Raises:
        ValueError: the name ends in no known format, or fps is not over 0.
        ImportError: an encoder is missing, with the remedy.
    """
    check(Path(path))
    if not 0 < fps <= 1000:
        raise ValueError(f"fps: got {fps!r}, expected frames per second, over 0, to 1000")
    if Path(path).suffix == ".gif":
        return max(LEAST_DELAY, round(100 / fps) / 100)
    return 1 / fps


def write_movie(path: str | Path, frames: Iterable[Frame], fps: float = 10.0) -> int:
    """Write a movie; returns the number of frames. Frames are taken one by one, when needed.

    Args:
        path: its name ends in .gif or .mp4. What is there is replaced when all is written.
        frames: (height, width, 3) bytes, all of one size; even sizes for MP4.
        fps: frames per second; a GIF counts in hundredths of a second.

    Raises:
        ValueError: other names, no frames, or frames of other sizes.
        ImportError: an encoder is missing, with the remedy.
        OSError: it cannot be written.
    """
    path, counted = Path(path), itertools.count()
    seconds = frame_seconds(path, fps)
    every = checked(frames, counted, even=path.suffix == ".mp4")
    half = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        (write_gif if path.suffix == ".gif" else write_mp4)(half, every, seconds)
        os.replace(half, path)
    finally:
        half.unlink(missing_ok=True)
    return next(counted)


def check(path: Path) -> None:
    """See `frame_seconds`."""
    if path.suffix not in SUFFIXES:
        raise ValueError(f"movie: got {path}, expected a name that ends in {' or '.join(SUFFIXES)}")
    if path.suffix == ".mp4":
        encoder()


def encoder() -> Any:
    """The module that writes MP4."""
    try:
        import imageio_ffmpeg
    except ImportError:
        remedy = "pip install 'fgenv[view]', or take a name that ends in .gif"
        raise ImportError(f"MP4 wants imageio-ffmpeg; remedy: {remedy}") from None
    return imageio_ffmpeg


def checked(frames: Iterable[Frame], counted: Iterator[int], even: bool) -> Iterator[Frame]:
    """The frames, each looked at."""
    shape: tuple[int, ...] = ()
    for frame in frames:
        wrong = frame.ndim != 3 or frame.shape[2] != 3 or frame.dtype != np.uint8
        if wrong or (shape and frame.shape != shape):
            expected = str(shape) if shape else "(height, width, 3)"
            raise ValueError(f"frame: {frame.dtype} {frame.shape}, expected uint8 {expected}")
        shape = frame.shape
        if even and (shape[0] % 2 or shape[1] % 2):
            raise ValueError(f"frame: {shape[1]} x {shape[0]} pixels, MP4 wants even numbers")
        next(counted)
        yield frame
    if not shape:
        raise ValueError("frames: there are none")


def write_gif(path: Path, frames: Iterator[Frame], seconds: float) -> None:
    """In the colors of the first frame and of robots, so that what stands still does not flicker.

    One color is left for what is as it was in the frame before, which makes the file small.
    """
    begin = Image.fromarray(next(frames))
    palette = Palette(begin, TEAM)
    rest = (palette.apply(Image.fromarray(frame)) for frame in frames)
    delay = round(1000 * seconds)
    first = palette.apply(begin)
    first.save(path, save_all=True, append_images=rest, duration=delay, loop=0, optimize=True)


def write_mp4(path: Path, frames: Iterator[Frame], seconds: float) -> None:
    """H.264 that browsers play."""
    first = next(frames)
    size = first.shape[1], first.shape[0]
    writer = encoder().write_frames(
        str(path), size, fps=1 / seconds, codec="libx264", macro_block_size=2, quality=7
    )
    with contextlib.closing(writer):
        writer.send(None)
        for frame in itertools.chain([first], frames):
            writer.send(np.ascontiguousarray(frame))

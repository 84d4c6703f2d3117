"""``fgenv render``: movies and pictures of a recorded episode, without a display."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.replay import Recorded
from fgenv.cli.scenarios import target

if TYPE_CHECKING:
    from fgenv.envs import Record

SMALLEST, LARGEST = 16, 4096  # pixels


def render(
    record: Recorded,
    gif: Annotated[Path | None, target("--gif", "Write a GIF.")] = None,
    mp4: Annotated[Path | None, target("--mp4", "Write an MP4 (H.264).")] = None,
    png: Annotated[Path | None, target("--png", "Write one picture.")] = None,
    at: Annotated[
        float | None,
        typer.Option("--at", min=0.0, help="Seconds of --png.", show_default="the end"),
    ] = None,
    camera: Annotated[
        str, typer.Option("--camera", help="overview, top, follow or orbit.")
    ] = "overview",
    robot: Annotated[
        str | None,
        typer.Option(
            "--robot",
            help="Whom follow follows; whose masks alone are drawn.",
            show_default="the first; all masks",
        ),
    ] = None,
    azimuth: Annotated[
        float | None,
        typer.Option("--azimuth", help="Degrees: where overview looks from; -90 is the south."),
    ] = None,
    elevation: Annotated[
        float | None,
        typer.Option("--elevation", help="Degrees: how high above the floor overview looks from."),
    ] = None,
    notes: Annotated[
        str,
        typer.Option(
            "--notes",
            help="What is drawn over it: time, trails, collisions, masks; none; with commas.",
        ),
    ] = "time,collisions",
    size: Annotated[str, typer.Option("--size", help="Pixels, WIDTHxHEIGHT.")] = "480x360",
    fps: Annotated[
        float | None,
        typer.Option(
            "--fps",
            min=0.1,
            max=100.0,
            help="Frames of a movie in a second, no more than there are steps.",
            show_default="25 at most",
        ),
    ] = None,
    speed: Annotated[
        float, typer.Option("--speed", min=0.1, max=100.0, help="Of a movie, times real time.")
    ] = 1.0,
) -> None:
    """Draw a recorded episode, or a plan, as a movie or as a picture.

    No display and no OpenGL are needed. top looks straight down, follow keeps
    to a robot, orbit goes around everything. Annotations: trails show where robots
    have been for four seconds; collisions rings contacts and says who meets
    whom; masks colors what bears the bit of a robot, by its motion of the next
    second, with a line from that robot.
    """
    from rich.console import Console

    from fgenv.cli.movie import MOST_FPS, draw
    from fgenv.view.episodes import load_episode
    from fgenv.view.figures.annotations import check_annotations
    from fgenv.view.figures.camera_path import CAMERAS
    from fgenv.view.figures.episode_frames import frames_of
    from fgenv.view.figures.movie import frame_seconds

    expected = targets(gif, mp4, png)
    if camera not in CAMERAS:
        raise ValueError(f"--camera: got {camera!r}, expected {', '.join(CAMERAS)}")
    if at is not None and png is None:
        raise ValueError("--at: is of a picture, expected with --png")
    drawn = [] if notes == "none" else [note.strip() for note in notes.split(",")]
    check_annotations(drawn)
    width, height = pixels(size)
    for path in (p for p in (gif, mp4) if p is not None):
        frame_seconds(path, fps or MOST_FPS)
    episode = load_episode(record)
    look: dict[str, Any] = {
        "camera": camera,
        "robot": place(episode, robot),
        "notes": drawn,
        "azimuth": radians(azimuth, "--azimuth", 360.0),
        "elevation": radians(elevation, "--elevation", 89.0),
    }
    if camera != "overview" and (azimuth, elevation) != (None, None):
        raise ValueError(f"--azimuth, --elevation: are of --camera overview, got {camera}")
    if png is not None:
        from PIL import Image

        step = len(episode) if at is None else min(len(episode), round(at / episode.dt))
        (frame,) = frames_of(episode, [step], width, height, **look)
        Image.fromarray(frame).save(png, optimize=True)
    for path in (p for p in (gif, mp4) if p is not None):
        draw(episode, path, fps, Console(highlight=False), (width, height), look, speed)
    for path in expected:
        typer.echo(f"written: {path}, {path.stat().st_size:,} bytes")


def targets(*files: Path | None) -> list[Path]:
    """The files to write; ValueError where there are none, or their names are wrong."""
    found = []
    for path, suffix in zip(files, (".gif", ".mp4", ".png"), strict=True):
        if path is None:
            continue
        if path.suffix != suffix:
            raise ValueError(f"--{suffix[1:]}: got {path}, expected a name that ends in {suffix}")
        if not path.parent.is_dir():
            raise ValueError(f"{path}: there is no folder {path.parent}; make it first")
        found.append(path)
    if not found:
        raise ValueError("nothing to write; expected --gif, --mp4 or --png")
    return found


def pixels(size: str) -> tuple[int, int]:
    """Width and height."""
    width, _, height = size.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise ValueError(f"--size: got {size!r}, expected WIDTHxHEIGHT, such as 640x480")
    if not all(SMALLEST <= int(n) <= LARGEST for n in (width, height)):
        raise ValueError(f"--size: got {size!r}, expected {SMALLEST} to {LARGEST} pixels each")
    return int(width), int(height)


def radians(degrees: float | None, option: str, most: float) -> float | None:
    """An angle in radians; ValueError beyond `most` degrees, or where an elevation is not up."""
    if degrees is None:
        return None
    least = 5.0 if option == "--elevation" else -most
    if not least <= degrees <= most:
        raise ValueError(f"{option}: got {degrees:g}, expected {least:g} to {most:g} degrees")
    return math.radians(degrees)


def place(record: Record, name: str | None) -> int | None:
    """Which robot has that name, if one is given."""
    if name is None:
        return None
    if name not in record.names:
        raise ValueError(f"--robot: got {name!r}, expected one of {', '.join(record.names)}")
    return record.names.index(name)

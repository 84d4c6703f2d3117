"""``fgenv render``: movies and pictures of a recorded episode, without a display."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.completion import cameras
from fgenv.cli.files import check_target, echo_written
from fgenv.cli.options import FPS_HELP, Recorded, choice_option, file_option, refuse_options
from fgenv.saving import atomic

if TYPE_CHECKING:
    from fgenv.envs import Record

MIN_PIXELS, MAX_PIXELS = 16, 4096

Gif = Annotated[Path | None, file_option("--gif", "Write a GIF.")]
Mp4 = Annotated[Path | None, file_option("--mp4", "Write an MP4 (H.264).")]
Png = Annotated[Path | None, file_option("--png", "Write one picture.")]
At = Annotated[
    float | None,
    typer.Option("--at", min=0.0, help="Time of --png in seconds.", show_default="the end"),
]
CameraKind = Annotated[
    str, choice_option("--camera", "Camera: overview, top, follow or orbit.", cameras)
]
RobotName = Annotated[
    str | None,
    typer.Option(
        "--robot",
        help="Robot that the camera follows; only its mask is drawn.",
        show_default="the first; all masks",
    ),
]
Azimuth = Annotated[
    float | None,
    typer.Option("--azimuth", help="Azimuth of the camera overview in degrees; -90: south."),
]
Elevation = Annotated[
    float | None,
    typer.Option("--elevation", help="Elevation of the camera overview in degrees."),
]
Notes = Annotated[
    str,
    typer.Option(
        "--notes", help="Annotations, with commas: time, trails, collisions, masks; or none."
    ),
]
PixelSize = Annotated[str, typer.Option("--size", help="Size in pixels, WIDTHxHEIGHT.")]
Fps = Annotated[
    float | None,
    typer.Option("--fps", min=0.1, max=100.0, help=FPS_HELP, show_default="25 at most"),
]
Speed = Annotated[
    float, typer.Option("--speed", min=0.1, max=100.0, help="Speed of a movie, times real time.")
]


def render(
    context: typer.Context,
    record: Recorded,
    gif: Gif = None,
    mp4: Mp4 = None,
    png: Png = None,
    at: At = None,
    camera: CameraKind = "overview",
    robot: RobotName = None,
    azimuth: Azimuth = None,
    elevation: Elevation = None,
    notes: Notes = "time,collisions",
    size: PixelSize = "480x360",
    fps: Fps = None,
    speed: Speed = 1.0,
) -> None:
    """Draw a recorded episode, or a plan, as a movie or as a picture.

    No display and no OpenGL are needed. top looks straight down, follow stays
    with a robot, orbit circles around the scene. Notes: trails show the paths
    of the last four seconds; collisions marks contacts and names both bodies;
    masks highlights the bodies in each robot's mask for the motion of its next
    second, and links them to the robot by a line.
    """
    from fgenv.cli.progress import MAX_FPS, write_episode_movie
    from fgenv.view.episodes import load_episode
    from fgenv.view.figures.annotations import check_annotations
    from fgenv.view.figures.movie import frame_seconds

    check_files(gif, mp4, png)
    check_camera(camera, azimuth, elevation)
    if png is None:
        refuse_options(context, ("at",), "is of a picture, expected with --png")
    if gif is None and mp4 is None:
        refuse_options(context, ("fps", "speed"), "is of a movie, expected with --gif or --mp4")
    names = [] if notes == "none" else [note.strip() for note in notes.split(",")]
    check_annotations(names)
    width, height = pixels(size)
    movies = [path for path in (gif, mp4) if path is not None]
    for path in movies:
        frame_seconds(path, fps or MAX_FPS)
    episode = load_episode(record)
    look: dict[str, Any] = {
        "camera": camera,
        "robot": robot_index(episode, robot),
        "notes": names,
        "azimuth": None if azimuth is None else math.radians(azimuth),
        "elevation": None if elevation is None else math.radians(elevation),
    }
    if png is not None:
        write_picture(episode, png, at, (width, height), look)
    for path in movies:
        write_episode_movie(episode, path, fps, (width, height), look, speed)
    echo_written(path for path in (gif, mp4, png) if path is not None)


def write_picture(
    episode: Record, path: Path, at: float | None, size: tuple[int, int], look: dict[str, Any]
) -> None:
    """Write the frame of a record at a time, or at its end."""
    from PIL import Image

    from fgenv.view.figures.episode_frames import frames_of

    end = len(episode) * episode.dt
    if at is not None and at > end + 0.5 * episode.dt:
        raise ValueError(f"--at: got {at:g} s, expected up to {end:g} s, the length of the record")
    step = len(episode) if at is None else min(len(episode), round(at / episode.dt))
    (frame,) = frames_of(episode, [step], *size, **look)
    with atomic(path) as partial:
        Image.fromarray(frame).save(partial, optimize=True)


def check_files(gif: Path | None, mp4: Path | None, png: Path | None) -> None:
    """Raise ValueError if there is no file to write, or one that cannot be written."""
    if gif is None and mp4 is None and png is None:
        raise ValueError("nothing to write; expected --gif, --mp4 or --png")
    check_target(gif, "--gif", ".gif")
    check_target(mp4, "--mp4", ".mp4")
    check_target(png, "--png", ".png")


def check_camera(camera: str, azimuth: float | None, elevation: float | None) -> None:
    """Raise ValueError for a direction that the camera does not have."""
    check_degrees(azimuth, "--azimuth", -360.0, 360.0)
    check_degrees(elevation, "--elevation", 5.0, 89.0)
    if camera != "overview" and (azimuth, elevation) != (None, None):
        raise ValueError(f"--azimuth, --elevation: are of --camera overview, got {camera}")


def check_degrees(degrees: float | None, option: str, least: float, most: float) -> None:
    """Raise ValueError if an angle is out of range."""
    if degrees is not None and not least <= degrees <= most:
        raise ValueError(f"{option}: got {degrees:g}, expected {least:g} to {most:g} degrees")


def pixels(size: str) -> tuple[int, int]:
    """Return width and height of a size."""
    width, _, height = size.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise ValueError(f"--size: got {size!r}, expected WIDTHxHEIGHT, such as 640x480")
    if not all(MIN_PIXELS <= int(n) <= MAX_PIXELS for n in (width, height)):
        expected = f"{MIN_PIXELS} to {MAX_PIXELS} pixels each"
        raise ValueError(f"--size: got {size!r}, expected {expected}")
    return int(width), int(height)


def robot_index(record: Record, name: str | None) -> int | None:
    """Return the index of the robot with a name, if one is given."""
    if name is None:
        return None
    if name not in record.names:
        raise ValueError(f"--robot: got {name!r}, expected one of {', '.join(record.names)}")
    return record.names.index(name)

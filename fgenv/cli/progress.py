"""Progress bars of long commands, and movies that are drawn with one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

    from fgenv.envs import Record

MAX_FPS = 25.0  # by default


def write_episode_movie(
    record: Record,
    path: Path,
    fps: float | None,
    console: Console,
    size: tuple[int, int] = (480, 360),
    look: dict[str, Any] | None = None,
    speed: float = 1.0,
) -> None:
    """Write the movie of a record at `speed` times real time.

    Args:
        look: further keyword arguments of `frames_of`.
    """
    from fgenv.view.figures.episode_frames import frames_of, steps_shown
    from fgenv.view.figures.movie import frame_seconds, write_movie

    seconds = frame_seconds(path, min(fps or MAX_FPS, speed / record.dt))
    steps = steps_shown(record, speed * seconds)
    with progress(console) as bar:
        task = bar.add_task("drawing", total=len(steps))
        frames = frames_of(record, steps, *size, **(look or {}))
        write_movie(path, bar.track(frames, task_id=task, total=len(steps)), 1 / seconds)


@contextmanager
def progress(console: Console) -> Iterator[Progress]:
    """Show a bar that disappears at the end; it is hidden unless the console is a terminal."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as Left

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), Left()
    hidden = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        yield bar

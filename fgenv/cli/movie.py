"""Drawing a record as a movie, with progress."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

    from fgenv.envs import Record

MOST_FPS = 25.0  # if not told


def draw(
    record: Record,
    path: Path,
    fps: float | None,
    console: Console,
    size: tuple[int, int] = (480, 360),
    look: dict[str, Any] | None = None,
    speed: float = 1.0,
) -> None:
    """The movie of a record, `speed` times real time; `look` is what `frames_of` takes beside."""
    from fgenv.view.figures.episode_frames import frames_of, steps_shown
    from fgenv.view.figures.movie import frame_seconds, write_movie

    seconds = frame_seconds(path, min(fps or MOST_FPS, speed / record.dt))
    steps = steps_shown(record, speed * seconds)
    with progress(console) as bar:
        task = bar.add_task("drawing", total=len(steps))
        frames = bar.track(
            frames_of(record, steps, *size, **(look or {})), task_id=task, total=len(steps)
        )
        write_movie(path, frames, 1 / seconds)


@contextmanager
def progress(console: Console) -> Iterator[Progress]:
    """A bar that is gone in the end, on stderr if stdout is for a machine."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as Left

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), Left()
    hidden = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        yield bar

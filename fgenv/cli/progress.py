"""Progress of long commands on stderr, and movies that are drawn with it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

from fgenv.cli.console import is_quiet

if TYPE_CHECKING:
    from rich.progress import Progress, ProgressColumn

    from fgenv.envs import Record

MAX_FPS = 25.0  # by default
INTERVAL = 10.0  # s between two lines of progress where stderr is no terminal


def write_episode_movie(
    record: Record,
    path: Path,
    fps: float | None,
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
    with progress() as bar:
        task = bar.add_task("drawing", total=len(steps))
        frames = frames_of(record, steps, *size, **(look or {}))
        write_movie(path, bar.track(frames, task_id=task, total=len(steps)), 1 / seconds)


@contextmanager
def progress() -> Iterator[Progress]:
    """Show bars on stderr: on a terminal until they end, else a line per `INTERVAL`."""
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn
    from rich.progress import TimeRemainingColumn as Left

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), Left()
    with shown_on_stderr(*columns) as bar:
        yield bar


@contextmanager
def status(text: str) -> Iterator[Callable[[str], None]]:
    """Show a text as `progress` does, and yield the function that replaces it."""
    from rich.progress import SpinnerColumn, TextColumn

    with shown_on_stderr(SpinnerColumn(), TextColumn("{task.description}")) as bar:
        task = bar.add_task(text, total=None)
        yield lambda text: bar.update(task, description=text)


@contextmanager
def shown_on_stderr(*columns: ProgressColumn) -> Iterator[Progress]:
    """Show tasks in these columns on a terminal, else as lines of text; nothing if quiet."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True, highlight=False)
    quiet = is_quiet()
    hidden = quiet or not console.is_terminal
    lines = hidden and not quiet
    # Output to the same terminal goes above the bar; output to a pipe must stay there.
    options: dict[str, Any] = {"transient": True, "redirect_stdout": sys.stdout.isatty()}
    bar = Progress(*columns, console=console, disable=hidden, **options)
    with bar, repeated(lambda: print_tasks(bar)) if lines else nullcontext():
        yield bar


def print_tasks(bar: Progress) -> None:
    """Print a line per unfinished task on stderr."""
    for task in bar.tasks:
        if task.total is not None and task.completed >= task.total:
            continue
        done = "" if task.total is None else f": {task.completed:g} of {task.total:g}"
        left = "" if task.time_remaining is None else f", {task.time_remaining:.0f} s left"
        print(f"{task.description}{done}{left}", file=sys.stderr, flush=True)


@contextmanager
def repeated(function: Callable[[], None]) -> Iterator[None]:
    """Call a function every `INTERVAL` in a thread."""
    ended = Event()

    def repeat() -> None:
        while not ended.wait(INTERVAL):
            function()

    thread = Thread(target=repeat, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()

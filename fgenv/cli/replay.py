"""``fgenv replay``: a recorded episode, or a plan, as a page that plays it."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from fgenv.cli.scenarios import target

Recorded = Annotated[
    Path,
    typer.Argument(
        metavar="RECORD", help="Of fgenv run --record, or a plan of fgenv plan --out (.npz)."
    ),
]


def replay(
    record: Recorded,
    html: Annotated[
        Path | None,
        target("--html", "The page to write.", None),
    ] = None,
    open_it: Annotated[
        bool, typer.Option("--open", help="Open the page in the browser there is.")
    ] = False,
) -> None:
    """Write a page that plays a recorded episode, or a plan.

    The page needs nothing else: it opens from disk, offline, in any browser
    with WebGL. It plays at 0.5 to 8 times real time and scrubs; each collision
    has a mark on the time line that leads there. Space plays and pauses, the
    arrow keys step, N and P go to the next and previous collision. Without
    --html it is written beside the record, under its name.
    """
    from rich.console import Console

    from fgenv.cli.movie import progress
    from fgenv.view.episodes import load_episode
    from fgenv.view.web.replay import write_replay
    from fgenv.view.web.server import viser_module

    viser_module()
    path = record.with_suffix(".html") if html is None else html
    if path.suffix not in (".html", ".htm"):
        raise ValueError(f"--html: got {path}, expected a name that ends in .html")
    if not path.parent.is_dir():
        raise ValueError(f"--html: {path}: there is no folder {path.parent}; make it first")
    episode = load_episode(record)
    with progress(Console(highlight=False)) as bar:
        task = bar.add_task("writing", total=None)
        size = write_replay(
            path, episode, lambda done, all_: bar.update(task, completed=done, total=all_)
        )
    typer.echo(f"written: {path}, {size:,} bytes")
    if open_it and not webbrowser.open(path.resolve().as_uri()):
        typer.echo("no browser was found; open it yourself")

"""``fgenv replay``: a page that plays a recorded episode or a plan."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fgenv.cli.files import check_target
from fgenv.cli.options import OpenBrowser, Recorded, file_option

Html = Annotated[Path | None, file_option("--html", "Write the page to this file.")]


def replay(record: Recorded, html: Html = None, open_it: OpenBrowser = False) -> None:
    """Write a page that plays a recorded episode, or a plan.

    The page is self-contained: it opens from disk, offline, in any browser
    with WebGL. It plays at 0.5 to 8 times real time and scrubs; each contact
    event has a mark on the time line, with a link to its time. Space plays and
    pauses, the arrow keys step, N and P go to the next and previous event.
    Without --html the page is written beside the record, under its name.
    """
    from fgenv.cli.progress import progress
    from fgenv.cli.view import open_page
    from fgenv.view.episodes import load_episode
    from fgenv.view.web.replay import write_replay
    from fgenv.view.web.server import viser_module

    viser_module()
    path = record.with_suffix(".html") if html is None else html
    check_target(path, "--html", ".html", ".htm")
    episode = load_episode(record)
    with progress() as bar:
        task = bar.add_task("writing", total=None)
        size = write_replay(
            path, episode, lambda done, total: bar.update(task, completed=done, total=total)
        )
    typer.echo(f"written: {path}, {size:,} bytes")
    if open_it:
        open_page(path.resolve().as_uri())

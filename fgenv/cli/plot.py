"""``fgenv plot``: a plot of a recorded episode, or of a training."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def kinds(incomplete: str) -> list[str]:
    """Kinds of plots, for tab completion."""
    return [k for k in ("clearance", "masks", "space-time", "learning") if k.startswith(incomplete)]


def plot(
    record: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="Of fgenv run --record, a plan of fgenv plan --out (.npz), or the"
            " evaluations.csv of fgenv train.",
        ),
    ],
    kind: Annotated[
        str,
        typer.Option(
            "--kind", help="clearance, masks, space-time or learning.", autocompletion=kinds
        ),
    ],
    out: Annotated[
        Path, typer.Option("--out", dir_okay=False, help="The plot (.png, .svg, .pdf).")
    ],
) -> None:
    """Plot a recorded episode, or a plan, over time; or how a training went.

    clearance: each robot's distance to whatever is nearest (measured now where
    the record has none), and when contacts begin. masks: how many bodies each
    robot's mask leaves to be tested, by its motion of the next second.
    space-time: where each robot is along the longest way of all; in a corridor,
    who waits and who passes. learning: shares of success and collisions over
    the steps of a training.
    """
    from fgenv.view.episodes import load_episode
    from fgenv.view.figures.learning_curves import plot_learning_curves
    from fgenv.view.figures.record_plots import plot_record

    if not out.parent.is_dir():
        raise ValueError(f"--out: {out}: there is no folder {out.parent}; make it first")
    if kind == "learning":
        plot_learning_curves(record, out)
    else:
        plot_record(load_episode(record), kind, out)
    typer.echo(f"written: {out}, {out.stat().st_size:,} bytes")

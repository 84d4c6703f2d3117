"""``fgenv plot``: a plot of a recorded episode, or of a training."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fgenv.cli.completion import plot_kinds
from fgenv.cli.files import echo_written
from fgenv.cli.options import PLOT_SUFFIXES, choice_option, file_option

Source = Annotated[
    Path,
    typer.Argument(
        metavar="FILE",
        help="Record of fgenv run --record, plan of fgenv plan --out (.npz), or evaluations.csv"
        " of fgenv train.",
    ),
]
Kind = Annotated[
    str,
    choice_option("--kind", "Kind of plot: clearance, masks, space-time or learning.", plot_kinds),
]
Out = Annotated[Path, file_option("--out", f"Write the plot to this file {PLOT_SUFFIXES}.")]


def plot(source: Source, kind: Kind, out: Out) -> None:
    """Plot a recorded episode or a plan over time, or the progress of a training.

    clearance: each robot's distance to the nearest body (computed if the
    record has none), and the beginnings of contacts. masks: number of bodies
    in each robot's mask for the motion of its next second. space-time: the
    position of each robot along the axis of the longest travel, which shows
    waiting and passing robots in a corridor. learning: shares of success and
    collisions over the steps of a training.
    """
    from fgenv.view.episodes import load_episode
    from fgenv.view.figures.canvas import check_plot_path
    from fgenv.view.figures.learning_curves import plot_learning_curves
    from fgenv.view.figures.record_plots import plot_record

    check_plot_path(out, "--out")
    if kind == "learning":
        plot_learning_curves(source, out)
    else:
        plot_record(load_episode(source), kind, out)
    echo_written([out])

"""Learning curves from the evaluations.csv of a training."""

from __future__ import annotations

import csv
from pathlib import Path

from fgenv.regular_file import read_regular
from fgenv.view.figures.canvas import check_plot_path, legend_beside, new_figure, save_figure
from fgenv.view.figures.palette import BLUE, GREEN, VERMILION

MAX_BYTES = 1 << 28
CURVES = {  # column: label, color, line
    "success": ("success, of episodes", BLUE, "-"),
    "robot_success": ("success, of robots", GREEN, "--"),
    "collision": ("ran into something, of robots", VERMILION, ":"),
}


def evaluations(path: str | Path) -> dict[str, list[float]]:
    """Return the columns of an evaluations.csv.

    Raises:
        ValueError: the file is of another kind, or has no rows yet.
    """
    content = read_regular(Path(path), "the evaluations.csv that fgenv train writes", MAX_BYTES)
    reader = csv.DictReader(content.decode("utf-8", "replace").splitlines())
    try:
        if not {"steps", *CURVES} <= set(reader.fieldnames or ()):
            raise ValueError(f"{path}: expected the evaluations.csv that fgenv train writes")
        rows = [{name: float(row[name]) for name in ("steps", *CURVES)} for row in reader]
    except (TypeError, ValueError, csv.Error) as error:
        if str(error).startswith(str(path)):
            raise
        raise ValueError(f"{path}: line {reader.line_num} is not of numbers") from None
    if not rows:
        raise ValueError(f"{path}: it has no evaluations yet")
    return {name: [row[name] for row in rows] for name in rows[0]}


def plot_learning_curves(source: str | Path, path: str | Path) -> None:
    """Plot the shares of success and collisions over the robot steps of a training."""
    path, columns = check_plot_path(path), evaluations(source)
    figure = new_figure(7.2, 4.2)
    axes = figure.add_subplot()
    for name, (label, color, line) in CURVES.items():
        axes.plot(columns["steps"], columns[name], line, color=color, marker="o", ms=4, label=label)
    axes.set(xlabel="steps of robots", ylabel="share", ylim=(-0.02, 1.02))
    axes.grid(color="0.92")
    axes.spines[["top", "right"]].set_visible(False)
    legend_beside(axes)
    save_figure(figure, path)

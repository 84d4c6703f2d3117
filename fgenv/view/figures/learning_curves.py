"""Learning curves: what a training wrote into its evaluations.csv."""

from __future__ import annotations

import csv
from pathlib import Path

from fgenv.view.figures.canvas import blank, checked, write
from fgenv.view.figures.palette import BLUE, GREEN, VERMILION

SHOWN = {  # column: label, color, line
    "success": ("success, of episodes", BLUE, "-"),
    "robot_success": ("success, of robots", GREEN, "--"),
    "collision": ("ran into something, of robots", VERMILION, ":"),
}


def evaluations(path: str | Path) -> dict[str, list[float]]:
    """The columns of an evaluations.csv.

    Raises:
        ValueError: it is none, or has no rows yet.
    """
    with Path(path).open(newline="", encoding="utf-8", errors="replace") as file:
        reader = csv.DictReader(file)
        if not {"steps", *SHOWN} <= set(reader.fieldnames or ()):
            raise ValueError(f"{path}: expected the evaluations.csv that fgenv train writes")
        try:
            rows = [{name: float(row[name]) for name in ("steps", *SHOWN)} for row in reader]
        except (TypeError, ValueError):
            raise ValueError(f"{path}: line {reader.line_num} is not of numbers") from None
    if not rows:
        raise ValueError(f"{path}: it has no evaluations yet")
    return {name: [row[name] for row in rows] for name in rows[0]}


def learning(source: str | Path, path: str | Path) -> None:
    """Draw the shares of success and collisions over the steps of robots so far."""
    path, found = checked(path), evaluations(source)
    figure = blank(7.2, 4.2)
    axes = figure.add_subplot()
    for name, (label, color, line) in SHOWN.items():
        axes.plot(found["steps"], found[name], line, color=color, marker="o", ms=4, label=label)
    axes.set(xlabel="steps of robots", ylabel="share", ylim=(-0.02, 1.02))
    axes.grid(color="0.92")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    write(figure, path)

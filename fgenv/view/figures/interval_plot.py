"""Shares with their intervals: a row for each set, a colored point for each method."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from fgenv.confidence import Estimate
from fgenv.view.figures.bars import COLORS
from fgenv.view.figures.canvas import blank, checked, write

Shares = Mapping[str, Mapping[str, Estimate]]  # row, method: a share of 1


def draw(shares: Shares, label: str, path: str | Path) -> None:
    """A point and its 95 % interval for each method in each row.

    Raises:
        ValueError: nothing to draw, or a wrong path.
        ImportError: Matplotlib is missing, with the remedy.
    """
    path = checked(path, "--plot")
    if not shares:
        raise ValueError("--plot: nothing was measured, so there is nothing to draw")
    methods = list(dict.fromkeys(method for row in shares.values() for method in row))
    figure = blank(8.0, 1.2 + 0.3 * len(shares))
    axes = figure.add_subplot()
    for j, method in enumerate(methods):
        at = [(k, row[method]) for k, row in enumerate(shares.values()) if method in row]
        values = [x.value for _, x in at]
        ends = [[x.value - x.low for _, x in at], [x.high - x.value for _, x in at]]
        places = [k + 0.5 * ((j + 0.5) / len(methods) - 0.5) for k, _ in at]
        color = COLORS[j % len(COLORS)]
        axes.errorbar(values, places, xerr=ends, fmt="o", ms=4, color=color, label=method)
    axes.set_yticks(range(len(shares)), list(shares))
    axes.set_ylim(len(shares) - 0.5, -0.5)
    axes.set_xlim(-0.02, 1.02)
    axes.set_xlabel(label)
    axes.grid(axis="x", color="0.92")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    write(figure, path)

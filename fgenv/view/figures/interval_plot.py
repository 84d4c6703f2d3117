"""Estimates with their 95 % intervals: shares by set and method, scores by policy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from fgenv.agents.evaluation.scores import Score
from fgenv.confidence import Estimate
from fgenv.view.figures.bars import COLORS
from fgenv.view.figures.canvas import check_plot_path, legend_beside, new_figure, save_figure

Shares = Mapping[str, Mapping[str, Estimate]]  # by row and method: a share of 1
SCORES = {  # attribute of a score: label
    "success": "success, of episodes",
    "robot_collision": "ran into a robot, of robots",
    "extra_time": "extra time, s",
}


def plot_shares(shares: Shares, label: str, path: str | Path) -> None:
    """Write a plot with a point and its interval for each method in each row.

    Raises:
        ValueError: no shares, or a wrong path.
        ImportError: Matplotlib is missing, with the remedy.
    """
    path = check_plot_path(path, "--plot")
    if not shares:
        raise ValueError("--plot: nothing was measured, so there is nothing to draw")
    methods = list(dict.fromkeys(method for row in shares.values() for method in row))
    figure = new_figure(8.0, 1.2 + 0.3 * len(shares))
    axes = figure.add_subplot()
    for j, method in enumerate(methods):
        rows = [(k, row[method]) for k, row in enumerate(shares.values()) if method in row]
        estimates = [x for _, x in rows]
        places = [k + 0.5 * ((j + 0.5) / len(methods) - 0.5) for k, _ in rows]
        color, values = COLORS[j % len(COLORS)], [x.value for x in estimates]
        bars = interval_bars(estimates)
        axes.errorbar(values, places, xerr=bars, fmt="o", ms=4, color=color, label=method)
    axes.set_yticks(range(len(shares)), list(shares))
    axes.set_ylim(len(shares) - 0.5, -0.5)
    axes.set_xlim(-0.02, 1.02)
    axes.set_xlabel(label)
    axes.grid(axis="x", color="0.92")
    axes.spines[["top", "right"]].set_visible(False)
    legend_beside(axes)
    save_figure(figure, path)


def plot_scores(scores: Mapping[str, Score], title: str, path: Path) -> None:
    """Write a plot of success, collisions and extra time of each policy."""
    figure = new_figure(9, 1.2 + 0.4 * len(scores))
    columns = figure.subplots(1, len(SCORES), sharey=True)
    for axes, (key, label) in zip(columns, SCORES.items(), strict=True):
        estimates = [getattr(score, key) for score in scores.values()]
        values, bars = [x.value for x in estimates], interval_bars(estimates)
        axes.barh(list(scores), values, xerr=bars, capsize=3, color="#4a7fb5")
        axes.set_xlabel(label)
        axes.grid(visible=True, axis="x", alpha=0.3)
    columns[0].invert_yaxis()
    columns[0].set_xlim(0, 1)
    figure.suptitle(title, fontsize="small")
    save_figure(figure, path)


def interval_bars(estimates: Sequence[Estimate]) -> list[list[float]]:
    """Return the lengths of intervals below and above their values, as Matplotlib expects them."""
    return [[x.value - x.low for x in estimates], [x.high - x.value for x in estimates]]

"""Scores of policies as a plot."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from fgenv.agents.evaluation.scores import Score

SHOWN = {
    "success": "success, of episodes",
    "robot_collision": "ran into a robot, of robots",
    "extra_time": "extra time, s",
}


def draw(scores: Mapping[str, Score], title: str, path: Path) -> None:
    """Success, collisions and extra time of each policy, with 95 % intervals, to a file."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 1.2 + 0.4 * len(scores)), layout="constrained")
    axes = figure.subplots(1, len(SHOWN), sharey=True)
    for ax, (key, label) in zip(axes, SHOWN.items(), strict=True):
        found = [getattr(score, key) for score in scores.values()]
        ends = [[x.value - x.low for x in found], [x.high - x.value for x in found]]
        ax.barh(list(scores), [x.value for x in found], xerr=ends, capsize=3, color="#4a7fb5")
        ax.set_xlabel(label)
        ax.grid(visible=True, axis="x", alpha=0.3)
    axes[0].invert_yaxis()
    axes[0].set_xlim(0, 1)
    figure.suptitle(title, fontsize="small")
    figure.savefig(path)

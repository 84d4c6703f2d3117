"""How many times faster than its peers something is, as bars on a logarithmic axis."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fgenv.view.figures.canvas import blank, checked, write
from fgenv.view.figures.palette import BLUE, GREEN, INK, ORANGE, PURPLE, SKY, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Times = Mapping[str, Mapping[str, float]]  # row, peer: how many times faster than that peer
GAP = 0.6  # bars between two rows
COLORS = (BLUE, ORANGE, GREEN, PURPLE, VERMILION, SKY)


def draw(times: Times, title: str, path: str | Path) -> None:
    """A group of bars for each row, a color for each peer, a line where both are as fast.

    Raises:
        ValueError: nothing to compare with, a ratio that is none, or a wrong path.
        ImportError: Matplotlib is missing, with the remedy.
    """
    path = checked(path, "--plot")
    rows = {row: found for row, found in times.items() if found}
    if not rows:
        raise ValueError("--plot: no other library took part, so there is nothing to compare with")
    for row, found in rows.items():
        for peer, ratio in found.items():
            if not (np.isfinite(ratio) and ratio > 0):
                raise ValueError(f"times[{row!r}][{peer!r}]: got {ratio}, expected a number over 0")
    figure = blank(8.0, 1.4 + 0.19 * sum(map(len, rows.values())) + 0.12 * len(rows))
    axes = figure.add_subplot()
    fill(axes, rows)
    axes.set_title(title, loc="left")
    write(figure, path)


def fill(axes: Axes, rows: Times) -> None:
    """The bars, from 1 on: what is slower goes to the left."""
    from matplotlib.ticker import LogLocator, NullFormatter

    peers = list(dict.fromkeys(peer for found in rows.values() for peer in found))
    begins = np.cumsum([0.0, *(len(found) + GAP for found in rows.values())])
    for j, peer in enumerate(peers):
        at = [
            (begin + list(found).index(peer), found[peer])
            for begin, found in zip(begins, rows.values(), strict=False)
            if peer in found
        ]
        places, ratios = ([float(x) for x in row] for row in zip(*at, strict=True))
        lengths, color = [ratio - 1.0 for ratio in ratios], COLORS[j % len(COLORS)]
        bar = axes.barh(places, lengths, 0.86, left=1.0, color=color, label=peer)
        axes.bar_label(bar, [number(r) for r in ratios], fontsize=7, padding=3, color=INK)
    every = [ratio for found in rows.values() for ratio in found.values()]
    axes.axvline(1.0, color=INK, lw=1.2)
    axes.set_xscale("log")
    axes.set_xlim(min(0.8, 0.6 * min(every)), max(1.25, 1.6 * max(every)))
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    middles = begins[:-1] + [(len(found) - 1) / 2 for found in rows.values()]
    axes.set_yticks(middles, list(rows))
    axes.set_ylim(begins[-1] - GAP, -1.0)
    axes.set_xlabel("times faster than each; 1: as fast")
    axes.grid(axis="x", color="0.92")
    axes.set_axisbelow(True)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def number(ratio: float) -> str:
    """Three digits."""
    return f"{ratio:,.0f}" if ratio >= 100 else f"{ratio:.3g}"

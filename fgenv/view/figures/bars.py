"""Bars on a logarithmic axis: how many times faster something is than each of its peers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fgenv.view.figures.canvas import check_plot_path, legend_beside, new_figure, save_figure
from fgenv.view.figures.palette import BLUE, GREEN, INK, ORANGE, PURPLE, SKY, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Ratios = Mapping[str, Mapping[str, float]]  # by row and peer: how many times faster
GAP = 0.6  # bars between two rows
COLORS = (BLUE, ORANGE, GREEN, PURPLE, VERMILION, SKY)


def plot_ratios(ratios: Ratios, title: str, path: str | Path) -> None:
    """Write a plot with a group of bars per row, a color per peer, and a line at ratio 1.

    Raises:
        ValueError: no peers, an invalid ratio, or a wrong path.
        ImportError: Matplotlib is missing, with the remedy.
    """
    path = check_plot_path(path, "--plot")
    rows = {row: by_peer for row, by_peer in ratios.items() if by_peer}
    if not rows:
        raise ValueError("--plot: no other library took part, so there is nothing to compare with")
    for row, by_peer in rows.items():
        for peer, ratio in by_peer.items():
            if not (np.isfinite(ratio) and ratio > 0):
                name = f"ratios[{row!r}][{peer!r}]"
                raise ValueError(f"{name}: got {ratio}, expected a number over 0")
    figure = new_figure(8.0, 1.4 + 0.19 * sum(map(len, rows.values())) + 0.12 * len(rows))
    axes = figure.add_subplot()
    draw_bars(axes, rows)
    style_axes(axes, rows)
    axes.set_title(title, loc="left")
    save_figure(figure, path)


def group_starts(rows: Ratios) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return the position of each row's first bar, and the end of the last row."""
    return np.cumsum([0.0, *(len(by_peer) + GAP for by_peer in rows.values())])


def draw_bars(axes: Axes, rows: Ratios) -> None:
    """Draw the bars from 1 on; ratios below 1 go to the left."""
    peers = list(dict.fromkeys(peer for by_peer in rows.values() for peer in by_peer))
    starts = group_starts(rows)
    for j, peer in enumerate(peers):
        bars = [
            (float(start + list(by_peer).index(peer)), float(by_peer[peer]))
            for start, by_peer in zip(starts, rows.values(), strict=False)
            if peer in by_peer
        ]
        places, ratios = zip(*bars, strict=True)
        lengths, color = [ratio - 1.0 for ratio in ratios], COLORS[j % len(COLORS)]
        drawn = axes.barh(places, lengths, 0.86, left=1.0, color=color, label=peer)
        axes.bar_label(drawn, [three_digits(r) for r in ratios], fontsize=7, padding=3, color=INK)


def style_axes(axes: Axes, rows: Ratios) -> None:
    """Set scale, ticks, labels and legend."""
    from matplotlib.ticker import LogLocator, NullFormatter

    ratios = [ratio for by_peer in rows.values() for ratio in by_peer.values()]
    axes.axvline(1.0, color=INK, lw=1.2)
    axes.set_xscale("log")
    axes.set_xlim(min(0.8, 0.6 * min(ratios)), max(1.25, 1.6 * max(ratios)))
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    starts = group_starts(rows)
    middles = starts[:-1] + [(len(by_peer) - 1) / 2 for by_peer in rows.values()]
    axes.set_yticks(middles, list(rows))
    axes.set_ylim(starts[-1] - GAP, -1.0)
    axes.set_xlabel("times faster than each; 1: as fast")
    axes.grid(axis="x", color="0.92")
    axes.set_axisbelow(True)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    legend_beside(axes)


def three_digits(ratio: float) -> str:
    """Format a ratio with three digits."""
    return f"{ratio:,.0f}" if ratio >= 100 else f"{ratio:.3g}"

"""Matplotlib figures without a display: creation, target paths, files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fgenv.saving import atomic

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".svg", ".pdf")


def check_plot_path(path: str | Path, option: str = "plot") -> Path:
    """Return the path of a plot to write; raise ValueError if its suffix or folder is wrong."""
    path = Path(path)
    if path.suffix not in SUFFIXES:
        expected = f"a name that ends in {', '.join(SUFFIXES)}"
        raise ValueError(f"{option}: got {path}, expected {expected}")
    if not path.parent.is_dir():
        raise ValueError(f"{option}: {path}: there is no folder {path.parent}; make it first")
    return path


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of a size in inches, without a display."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def legend_beside(axes: Axes) -> None:
    """Add a legend at the right of the plot."""
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def save_figure(figure: Figure, path: Path) -> None:
    """Write a figure to a file, with the same bytes at any time."""
    metadata = {} if path.suffix == ".png" else {"Date": None}
    with atomic(path) as partial:
        figure.savefig(partial, dpi=150, metadata=metadata)

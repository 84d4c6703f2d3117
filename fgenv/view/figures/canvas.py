"""What all plots by Matplotlib share: formats, a figure without a display, the file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".svg", ".pdf")


def checked(path: str | Path, option: str = "plot") -> Path:
    """The path of a plot to write; ValueError where its format or its folder is none."""
    path = Path(path)
    if path.suffix not in SUFFIXES:
        raise ValueError(
            f"{option}: got {path}, expected a name that ends in {', '.join(SUFFIXES)}"
        )
    if not path.parent.is_dir():
        raise ValueError(f"{option}: {path}: there is no folder {path.parent}; make it first")
    return path


def blank(width: float, height: float) -> Figure:
    """A figure of that size in inches, which needs no display."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def write(figure: Figure, path: Path) -> None:
    """To a file, the same bytes whenever it is written."""
    figure.savefig(path, dpi=150, metadata={} if path.suffix == ".png" else {"Date": None})

"""Tables of `fgenv bench files`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rich.table import Table

from fgenv.bench.common.records import Record
from fgenv.bench.common.tables import Columns, count, table, text

from .readers import PEERS

NOTES = {
    "meshes": "Each file by content once; agreement of extents, area and volume. confirmed: at"
    " least one independent reader agrees. unexplained: differences without a reason.",
    "loading": "CPU seconds, median of alternating rounds; peak memory of a process in MB. fgenv"
    " reads and builds a Shape, trimesh merges vertices, the others only read. ratio: to trimesh.",
    "robots": "Each file by content once, at random configurations. agrees: with pinocchio in the"
    " poses of all links to 1e-9, and in the boxes of the meshes to 1e-5 of their size where"
    " pinocchio finds them.",
    "mjcf": "Each file by content once, at random configurations. agrees: with MuJoCo in the poses"
    " of all bodies and of all geoms that collide, to 1e-9.",
}


def table_of(part: str, rows: Iterable[Record]) -> Table:
    """Return the table of a part."""
    return {"meshes": meshes, "loading": loading, "robots": robots, "mjcf": mjcf}[part](list(rows))


def meshes(rows: list[Record]) -> Table:
    """Counts by format."""
    columns: Columns = {
        "format": ("format", text),
        "files": ("files", count),
        "read": ("read", count),
        "confirmed": ("confirmed", count),
        **{f"{name} agrees": (f"peers.{name}.agrees", count) for name in PEERS},
        "unexplained": (lambda row: len(row["unexplained"]), count),
        "seconds": ("seconds.fgenv", seconds),
    }
    return table("Mesh files of pip packages", columns, rows)


def loading(rows: list[Record]) -> Table:
    """Load times by size."""
    names = list(rows[0]["peers"])
    columns: Columns = {
        "triangles": ("triangles", count),
        **{f"{name} s": (f"peers.{name}.seconds", seconds) for name in names},
        **{f"{name} MB": (f"peers.{name}.peak_mb", whole) for name in names},
        "ratio": ("ratio", seconds),
    }
    return table("Loading binary STL", columns, rows)


def robots(rows: list[Record]) -> Table:
    """Counts by result."""
    columns: Columns = {
        "result": ("result", text),
        "files": ("files", count),
        "largest difference": ("difference", scientific),
    }
    return table("URDF files of pip packages", columns, rows)


def mjcf(rows: list[Record]) -> Table:
    """Counts by result."""
    found = robots(rows)
    found.title = "MJCF files of pip packages"
    return found


def seconds(value: Any) -> str:
    """Format seconds or a ratio."""
    return f"{value:.2f}"


def whole(value: Any) -> str:
    """Format a number without decimals."""
    return f"{value:.0f}"


def scientific(value: Any) -> str:
    """Format a small number; none: empty."""
    return "" if value is None else f"{value:.1e}"

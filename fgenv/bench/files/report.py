"""Tables of `fgenv bench files`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rich.table import Table

from fgenv.bench.common.records import Record
from fgenv.bench.common.tables import Columns, count, table, text

from .readers import PEERS

NOTES = {
    "meshes": "Each file by content once. assimp, meshio, trimesh: files in which extents, area and"
    " volume agree with theirs. confirmed: in at least one of them. unexplained: differences"
    " without a reason.",
    "loading": "CPU seconds, median of alternating rounds; peak memory of a process in MB. fgenv"
    " reads and builds a Shape, trimesh merges vertices, the others only read. ratio: to trimesh.",
    "robots": "Each file by content once, at random configurations. agrees: with pinocchio in the"
    " poses of all links to 1e-9, and in the boxes of the meshes to 1e-5 of their size where"
    " pinocchio finds them. difference: the largest of a pose.",
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
        **{name: (f"peers.{name}.agrees", count) for name in PEERS},
        "unexplained": (lambda row: len(row["unexplained"]), count),
        "seconds": ("seconds.fgenv", seconds),
    }
    return table("Mesh files of pip packages", columns, rows)


def loading(rows: list[Record]) -> Table:
    """Load times by size and reader."""
    columns: Columns = {
        "triangles": ("triangles", count),
        "reader": ("reader", text),
        "seconds": ("seconds", seconds),
        "peak MB": ("peak_mb", whole),
        "ratio": ("ratio", seconds),
    }
    lines = [
        {
            "triangles": row["triangles"],
            "reader": name,
            **peer,
            "ratio": peer["seconds"] / row["peers"]["trimesh"]["seconds"],
        }
        for row in rows
        for name, peer in row["peers"].items()
    ]
    return table("Loading binary STL", columns, lines)


def robots(rows: list[Record], title: str = "URDF files of pip packages") -> Table:
    """Counts by result."""
    columns: Columns = {
        "files": ("files", count),
        "difference": ("difference", scientific),
        "result": ("result", text),
    }
    return table(title, columns, rows)


def mjcf(rows: list[Record]) -> Table:
    """Counts by result."""
    return robots(rows, "MJCF files of pip packages")


def seconds(value: Any) -> str:
    """Format seconds or a ratio."""
    return f"{value:.2f}"


def whole(value: Any) -> str:
    """Format a number without decimals."""
    return f"{value:.0f}"


def scientific(value: Any) -> str:
    """Format a small number."""
    return f"{value:.1e}"

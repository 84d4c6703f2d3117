"""The records of ``fgenv bench pairs`` as a table and as a plot."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.table import Table

from fgenv.bench.pairs.race import Record

# column title -> key of record["ratio"]; `build` is a share (under 1 is faster)
RATIOS = {
    "batch": "mean",
    "free": "free",
    "hit": "hit",
    "call": "call",
    "p99": "p99",
    "dist": "distance",
    "build": "build",
}
NOTE = (
    "batch, free, hit: µs of CPU a query, NumPy poses in one batch, one thread; call, p99: pose by "
    "pose; dist: µs a distance of free poses; build: ms of CPU for both meshes; differ: verdicts "
    "unlike python-fcl's (only fgenv sees a body inside another); (h) answers about hulls, "
    "(f) in single precision."
)


def peer_table(record: Record) -> Table:
    """Microseconds of every library on one pair."""
    a, b = record["triangles"]
    hits = f"{100 * record['hit_share']:.0f} % hits"
    table = _table(f"{record['pair']}: {a} and {b} triangles, {hits}")
    table.add_column("", no_wrap=True)
    for column in ("batch", "free", "hit", "call", "p99", "dist", "build", "B/tri", "differ"):
        table.add_column(column, justify="right", no_wrap=True)
    for name, found in record["peers"].items():
        batch, call = found["batch"], found["call"]
        table.add_row(
            name + {"meshes": "", "hulls": " (h)"}.get(found["truth"], " (f)"),
            *(_number(batch.get(kind), 1e6) for kind in ("mean", "free", "hit")),
            _number(call["mean"], 1e6),
            _number(call["p99"], 1e6),
            _number(found.get("distance"), 1e6),
            _number(found.get("build"), 1e3),
            _number(found.get("bytes_per_triangle"), 1.0),
            str(found["differ"]),
        )
    return table


def ratio_table(records: Sequence[Record], summary: dict[str, dict[str, float]]) -> Table:
    """How many times fgenv is faster than python-fcl, pair by pair."""
    table = _table("Times faster than python-fcl (build: its time as a share)")
    table.add_column("pair", no_wrap=True)
    table.add_column("triangles", justify="right", no_wrap=True)
    for title in (*RATIOS, "2thr", "B/tri"):
        table.add_column(title, justify="right", no_wrap=True)
    for record in records:
        own = record["peers"]["fgenv"]
        table.add_row(
            record["pair"],
            "/".join(_thousands(count) for count in record["triangles"]),
            *(_times(record["ratio"].get(key)) for key in RATIOS.values()),
            _times(record.get("threads_2")),
            _number(own.get("bytes_per_triangle"), 1.0),
        )
    for which, title in (("mean", "geometric mean"), ("worst", "worst")):
        values = [summary.get(key, {}).get(which) for key in RATIOS.values()]
        table.add_row(title, "", *(_times(value) for value in values), "", "", style="bold")
    return table


def _table(title: str) -> Table:
    return Table(title=title, box=None, padding=(0, 0, 0, 1), pad_edge=False, title_style="bold")


def _number(value: float | None, unit: float) -> str:
    """Three digits, or a dash for a missing value."""
    if value is None:
        return "-"
    shown = value * unit
    return f"{shown:.0f}" if shown >= 100 else f"{shown:.3g}"


def _times(value: float | None) -> str:
    """Two digits: timings on a busy machine have no more."""
    if value is None:
        return "-"
    return f"{value:.1f}" if value >= 1 else f"{value:.2f}"


def _thousands(count: int) -> str:
    return str(count) if count < 1000 else f"{count / 1000:.{1 if count < 10_000 else 0}f}k"


def plot_times(records: Sequence[Record], path: Path) -> None:
    """Draw microseconds a query over triangles, one line a library, to `path`."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 4.5), layout="constrained")
    axes = figure.subplots()
    ordered = sorted(records, key=lambda record: sum(record["triangles"]))
    for name in dict.fromkeys(name for record in ordered for name in record["peers"]):
        having = [record for record in ordered if name in record["peers"]]
        sizes = [sum(record["triangles"]) for record in having]
        micros = [1e6 * record["peers"][name]["batch"]["mean"] for record in having]
        axes.plot(np.array(sizes), np.array(micros), marker="o", label=name)
    axes.set(xscale="log", yscale="log", xlabel="triangles of both meshes", ylabel="µs a query")
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()
    figure.savefig(path)

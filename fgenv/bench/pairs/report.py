"""The records of ``fgenv bench pairs`` as tables and as a plot."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.table import Table

from fgenv.bench.common.records import Record
from fgenv.bench.common.tables import Columns, fixed, micros, millis, number, ratio, table, text
from fgenv.view.figures.canvas import new_figure, save_figure

SUFFIXES = {"meshes": "", "hulls": " (h)"}  # of names, by the subject of the verdicts
PEER_COLUMNS: Columns = {
    "": ("name", text),
    "batch": ("batch.mean", micros),
    "free": ("batch.free", micros),
    "hit": ("batch.hit", micros),
    "call": ("call.mean", micros),
    "p99": ("call.p99", micros),
    "dist": ("distance", micros),
    "build": ("build", millis),
    "B/tri": ("bytes_per_triangle", number()),
    "differ": ("differ", fixed(0)),
}
RATIO_COLUMNS: Columns = {
    "pair": ("pair", text),
    "triangles": ("triangles", lambda counts: "/".join(map(_thousands, counts))),
    "batch": ("ratio.mean", ratio),
    "free": ("ratio.free", ratio),
    "hit": ("ratio.hit", ratio),
    "call": ("ratio.call", ratio),
    "p99": ("ratio.p99", ratio),
    "dist": ("ratio.distance", ratio),
    "build": ("ratio.build", ratio),
    "2thr": ("threads_2", ratio),
    "B/tri": ("peers.fgenv.bytes_per_triangle", number()),
}
NOTE = (
    "batch, free, hit: CPU µs per query, NumPy poses in one batch, one thread; call, p99: one pose "
    "per call; dist: µs per distance of free poses; build: CPU ms for both meshes; differ: "
    "verdicts unlike python-fcl's (only fgenv detects a body inside another); (h) about hulls, "
    "(f) in single precision."
)


def peer_table(record: Record) -> Table:
    """Return the table of one pair: a row per library, times in microseconds."""
    a, b = record["triangles"]
    title = f"{record['pair']}: {a} and {b} triangles, {100 * record['hit_share']:.0f} % hits"
    rows = (
        {**peer, "name": name + SUFFIXES.get(peer["truth"], " (f)")}
        for name, peer in record["peers"].items()
    )
    return table(title, PEER_COLUMNS, rows)


def ratio_table(records: Sequence[Record], summary: dict[str, dict[str, float]]) -> Table:
    """Return the table of speed-ups over python-fcl: a row per pair, then the summary."""
    overall = [
        {"pair": title, "ratio": {k: s[key] for k, s in summary.items()}, "style": "bold"}
        for key, title in (("mean", "geometric mean"), ("worst", "worst"))
    ]
    title = "Times faster than python-fcl (build: its time as a share)"
    return table(title, RATIO_COLUMNS, [*records, *overall])


def _thousands(count: int) -> str:
    return str(count) if count < 1000 else f"{count / 1000:.{1 if count < 10_000 else 0}f}k"


def plot_times(records: Sequence[Record], path: Path) -> None:
    """Plot microseconds per query over triangles, a line per library, to `path`."""
    figure = new_figure(7, 4.5)
    axes = figure.subplots()
    ordered = sorted(records, key=lambda record: sum(record["triangles"]))
    for name in dict.fromkeys(name for record in ordered for name in record["peers"]):
        measured = [record for record in ordered if name in record["peers"]]
        sizes = [sum(record["triangles"]) for record in measured]
        times = [1e6 * record["peers"][name]["batch"]["mean"] for record in measured]
        axes.plot(np.array(sizes), np.array(times), marker="o", label=name)
    axes.set(xscale="log", yscale="log", xlabel="triangles of both meshes", ylabel="µs per query")
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()
    save_figure(figure, path)

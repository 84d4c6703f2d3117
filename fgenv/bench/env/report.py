"""The records of ``fgenv bench env`` as tables."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from fgenv.bench.common.records import Record
from fgenv.bench.common.tables import Columns, count, fixed, micros, ratio, table, text

NOTES = {
    "rates": "Robot-steps per CPU second, one thread, random actions drawn beforehand, medians; "
    "×: times faster than that library; -: steps one world only. fgenv: exact contacts of carts of "
    "268 triangles among clutter, 12 rays on meshes, episodes restart. VMAS (navigation): discs "
    "that push each other, 12 rays on discs alone, no obstacles, no resets; MPE2 (simple_spread): "
    "discs, no rays, no obstacles, no resets.",
    "warehouse": "Robot-steps per CPU second, one thread: carts among racks, 12 rays.",
    "growth": "CPU µs per robot-step, 12 rays, about 10 m² per robot; the last column: the largest "
    "number of robots relative to the smallest.",
    "views": "CPU µs per step of the view, and of the simulator below it; share: the view's rate "
    "relative to the simulator's.",
}
SIZES: Columns = {"worlds": ("worlds", count), "robots": ("robots", count)}
COLUMNS: dict[str, Columns] = {
    "rates": {
        **SIZES,
        "fgenv": ("peers.fgenv.rate", count),
        "VMAS": ("peers.VMAS.rate", count),
        "MPE2": ("peers.MPE2.rate", count),
        "×VMAS": ("ratio.VMAS", ratio),
        "×MPE2": ("ratio.MPE2", ratio),
    },
    "warehouse": {**SIZES, "fgenv": ("peers.fgenv.rate", count)},
    "views": {
        "view": ("name", text),
        **SIZES,
        "step": ("view", micros),
        "simulator": ("simulator", micros),
        "overhead": ("overhead", micros),
        "share": ("rate", fixed(2)),
    },
}
TITLES = {
    "rates": "Robot-steps per CPU second",
    "warehouse": "A warehouse",
    "growth": "More robots in a world",
    "views": "Views of the simulator",
}


def table_of(kind: str, records: Sequence[Record]) -> Table:
    """Return the table of one kind of record."""
    if kind == "growth":
        (record,) = records
        costs = {str(row["robots"]): row["seconds"] for row in record["rows"]}
        columns: Columns = {name: (name, micros) for name in costs} | {"×": ("times", fixed(2))}
        return table(TITLES[kind], columns, [{**costs, "times": record["times"]}])
    return table(TITLES[kind], COLUMNS[kind], records)

"""The records of ``fgenv bench env`` as tables."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from fgenv.bench.env.batch import Record

PEERS = ("fgenv", "VMAS", "MPE2")
NOTES = {
    "rates": "Robot-steps in a CPU second, one thread, random actions drawn beforehand, medians; "
    "×: times faster than that library; -: steps one world only. fgenv: exact contacts of carts of "
    "268 triangles among clutter, 12 rays on meshes, episodes that start anew. VMAS (navigation): "
    "discs that push each other, 12 rays on discs alone, no obstacles, no resets; MPE2 "
    "(simple_spread): discs, no rays, no obstacles, no resets.",
    "warehouse": "Robot-steps in a CPU second, one thread: carts among racks, 12 rays.",
    "growth": "µs of CPU a robot-step, 12 rays, at about 10 m² a robot; the last column: the most "
    "robots against the fewest.",
    "views": "µs of CPU a step of the view, and of the simulator below it; share: the view's rate "
    "of the simulator's.",
}


def table_of(kind: str, records: Sequence[Record]) -> Table:
    """The table of one kind of record."""
    makers = {
        "rates": rates_table,
        "warehouse": warehouse_table,
        "growth": growth_table,
        "views": views_table,
    }
    return makers[kind](records)


def rates_table(records: Sequence[Record]) -> Table:
    """Worlds and robots downward, libraries across."""
    titles = ("worlds", "robots", *PEERS, *(f"×{name}" for name in PEERS[1:]))
    table = _table("Robot-steps in a CPU second", titles)
    for row in records:
        table.add_row(
            f"{row['worlds']:,}",
            str(row["robots"]),
            *(_rate(row["peers"].get(name)) for name in PEERS),
            *(_times(row["ratio"].get(name)) for name in PEERS[1:]),
        )
    return table


def warehouse_table(records: Sequence[Record]) -> Table:
    """Worlds downward."""
    table = _table("A warehouse", ("worlds", "robots", "fgenv"))
    for row in records:
        rate = _rate(row["peers"]["fgenv"])
        table.add_row(f"{row['worlds']:,}", str(row["robots"]), rate)
    return table


def growth_table(records: Sequence[Record]) -> Table:
    """Numbers of robots across."""
    (record,) = records
    titles = [str(row["robots"]) for row in record["rows"]]
    table = _table("More robots in a world", (*titles, "×"))
    costs = [f"{1e6 * row['seconds']:.3g}" for row in record["rows"]]
    table.add_row(*costs, f"{record['times']:.2f}")
    return table


def views_table(records: Sequence[Record]) -> Table:
    """Views downward."""
    titles = ("view", "worlds", "robots", "step", "simulator", "overhead", "share")
    table = _table("Views of the simulator", titles)
    for row in records:
        costs = [f"{1e6 * row[key]:.3g}" for key in ("view", "simulator", "overhead")]
        share = f"{row['rate']:.2f}"
        table.add_row(row["name"], f"{row['worlds']:,}", str(row["robots"]), *costs, share)
    return table


def _rate(found: Record | None) -> str:
    return "-" if found is None else f"{found['rate']:,.0f}"


def _times(ratio: float | None) -> str:
    return "-" if ratio is None else f"{ratio:.1f}"


def _table(title: str, columns: Sequence[str]) -> Table:
    table = Table(title=title, box=None, padding=(0, 0, 0, 1), pad_edge=False, title_style="bold")
    for column in columns:
        table.add_column(column, justify="right", no_wrap=True)
    return table

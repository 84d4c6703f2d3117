"""The records of ``fgenv bench fleets`` as a table."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from .run import Record

TITLES = ("fleet", "method", "solved", "s", "search", "p95", "makespan", "sum", "least")
NOTE = (
    "solved: cases of the frozen set with a certified plan in the time limit; medians of those: s "
    "of CPU in all, of which OMPL's search (composite), makespan and sum of arrivals (s), "
    "least clearance (mm); p95: CPU seconds of all cases, failures among them."
)


def table_of(records: Sequence[Record]) -> Table:
    """Fleets and methods downward."""
    table = Table(
        title="Plans for many robots",
        box=None,
        padding=(0, 0, 0, 1),
        pad_edge=False,
        title_style="bold",
    )
    for title in TITLES:
        left = title in TITLES[:2]
        table.add_column(title, justify="left" if left else "right", no_wrap=True)
    for record in records:
        least = record["least"]
        table.add_row(
            record["fleet"],
            record["method"],
            f"{record['solved']}/{record['cases']}",
            number(record["seconds"]),
            number(record["search"]),
            number(record["p95"]),
            number(record["makespan"]),
            number(record["sum_of_costs"]),
            "-" if least is None else f"{1e3 * least:.1f}",
        )
    return table


def number(value: float | None) -> str:
    """Three digits at most."""
    if value is None:
        return "-"
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"

"""The records of ``fgenv bench fleets`` as a table and as shares."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from fgenv.bench.common.records import Record
from fgenv.bench.common.tables import Columns, fixed, number, table, text
from fgenv.confidence import Estimate, rate

NOTE = (
    "solved: cases with a certified plan within the time limit; medians of those: "
    "CPU s in total (s) and of OMPL's search (composite), makespan and sum of arrivals (s), least "
    "clearance (mm); p95: CPU seconds of all cases, including failures."
)
COLUMNS: Columns = {
    "fleet": ("fleet", text),
    "method": ("method", text),
    "solved": (lambda row: f"{row['solved']}/{row['cases']}", str),
    "s": ("seconds", number()),
    "search": ("search", number()),
    "p95": ("p95", number()),
    "makespan": ("makespan", number()),
    "sum": ("sum_of_costs", number()),
    "least": ("least", fixed(1, 1e3)),
}


def table_of(records: Sequence[Record]) -> Table:
    """Return a table with a row per fleet and method."""
    return table("Plans for many robots", COLUMNS, records)


def solved_shares(records: Sequence[Record]) -> dict[str, dict[str, Estimate]]:
    """Return the share of solved cases by fleet and method."""
    shares: dict[str, dict[str, Estimate]] = {}
    for row in records:
        shares.setdefault(row["fleet"], {})[row["method"]] = rate(row["solved"], row["cases"])
    return shares

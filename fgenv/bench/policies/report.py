"""The records of ``fgenv bench policies`` as a table and as shares."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

from rich.table import Table

from fgenv.bench.common.records import Record
from fgenv.bench.common.tables import Columns, fixed, table, text
from fgenv.confidence import Estimate

NOTES = (
    "success: of episodes, with its 95 % interval; collide, late: of robots",
    "* additional seconds relative to straight motion, where all policies of the set succeed",
)
COLUMNS: Columns = {
    "policy": ("policy", text),
    "success": ("success", lambda s: s if isinstance(s, str) else interval(s)),
    "collide": ("robot_collision", fixed(3)),
    "late": ("time_out", fixed(3)),
    "extra time *": (lambda row: row["extra_time"].value if row.get("shared") else None, fixed(2)),
}


def table_of(records: Sequence[Record], cases: int) -> Table:
    """Return a table with the sets and the results of their policies."""
    return table(f"{cases} cases each", COLUMNS, _rows(records))


def _rows(records: Sequence[Record]) -> Iterator[Record]:
    for name, rows in groupby(records, key=lambda row: row["set"]):
        policies = list(rows)
        goal = f"expected {policies[0]['goal']:.2f}"
        yield {"policy": name, "success": goal, "style": ""}
        yield from ({**row, "policy": f"  {row['policy']}"} for row in policies)


def interval(estimate: Estimate) -> str:
    """Format an estimate with its interval."""
    return f"{estimate.value:.2f} [{estimate.low:.2f}, {estimate.high:.2f}]"


def success_shares(records: Sequence[Record]) -> dict[str, dict[str, Estimate]]:
    """Return the success by set and kind of policy: the files of policies share one color."""
    shares: dict[str, dict[str, Estimate]] = {}
    for row in records:
        name = row["policy"]
        kind = name if name.startswith("orca") else name.rpartition(":")[0]
        shares.setdefault(row["set"], {})[kind] = row["success"]
    return shares

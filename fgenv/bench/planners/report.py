"""The records of ``fgenv bench planners`` as tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.table import Table

from fgenv.bench.common.records import Record
from fgenv.bench.common.tables import (
    Columns,
    count,
    fixed,
    goals_table,
    grouped,
    micros,
    millis,
    number,
    ratio,
    table,
    text,
)

from .arm_run import family_statistics
from .methods import CERTIFIED, COAL, DISCRETE, FCL

NOTES = {
    "problems": "RRTConnect, the same seeds, space and range. s: CPU seconds to the first "
    "solution, median; ×: times fgenv certified is faster; motions: checked; kmot, kst: thousands "
    "of motions and states checked per CPU second of the search; hidden: shortened solutions in "
    "which python-fcl finds a collision at 1/100 of the resolution, of those solved. certified, "
    "discrete: fgenv's plug-in; the others: checkers in Python under OMPL's discrete validator, "
    "with as many steps in the mean.",
    "edges": "CPU µs per edge: the edges of certified searches, checked again through OMPL; "
    "native: certified in one batch; plug: cost of OMPL and the plug-in above that; ×FCL: "
    "python-fcl's time over fgenv's discrete at equal resolution; states: single states.",
    "floor": "The same searches with known verdicts: the cost of OMPL itself. "
    "times: certified relative to it, median; floor, check: µs per motion of it, and above it.",
    "traps": "Solved within the time limit; hidden as above.",
    "mbm": "CPU ms to the first solution; hidden: shortened solutions in which pinocchio and "
    "coal find a collision at 1/3200 rad. pinocchio + coal: discrete, 1/32 rad.",
}
METHODS = (CERTIFIED, "native", DISCRETE, FCL, COAL)
SEARCH: Columns = {
    "problem": ("problem", text),
    "way": ("name", text),
    "solved": (lambda row: f"{row['solved']}/{row['of']}", str),
    "s": (
        lambda row: f">{row['limit']:g}" if row["seconds"] is None else number()(row["seconds"]),
        str,
    ),
}
HIDDEN: Columns = {"hidden": (lambda row: f"{row['hidden']}/{row['solved']}", str)}
COLUMNS: dict[str, Columns] = {
    "problems": {
        **SEARCH,
        "×": ("times", ratio),
        "motions": ("motions", count),
        "kmot/s": ("motions_per_second", number(1e-3)),
        "kst/s": ("states_per_second", number(1e-3)),
        **HIDDEN,
    },
    "edges": {
        "problem": ("problem", text),
        "": ("name", text),
        "edges": ("count", fixed(0)),
        **{name: (name, micros) for name in METHODS},
        "plug": ("plug", micros),
        "×FCL": ("times", ratio),
    },
    "floor": {
        "problem": ("problem", text),
        "certified s": (f"ways.{CERTIFIED}.seconds", number()),
        "floor s": ("floor.seconds", number()),
        "times": ("floor.times", fixed(2)),
        "floor µs": ("floor.per_motion", micros),
        "check µs": ("floor.check", micros),
    },
    "traps": {**SEARCH, "motions": ("motions", count), **HIDDEN},
    "mbm": {
        "family": ("family", text),
        "way": ("name", text),
        "problems": ("problems", str),
        "solved": ("solved", lambda share: f"{100 * share:.0f} %"),
        "median": ("median", millis),
        "95 %": ("p95", millis),
        "motions": ("motions", count),
        "hidden": ("hidden", str),
    },
}
TITLES = {
    "problems": "Time to the first solution",
    "edges": "The same edges",
    "floor": "Cost of OMPL itself",
    "traps": "Traps",
    "mbm": "MotionBenchMaker, Panda",
}


def tables_of(kind: str, records: Sequence[Record]) -> list[tuple[Table, str]]:
    """Return the tables of one kind of record, each with the meaning of its columns."""
    if kind == "goals":
        return [(goals_table(records), "")]
    if kind == "mbm":
        families = [(record["family"], _family_rows([record])) for record in records]
        rows = {kind: grouped("family", [*families, ("all", _family_rows(records))])}
    else:
        rows = {kind: grouped("problem", ((_title(kind, r), _search_rows(r)) for r in records))}
    if kind == "problems":
        rows["edges"] = grouped("problem", ((r["problem"], _edge_rows(r)) for r in records))
        rows["floor"] = [record for record in records if "floor" in record]
    return [(table(TITLES[name], COLUMNS[name], part), NOTES[name]) for name, part in rows.items()]


def _title(kind: str, record: Record) -> str:
    name = str(record["problem"])
    return f"{name} ({1e3 * record['resolution']:.0f} mm)" if kind == "problems" else name


def _search_rows(record: Record) -> Iterator[Record]:
    """Yield a row per method."""
    own = record["ways"][CERTIFIED]["seconds"]
    for name, method in record["ways"].items():
        row = {**method, "name": name, "limit": record["limit"]}
        if name != CERTIFIED and own and method["seconds"]:
            row["times"] = method["seconds"] / own
        if name in (CERTIFIED, DISCRETE):
            del row["states_per_second"]  # their motions check no states
        yield row


def _edge_rows(record: Record) -> Iterator[Record]:
    """Yield a row per kind of edge, and one for single states."""
    edges = record.get("edges", {})
    shares = {"free": edges.get("share", 0.0), "hit": 1.0 - edges.get("share", 0.0)}
    titles = {"all": "all", "free": "free", "hit": "not free", "states": "states"}
    for kind, title in titles.items():
        if kind in edges:
            row = {**edges[kind], "name": title, "count": shares.get(kind, 1.0) * edges["edges"]}
            row["times"] = row[FCL] / row[DISCRETE]
            row["plug"] = row[CERTIFIED] - row["native"] if "native" in row else None
            yield row


def _family_rows(records: Sequence[Record]) -> Iterator[Record]:
    """Yield a row per method over the problems of some families."""
    for name, method in family_statistics(records).items():
        yield {**method, "name": name}

"""The records of ``fgenv bench planners`` as tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich.table import Table

from . import arm_run
from .rigid_run import Record
from .ways import CERTIFIED, COAL, DISCRETE, FCL

NOTES = {
    "problems": "RRTConnect, the same seeds, space and range. s: CPU seconds to the first "
    "solution, median; ×: times fgenv certified is faster; motions: asked for, median; kmot, kst: "
    "thousands of motions and states asked in a CPU second of the search; hidden: shortened "
    "solutions in which python-fcl finds a collision when it looks 100 times finer than the "
    "resolution, of those solved. certified, discrete: fgenv's plug-in; the others: checkers in "
    "Python under OMPL's discrete validator, which takes as many steps in the mean.",
    "edges": "µs of CPU an edge: the very edges that certified searches asked for, asked again "
    "through OMPL; native: certified in one batch; plug: what OMPL and the plug-in add to that; "
    "×FCL: python-fcl's time over fgenv's discrete at equal resolution; states: single states.",
    "floor": "The same searches with known verdicts: the cost of OMPL itself. "
    "times: certified against it, median; floor, check: µs per motion of that, and above it.",
    "traps": "Solved within the time limit; hidden as above.",
    "mbm": "ms of CPU to the first solution; hidden: shortened solutions in which pinocchio and "
    "coal find a collision at 1/3200 rad. pinocchio + coal: discrete, 1/32 rad.",
}


def tables_of(kind: str, records: Sequence[Record]) -> list[tuple[Table, str]]:
    """Tables of one kind of record, each with what its columns mean."""
    if kind == "problems":
        return [
            (problems_table(records), NOTES["problems"]),
            (edges_table(records), NOTES["edges"]),
            (floor_table(records), NOTES["floor"]),
        ]
    makers = {"traps": traps_table, "mbm": mbm_table, "goals": goals_table}
    return [(makers[kind](records), NOTES.get(kind, ""))]


def problems_table(records: Sequence[Record]) -> Table:
    """Problems and ways downward."""
    titles = ("solved", "s", "×", "motions", "kmot/s", "kst/s", "hidden")
    table = _table("Time to the first solution", ("problem", "way"), titles)
    for record in records:
        own = record["ways"][CERTIFIED]["seconds"]
        for k, (name, way) in enumerate(record["ways"].items()):
            took = way["seconds"]
            times = "" if name == CERTIFIED or not (own and took) else f"{took / own:.1f}"
            table.add_row(
                "" if k else f"{record['problem']} ({1e3 * record['resolution']:.0f} mm)",
                name,
                f"{way['solved']}/{way['of']}",
                f">{record['limit']:g}" if took is None else f"{took:.3g}",
                times,
                f"{way['motions']:,.0f}",
                _thousands(way["motions_per_second"]),
                "" if name in (CERTIFIED, DISCRETE) else _thousands(way["states_per_second"]),
                f"{way['hidden']}/{way['solved']}",
            )
    return table


def edges_table(records: Sequence[Record]) -> Table:
    """Problems downward, ways across."""
    columns = (CERTIFIED, "native", DISCRETE, FCL, COAL)
    table = _table("The same edges", ("problem", ""), ("edges", *columns, "plug", "×FCL"))
    for record in records:
        found = record.get("edges", {})
        rows = {"all": "all", "free": "free", "hit": "not free", "states": "states"}
        for k, (kind, title) in enumerate((k, t) for k, t in rows.items() if k in found):
            took = found[kind]
            count = {"all": 1.0, "free": found["share"], "hit": 1 - found["share"]}.get(kind, 1.0)
            plug = took[CERTIFIED] - took["native"] if "native" in took else None
            table.add_row(
                "" if k else record["problem"],
                title,
                f"{count * found['edges']:.0f}",
                *(_micros(took.get(name)) for name in columns),
                _micros(plug),
                f"{took[FCL] / took[DISCRETE]:.1f}",
            )
    return table


def floor_table(records: Sequence[Record]) -> Table:
    """Problems downward."""
    titles = ("certified s", "floor s", "times", "floor µs", "check µs")
    table = _table("What OMPL itself takes", ("problem",), titles)
    for record in records:
        if "floor" in record:
            least, own = record["floor"], record["ways"][CERTIFIED]["seconds"]
            table.add_row(
                record["problem"],
                "-" if own is None else f"{own:.3g}",
                f"{least['seconds']:.3g}",
                f"{least['times']:.2f}",
                _micros(least["per_motion"]),
                _micros(least["check"]),
            )
    return table


def traps_table(records: Sequence[Record]) -> Table:
    """Traps and ways downward."""
    table = _table("Traps", ("problem", "way"), ("solved", "s", "motions", "hidden"))
    for record in records:
        for k, (name, way) in enumerate(record["ways"].items()):
            took = way["seconds"]
            table.add_row(
                "" if k else record["problem"],
                name,
                f"{way['solved']}/{way['of']}",
                f">{record['limit']:g}" if took is None else f"{took:.3g}",
                f"{way['motions']:,.0f}",
                f"{way['hidden']}/{way['solved']}",
            )
    return table


def mbm_table(records: Sequence[Record]) -> Table:
    """Families downward, then all of them."""
    titles = ("problems", "solved", "median", "95 %", "motions", "hidden")
    table = _table("MotionBenchMaker, Panda", ("family", "way"), titles)
    for record in (*records, None):
        found = arm_run.summed(records if record is None else [record])
        for k, (name, way) in enumerate(found.items()):
            table.add_row(
                "" if k else ("all" if record is None else record["family"]),
                name,
                str(way["problems"]),
                f"{100 * way['solved']:.0f} %",
                _millis(way["median"]),
                _millis(way["p95"]),
                f"{way['motions']:,.0f}",
                str(way["hidden"]),
            )
    return table


def goals_table(records: Sequence[Mapping[str, Any]]) -> Table:
    """Goals and measured values."""
    table = _table("Goals", ("",), ("expected", "measured", ""))
    for goal, found in records[0].items():
        most, expected, measured = found.get("at_most"), found["expected"], found["measured"]
        held = measured <= expected if most else measured >= expected
        word = "at most" if most else "at least"
        table.add_row(goal, f"{word} {expected:.3g}", f"{measured:.3g}", "yes" if held else "no")
    return table


def _table(title: str, left: Sequence[str], right: Sequence[str]) -> Table:
    table = Table(title=title, box=None, padding=(0, 0, 0, 1), pad_edge=False, title_style="bold")
    for column in left:
        table.add_column(column, no_wrap=True)
    for column in right:
        table.add_column(column, justify="right", no_wrap=True)
    return table


def _thousands(rate: float) -> str:
    return f"{rate / 1000:.3g}"


def _micros(seconds: float | None) -> str:
    return "" if seconds is None else f"{1e6 * seconds:.3g}"


def _millis(seconds: float | None) -> str:
    return "-" if seconds is None else f"{1e3 * seconds:.3g}"

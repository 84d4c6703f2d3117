"""The records of ``fgenv bench world`` as tables and as a plot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.table import Table

from fgenv.bench.common.records import Record
from fgenv.bench.common.tables import (
    Columns,
    count,
    fixed,
    goals_table,
    micros,
    millis,
    number,
    ratio,
    table,
    text,
)
from fgenv.view.figures.canvas import new_figure, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PEERS = ("fgenv", "python-fcl", "coal", "trimesh", "mujoco")
NOTES = {
    "steps": "CPU milliseconds per step, one thread, all bodies moved and all colliding pairs "
    "found. near: pairs with overlapping boxes; hits: colliding pairs; in brackets: "
    "pairs that differ from python-fcl's. coal reports pairs only with all their "
    "contacts; mujoco (h) uses hulls; -: over the budget.",
    "movers": "CPU microseconds of set_path, of a collision check, of a motion (piece of the "
    "path) certified and at 1 cm. Smaller worlds are the middle of the largest, "
    "around the same paths. masked: bodies with the bit of a mover; tests: pairs of "
    "bodies tested per pose, with masks, as published (which hides collisions), and "
    "without; B: bytes per body, without shapes.",
    "motions": "CPU microseconds per motion, free and in contact, and wrong verdicts; ×1 cm: "
    "cost of a free motion relative to the discrete check at 1 cm. Ground truth: the "
    "certified result.",
    "truths": "clearance: quartiles of the least distance on free motions, in sizes; denied: "
    "proved free, and python-fcl finds a collision at one of a thousand poses; "
    "confirmed: contacts shown, and python-fcl collides there as well.",
}


def _step(name: str) -> Any:
    """Return the cell of a library in the table of steps."""

    def cell(row: Record) -> str | None:
        peer = row["peers"].get(name)
        if peer is None:
            return None
        if "step" not in peer:
            return "refused"
        return millis(peer["step"]) + (f" ({n})" if (n := peer.get("differ", 0)) else "")

    return cell


def _fcl_ratio(row: Record) -> float | None:
    own, fcl = (row["peers"].get(name, {}).get("step") for name in ("fgenv", "python-fcl"))
    return fcl / own if own and fcl else None


BODIES: Columns = {"triangles": ("triangles", str), "bodies": ("bodies", count)}
COLUMNS: dict[str, Columns] = {
    "steps": {
        **BODIES,
        "near": ("near", count),
        "hits": ("colliding", count),
        **{name + " (h)" * (name == "mujoco"): (_step(name), str) for name in PEERS},
        "×FCL": (_fcl_ratio, ratio),
    },
    "movers": {
        **BODIES,
        "set_path": ("set_path", micros),
        "collides": ("collides", micros),
        "motion": ("check_motion", micros),
        "1 cm": ("discrete 1 cm", micros),
        "masked": ("candidates", fixed(1)),
        "tests": ("tests.path", number()),
        "publ.": ("tests.published", number()),
        "without": ("tests.off", number()),
        "B": ("bytes_per_body", fixed(0)),
    },
    "threads": {name: (name, fixed(2)) for name in ("contacts", "collides", "check_motion")},
    "motions": {
        "": ("name", text),
        "free": ("free", micros),
        "×1 cm": ("relative", number()),
        "contact": ("contact", micros),
        "missed": ("missed", str),
        "false alarms": ("false_alarms", str),
    },
    "truths": {
        "": ("name", text),
        "motions": ("motions", str),
        "free": ("free", str),
        "clearance": ("clearance", lambda c: " ".join(f"{100 * x:.2g}" for x in c) + " %"),
        "denied": ("truth.contradicted", str),
        "confirmed": ("truth", lambda t: f"{t['contacts_confirmed']} of {t['contacts']}"),
        "unresolved": ("truth.unresolved", str),
    },
}
TITLES = {
    "steps": "All pairs per step",
    "movers": "A mover's check among bodies at rest",
    "threads": "Two threads against one",
    "motions": "Motions past another body",
    "truths": "Those motions, and the cross-check of their truth",
}


def table_of(kind: str, records: Sequence[Record]) -> Table:
    """Return the table of one kind of record."""
    if kind == "goals":
        return goals_table(records)
    rows: Iterator[Record] = iter(records)
    if kind == "movers":
        rows = ({"triangles": r["triangles"], **row} for r in records for row in r["rows"])
    elif kind == "motions":
        rows = (row for record in records for row in _method_rows(record))
    return table(TITLES[kind], COLUMNS[kind], rows)


def _method_rows(record: Record) -> Iterator[Record]:
    """Yield a heading, then the methods to check a motion."""
    a, b = record["triangles"]
    yield {"name": f"{record['name']} ({a}/{b})", "style": "bold"}
    unit = record["ways"]["discrete 1 cm"]["free"]
    for name, method in record["ways"].items():
        part = f" (of {method['asked']})" if method["asked"] < record["motions"] else ""
        relative = method["free"] / unit if unit and method["free"] else None
        yield {**method, "name": f"  {name}{part}", "relative": relative}


def plot(parts: Mapping[str, Sequence[Record]], path: Path) -> None:
    """Plot seconds per step, and pairs tested with and without masks, over the number of bodies."""
    figure = new_figure(11, 4.5)
    left, right = figure.subplots(1, 2)
    styles = dict(zip(dict.fromkeys(r["triangles"] for r in parts["steps"]), "-:", strict=False))
    _plot_steps(left, parts["steps"], styles)
    _plot_tests(right, parts["movers"], styles)
    for axes in (left, right):
        axes.set(xscale="log", yscale="log", xlabel="bodies")
        axes.grid(visible=True, which="major", alpha=0.3)
        axes.legend(fontsize=8)
    save_figure(figure, path)


def _plot_steps(axes: Axes, records: Sequence[Record], styles: Mapping[int, str]) -> None:
    for triangles, style in styles.items():
        rows = [r for r in records if r["triangles"] == triangles]
        for k, name in enumerate(PEERS):
            points = [
                (r["bodies"], 1e3 * r["peers"][name]["step"])
                for r in rows
                if "step" in r["peers"].get(name, {})
            ]
            if points:
                label = f"{name}, {triangles} triangles"
                line = zip(*points, strict=True)
                axes.plot(*line, style, color=f"C{k}", marker="o", label=label)
    axes.set_ylabel("ms per step, all pairs")


def _plot_tests(axes: Axes, records: Sequence[Record], styles: Mapping[int, str]) -> None:
    for record in records:
        style, rows = styles.get(record["triangles"], "-"), record["rows"]
        bodies = [row["bodies"] for row in rows]
        for masks, color, name in (("path", "C0", "with masks"), ("off", "C3", "without masks")):
            tests = [row["tests"][masks] for row in rows]
            label = f"{name}, {record['triangles']} triangles"
            axes.plot(bodies, tests, style, color=color, marker="o", label=label)
    axes.set_ylabel("pairs tested per pose of a mover")

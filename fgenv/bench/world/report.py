"""The records of ``fgenv bench world`` as tables and as a plot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

Record = dict[str, Any]
PEERS = ("fgenv", "python-fcl", "coal", "trimesh", "mujoco")
JOBS = {
    "set_path": "set_path",
    "collides": "collides",
    "motion": "check_motion",
    "1 cm": "discrete 1 cm",
}
NOTES = {
    "steps": "CPU milliseconds per step, one thread, all bodies moved and all colliding pairs "
    "found. near: pairs with overlapping boxes; hits: colliding pairs; in brackets: "
    "pairs that differ from python-fcl's. coal reports pairs only with all their "
    "contacts; mujoco (h) uses hulls; -: over the budget.",
    "movers": "CPU microseconds of set_path, of a collision check, of a motion (piece of the "
    "path) certified and at 1 cm. Smaller worlds are the middle of the largest, "
    "around the same paths. bear: bodies with the bit of a mover; tests: pairs of "
    "bodies tested per pose, with masks, as published (which hides collisions), and "
    "without; B: bytes per body, without shapes.",
    "motions": "CPU microseconds per motion, free and in contact, and wrong verdicts; ×1 cm: "
    "cost of a free motion relative to the discrete check at 1 cm. Ground truth: the "
    "certified result.",
    "truths": "clearance: quartiles of the least distance on free motions, in sizes; denied: "
    "proved free, and python-fcl finds a collision at one of a thousand poses; "
    "confirmed: contacts shown, and python-fcl collides there as well.",
}


def table_of(kind: str, records: Sequence[Record]) -> Table:
    """The table of one kind of record."""
    makers = {
        "steps": steps_table,
        "movers": movers_table,
        "threads": threads_table,
        "motions": motions_table,
        "truths": truths_table,
        "goals": goals_table,
    }
    return makers[kind](records)


def steps_table(records: Sequence[Record]) -> Table:
    """Bodies downward, libraries across."""
    table = _table("All pairs a step")
    for title in ("triangles", "bodies", "near", "hits", *PEERS, "×FCL"):
        table.add_column(title + " (h)" * (title == "mujoco"), justify="right", no_wrap=True)
    for row in records:
        peers = row["peers"]
        own, other = (peers.get(name, {}).get("step") for name in ("fgenv", "python-fcl"))
        table.add_row(
            str(row["triangles"]),
            f"{row['bodies']:,}",
            f"{row['near']:,.0f}",
            f"{row['colliding']:,.0f}",
            *(_step(peers.get(name)) for name in PEERS),
            f"{other / own:.1f}" if own and other else "-",
        )
    return table


def _step(found: Record | None) -> str:
    if found is None:
        return "-"
    if "step" not in found:
        return "refused"
    differ = found.get("differ", 0)
    return _number(1e3 * found["step"]) + (f" ({differ})" if differ else "")


def movers_table(records: Sequence[Record]) -> Table:
    """Worlds downward."""
    table = _table("A mover's check among bodies that stand")
    for title in ("triangles", "bodies", *JOBS, "bear", "tests", "publ.", "without", "B"):
        table.add_column(title, justify="right", no_wrap=True)
    for record in records:
        for row in record["rows"]:
            tests = row["tests"]
            table.add_row(
                str(record["triangles"]),
                f"{row['bodies']:,}",
                *(_number(1e6 * row[job]) for job in JOBS.values()),
                f"{row['candidates']:.1f}",
                *(_number(tests[masks]) for masks in ("path", "published", "off")),
                f"{row['bytes_per_body']:.0f}",
            )
    return table


def threads_table(records: Sequence[Record]) -> Table:
    """How many times two threads are faster, by the clock."""
    table = _table("Two threads against one")
    for job in records[0]:
        table.add_column(job, justify="right", no_wrap=True)
    table.add_row(*(f"{times:.2f}" for times in records[0].values()))
    return table


def motions_table(records: Sequence[Record]) -> Table:
    """Ways to check a motion downward, pair after pair."""
    table = _table("Motions past another body")
    table.add_column("", no_wrap=True)
    for title in ("free", "×1 cm", "contact", "missed", "false alarms"):
        table.add_column(title, justify="right", no_wrap=True)
    for record in records:
        a, b = record["triangles"]
        table.add_row(f"{record['name']} ({a}/{b})", style="bold")
        unit = record["ways"]["discrete 1 cm"]["free"]
        for name, way in record["ways"].items():
            asked = f" (of {way['asked']})" if way["asked"] < record["motions"] else ""
            table.add_row(
                "  " + name + asked,
                *(
                    _number(value * scale) if value and scale else "-"
                    for value, scale in (
                        (way["free"], 1e6),
                        (way["free"], unit and 1 / unit),
                        (way["contact"], 1e6),
                    )
                ),
                str(way["missed"]),
                str(way["false_alarms"]),
            )
    return table


def truths_table(records: Sequence[Record]) -> Table:
    """What the motions are like, and what python-fcl says of the certified results."""
    table = _table("Those motions, and the cross-check of their truth")
    table.add_column("", no_wrap=True)
    for title in ("motions", "free", "clearance", "denied", "confirmed", "unresolved"):
        table.add_column(title, justify="right", no_wrap=True)
    for record in records:
        truth = record["truth"]
        table.add_row(
            record["name"],
            str(record["motions"]),
            str(record["free"]),
            " ".join(f"{100 * c:.2g}" for c in record["clearance"]) + " %",
            str(truth["contradicted"]),
            f"{truth['contacts_confirmed']} of {truth['contacts']}",
            str(truth["unresolved"]),
        )
    return table


def goals_table(records: Sequence[Mapping[str, Any]]) -> Table:
    """Goals and measured values."""
    table = _table("Goals")
    table.add_column("", no_wrap=True)
    for title in ("expected", "measured", ""):
        table.add_column(title, justify="right", no_wrap=True)
    for goal, found in records[0].items():
        most, expected, measured = found.get("at_most"), found["expected"], found["measured"]
        held = measured <= expected if most else measured >= expected
        word = "at most" if most else "at least"
        table.add_row(goal, f"{word} {expected:.3g}", f"{measured:.3g}", "yes" if held else "no")
    return table


def _table(title: str) -> Table:
    return Table(title=title, box=None, padding=(0, 0, 0, 1), pad_edge=False, title_style="bold")


def _number(value: float) -> str:
    """Three digits."""
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def plot(done: Mapping[str, Sequence[Record]], path: Path) -> None:
    """Plot seconds per step, and pairs tested with and without masks, over the number of bodies."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 4.5), layout="constrained")
    left, right = figure.subplots(1, 2)
    styles = dict(zip(dict.fromkeys(r["triangles"] for r in done["steps"]), "-:", strict=False))
    colors = {name: f"C{k}" for k, name in enumerate(PEERS)}
    for triangles, style in styles.items():
        rows = [r for r in done["steps"] if r["triangles"] == triangles]
        for name, color in colors.items():
            points = [(r["bodies"], r["peers"].get(name, {}).get("step")) for r in rows]
            points = [(n, 1e3 * t) for n, t in points if t is not None]
            if points:
                label = f"{name}, {triangles} triangles"
                left.plot(*zip(*points, strict=True), style, color=color, marker="o", label=label)
    left.set(xscale="log", yscale="log", xlabel="bodies", ylabel="ms per step, all pairs")
    for record in done["movers"]:
        style = styles.get(record["triangles"], "-")
        rows = record["rows"]
        for masks, color in (("path", "C0"), ("off", "C3")):
            label = {"path": "with masks", "off": "without masks"}[masks]
            right.plot(
                [row["bodies"] for row in rows],
                [row["tests"][masks] for row in rows],
                style,
                color=color,
                marker="o",
                label=f"{label}, {record['triangles']} triangles",
            )
    right.set(xscale="log", yscale="log", xlabel="bodies", ylabel="pairs tested a mover's pose")
    for axes in (left, right):
        axes.grid(visible=True, which="major", alpha=0.3)
        axes.legend(fontsize=8)
    figure.savefig(path, dpi=150)

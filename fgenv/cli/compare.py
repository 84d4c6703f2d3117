"""``fgenv compare``: the table that the paper claims and never prints."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fgenv.cli.errors import FAILED_CHECK
from fgenv.cli.options import Json, Seed

if TYPE_CHECKING:
    from rich.table import Table

    from fgenv.bench.comparison import Outcome, Row

NOTE = (
    "precision: share of reported collisions that are true; recall: share of true ones reported "
    "(truth: python-fcl, and winding numbers for a body inside another). tests: elementary tests "
    "a query; for the graphs edges times faces of the whole walk as published (their native code "
    "asks a tree first and does few of them), for the others boxes, spheres, hulls or cells in "
    "pairs until the first hit. µs: median of a call; graphs are native, the hull is python-fcl's, "
    "the others plain NumPy (their µs say little)."
)
COLUMNS = ("precision", "recall", "false hits", "missed", "tests", "µs")


def compare(
    poses: Annotated[int, typer.Option("--poses", min=10, help="Poses a pair.")] = 300,
    tolerance: Annotated[
        float,
        typer.Option("--tolerance", help="Of the method 'tolerance', as a share of a body's size."),
    ] = 1e-3,
    csv: Annotated[
        Path | None, typer.Option("--csv", dir_okay=False, help="Write every row to this file.")
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", dir_okay=False, help="Draw precision and recall to this picture."),
    ] = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Compare the feature graphs with boxes, sphere, hull and grid: how right, how fast.

    Six pairs of real, concave meshes near contact, each method on the same poses in turns. Needs
    the bench extra: pip install "fgenv\\[bench]". Exit code 1 if the exact method is ever wrong.
    """
    from rich.console import Console

    if not tolerance > 0.0:
        raise ValueError(f"tolerance is {tolerance}, expected a share of the size above 0")
    from fgenv.bench.comparison import PAIRS, compare_pairs, over_all

    console = Console(stderr=as_json, highlight=False)

    def show(heading: str, rows: Sequence[Row]) -> None:
        console.print(heading, style="bold")
        console.print(table(rows), "")

    outcomes: list[Outcome] = []
    with console.status(PAIRS[0].name) as status:
        for done, outcome in enumerate(compare_pairs(poses, seed, tolerance), 1):
            outcomes.append(outcome)
            show(title(outcome), outcome.rows)
            status.update(f"{done} of {len(PAIRS)} pairs done")
    overall = over_all(outcomes)
    show("all pairs (counts summed; tests and µs: geometric means)", overall)
    console.print(NOTE)
    if csv is not None:
        write_csv(csv, outcomes)
    if plot is not None:
        draw(plot, overall)
    if as_json:
        typer.echo(to_json(outcomes, overall, {"poses": poses, "seed": seed, "share": tolerance}))
    if any(row.missed or row.false_hits for row in overall if row.method == "exact"):
        console.print("The exact method disagrees with the truth.", style="bold red")
        raise typer.Exit(FAILED_CHECK)


def title(outcome: Outcome) -> str:
    """The pair in one line."""
    a, b = outcome.triangles
    inside = f", {outcome.contained} of them inside" if outcome.contained else ""
    hits = f"{100 * outcome.hit_share:.0f} % hits{inside}"
    return f"{outcome.pair}: {a} and {b} triangles, {outcome.poses} poses, {hits}"


def table(rows: Sequence[Row]) -> Table:
    """Methods downward, what was measured across."""
    from rich.table import Table

    made = Table(box=None, pad_edge=False)
    made.add_column("", no_wrap=True, min_width=9)
    for column in COLUMNS:
        made.add_column(column, justify="right", no_wrap=True)
    for row in rows:
        made.add_row(
            row.method,
            _share(row.precision),
            _share(row.recall),
            str(row.false_hits),
            str(row.missed),
            f"{row.tests:,.0f}",
            f"{row.microseconds:.1f}",
        )
    return made


def _share(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def as_dict(row: Row) -> dict[str, str | int | float | None]:
    """A row with its ratios, for JSON and CSV."""
    return {
        "method": row.method,
        "precision": row.precision,
        "recall": row.recall,
        "hits": row.hits,
        "false_hits": row.false_hits,
        "missed": row.missed,
        "tests": row.tests,
        "microseconds": row.microseconds,
    }


def to_json(outcomes: Sequence[Outcome], overall: Sequence[Row], settings: dict[str, float]) -> str:
    """One document: settings, pairs, all pairs together."""
    import json

    pairs = [
        {
            "pair": outcome.pair,
            "triangles": outcome.triangles,
            "hit_share": outcome.hit_share,
            "contained": outcome.contained,
            "methods": [as_dict(row) for row in outcome.rows],
        }
        for outcome in outcomes
    ]
    document = {"settings": settings, "pairs": pairs, "overall": [as_dict(r) for r in overall]}
    return json.dumps(document, indent=1)


def write_csv(path: Path, outcomes: Sequence[Outcome]) -> None:
    """A line for each pair and method."""
    import csv

    rows = [{"pair": o.pair, **as_dict(row)} for o in outcomes for row in o.rows]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def draw(path: Path, rows: Sequence[Row]) -> None:
    """Bars of precision and recall, method by method."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    axes = figure.subplots()
    for offset, name, color in ((-0.2, "precision", "#31688e"), (0.2, "recall", "#f08c2e")):
        heights = [getattr(row, name) or 0.0 for row in rows]
        places = [k + offset for k in range(len(rows))]
        bars = axes.bar(places, heights, 0.38, label=name, color=color)
        axes.bar_label(bars, [_share(getattr(row, name)) for row in rows], fontsize=7, padding=2)
    axes.set_xticks(range(len(rows)), [row.method for row in rows])
    axes.set_ylim(0.0, 1.12)
    axes.set_ylabel("share, all pairs together")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2, frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=150)

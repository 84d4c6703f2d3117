"""``fgenv compare``: precision, recall and speed of each collision method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fgenv.cli.console import console_of
from fgenv.cli.errors import FAILED_CHECK
from fgenv.cli.options import Json, Seed
from fgenv.cli.progress import status
from fgenv.saving import atomic

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from fgenv.bench.comparison import PairResult, Row

NOTE = (
    "precision: share of the reported collisions that are true; recall: share of the true ones "
    "that are reported (truth: python-fcl, and winding numbers for a body inside another). tests: "
    "elementary tests per query; for the graphs edges times faces of the walk as published (the "
    "native code does few of them), for the others pairs of boxes, spheres, hulls or cells until "
    "the first hit. µs: median of a call; the graphs are native, the hull is python-fcl's, the "
    "others are plain NumPy (their µs are no measure of the method)."
)
COLUMNS = ("precision", "recall", "false hits", "missed", "tests", "µs")


def compare(
    poses: Annotated[int, typer.Option("--poses", min=10, help="Poses per pair.")] = 300,
    tolerance: Annotated[
        float,
        typer.Option("--tolerance", help="Of the method 'tolerance', relative to a body's size."),
    ] = 1e-3,
    csv: Annotated[
        Path | None, typer.Option("--csv", dir_okay=False, help="Write every row to this file.")
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", dir_okay=False, help="Draw precision and recall to this file."),
    ] = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Compare the feature graphs with boxes, sphere, hull and grid: accuracy and speed.

    Six pairs of real, concave meshes near contact, each method on the same poses in turns. Needs
    the bench extra: pip install "fgenv\\[bench]". Exit code 1 if the exact method is ever wrong.
    """

    if not tolerance > 0.0:
        raise ValueError(f"tolerance: got {tolerance}, expected a share of the size above 0")
    from fgenv.bench.comparison import overall

    console = console_of(as_json)
    results = measured_pairs(console, poses, seed, tolerance)
    rows = overall(results)
    show(console, "all pairs (counts summed; tests and µs: geometric means)", rows)
    console.print(NOTE)
    if csv is not None:
        write_csv(csv, results)
    if plot is not None:
        draw(plot, rows)
    if as_json:
        typer.echo(to_json(results, rows, {"poses": poses, "seed": seed, "share": tolerance}))
    if any(row.missed or row.false_hits for row in rows if row.method == "exact"):
        console.print("The exact method disagrees with the truth.", style="bold red")
        raise typer.Exit(FAILED_CHECK)


def measured_pairs(console: Console, poses: int, seed: int, tolerance: float) -> list[PairResult]:
    """The results of all pairs; each is printed when it is measured."""
    from fgenv.bench.comparison import PAIRS, compare_pairs

    results: list[PairResult] = []
    with status(PAIRS[0].name) as update:
        for result in compare_pairs(poses, seed, tolerance):
            results.append(result)
            show(console, title(result), result.rows)
            update(f"{len(results)} of {len(PAIRS)} pairs done")
    return results


def show(console: Console, heading: str, rows: Sequence[Row]) -> None:
    """Print a heading and its table."""
    console.print(heading, style="bold")
    console.print(table(rows), "")


def title(result: PairResult) -> str:
    """The pair in one line."""
    a, b = result.triangles
    inside = f", {result.contained} of them inside" if result.contained else ""
    hits = f"{100 * result.hit_share:.0f} % hits{inside}"
    return f"{result.pair}: {a} and {b} triangles, {result.poses} poses, {hits}"


def table(rows: Sequence[Row]) -> Table:
    """A table with a row for each method."""
    from rich.table import Table

    grid = Table(box=None, pad_edge=False)
    grid.add_column("", no_wrap=True, min_width=9)
    for column in COLUMNS:
        grid.add_column(column, justify="right", no_wrap=True)
    for row in rows:
        grid.add_row(
            row.method,
            _share(row.precision),
            _share(row.recall),
            str(row.false_hits),
            str(row.missed),
            f"{row.tests:,.0f}",
            f"{row.microseconds:.1f}",
        )
    return grid


def _share(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def as_dict(row: Row) -> dict[str, str | int | float | None]:
    """A row with its ratios, for JSON and CSV."""
    ratios = {"method": row.method, "precision": row.precision, "recall": row.recall}
    return {**ratios, **asdict(row)}


def to_json(results: Sequence[PairResult], rows: Sequence[Row], settings: dict[str, float]) -> str:
    """One document: settings, pairs, all pairs together."""
    import json

    pairs = [
        {
            "pair": result.pair,
            "triangles": result.triangles,
            "hit_share": result.hit_share,
            "contained": result.contained,
            "methods": [as_dict(row) for row in result.rows],
        }
        for result in results
    ]
    document = {"settings": settings, "pairs": pairs, "overall": [as_dict(row) for row in rows]}
    return json.dumps(document, indent=1)


def write_csv(path: Path, results: Sequence[PairResult]) -> None:
    """Write a line for each pair and method."""
    import csv

    rows = [{"pair": result.pair, **as_dict(row)} for result in results for row in result.rows]
    with atomic(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def draw(path: Path, rows: Sequence[Row]) -> None:
    """Draw bars of precision and recall for each method."""
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
    with atomic(path) as partial:
        figure.savefig(partial, dpi=150)

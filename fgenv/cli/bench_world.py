"""``fgenv bench world``: many bodies, movers among them, motions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.options import Json, RatioPlot, Seed, file_option

if TYPE_CHECKING:
    from rich.console import Console

PACKAGES = ("fgenv", "python-fcl", "coal", "trimesh", "mujoco")
Quick = Annotated[
    bool, typer.Option("--quick", help="Run up to 1000 bodies and few motions: a minute.")
]
Curves = Annotated[
    Path | None, file_option("--curves", "Plot steps and tests over bodies to this file.")
]


def world(
    quick: Quick = False,
    curves: Curves = None,
    plot: RatioPlot = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Compare worlds of 10 to 100,000 bodies, movers among them, and certified motions.

    All pairs per step against python-fcl, coal, trimesh and MuJoCo; the cost of a mover's check
    and the pairs that its mask leaves; certified motions against discrete ones and FCL's
    continuous collision, with the errors of each.

    Needs the bench extra: pip install "fgenv\\[bench]".
    """
    from fgenv.bench.common.machine import package_versions
    from fgenv.bench.common.ratios import of_steps
    from fgenv.bench.world.report import plot as plot_curves
    from fgenv.bench.world.run import bench_world

    report = BenchReport(as_json, plot=plot, curves=curves)
    report.machine(package_versions(PACKAGES))

    rows = report.collect(lambda _: bench_world(seed=seed, quick=quick), show, "steps")
    report.plot_ratios(of_steps(rows["steps"]), "All pairs per step")
    if curves is not None:
        plot_curves(rows, curves)
    report.finish(settings={"seed": seed, "quick": quick}, **rows)


def show(console: Console, part: str, rows: list[dict[str, Any]]) -> None:
    """Print the tables of one part and their notes."""
    from fgenv.bench.world.report import NOTES, table_of

    for table in (part, "truths") if part == "motions" else (part,):
        console.print(table_of(table, rows))
        console.print(NOTES.get(table, ""), "", sep="\n")

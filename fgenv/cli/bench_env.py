"""``fgenv bench env``: steps of many robots in many worlds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.options import Json, RatioPlot, Seed

if TYPE_CHECKING:
    from rich.console import Console

Quick = Annotated[
    bool, typer.Option("--quick", help="Run short rounds with up to 32 worlds: half a minute.")
]


def env(
    quick: Quick = False,
    plot: RatioPlot = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Compare the batched simulator with VMAS navigation and MPE2 simple_spread.

    Robot-steps per CPU second, random actions, lidars of 12 rays, 4 and 10 robots in 1 to 1024
    worlds; then 64 carts in a warehouse, and the cost by number of robots.

    Needs the bench extra: pip install "fgenv\\[bench]".
    """
    from fgenv.bench.common.ratios import of_rates
    from fgenv.bench.common.records import geometric_means
    from fgenv.bench.env.libraries import installed, versions
    from fgenv.bench.env.run import bench_env

    report = BenchReport(as_json, plot=plot)
    report.machine(versions())

    rows = report.collect(lambda _: bench_env(installed(), seed=seed, quick=quick), show, "rates")
    report.plot_ratios(of_rates(rows["rates"]), "Robot-steps per CPU second")
    settings = {"seed": seed, "quick": quick}
    report.finish(settings=settings, **rows, summary=geometric_means(rows["rates"]))


def show(console: Console, part: str, rows: list[dict[str, Any]]) -> None:
    """Print the table of one part and its notes."""
    from fgenv.bench.env.report import NOTES, table_of

    console.print(table_of(part, rows))
    console.print(NOTES[part], "", sep="\n")

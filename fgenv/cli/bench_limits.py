"""``fgenv bench limits``: worst times of inputs at the limit of rounding."""

from __future__ import annotations

from typing import Annotated

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.options import Json, Seed
from fgenv.cli.progress import status

Count = Annotated[
    int, typer.Option("--count", min=10, help="Number of triangles that nearly coincide.")
]
Rounds = Annotated[int, typer.Option("--rounds", min=1, help="Number of runs per input.")]


def limits(
    count: Count = 20_000, rounds: Rounds = 3, seed: Seed = 0, as_json: Json = False
) -> None:
    """Print worst times of hard inputs.

    Flush motions, faces that nearly coincide, grazing rays, plans with a time
    limit, and the time from Ctrl-C to the end.
    """
    from rich.table import Table

    from fgenv.bench.limits.run import bench_limits

    report = BenchReport(as_json)
    report.machine()
    records = []
    with status("running") as update:
        for record in bench_limits(count=count, rounds=rounds, seed=seed):
            records.append(record)
            update(f"{len(records)} inputs done")
    shown = Table("input", "", "worst, ms", box=None)
    shown.columns[2].justify = "right"
    for record in records:
        shown.add_row(record["kind"], record["name"], f"{1e3 * record['worst']:.3f}")
    report.console.print(shown)
    report.finish(settings={"count": count, "rounds": rounds, "seed": seed}, limits=records)

"""``fgenv bench fleets``: plans for many robots over frozen sets."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.options import Json, SetCases, SharePlot
from fgenv.cli.progress import status

WhichFleets = Annotated[
    str, typer.Option("--fleets", help="all, or parts of fleets' names, with commas.")
]


def fleets(
    which: WhichFleets = "all",
    cases: SetCases = 100,
    plot: SharePlot = None,
    as_json: Json = False,
) -> None:
    """Plan frozen sets of many robots by each method: success rate, time, quality.

    Every counted plan is certified: the motion of all robots at once, as it is executed. The
    whole benchmark takes some hours; with --cases 10, minutes.
    """
    from fgenv.bench.fleets.report import NOTE, solved_shares, table_of
    from fgenv.bench.fleets.run import bench_fleets
    from fgenv.bench.fleets.sets import select_fleets

    report = BenchReport(as_json, plot=plot)
    fleets = select_fleets(which)
    report.machine()
    rows: list[dict[str, Any]] = []
    try:
        with status("planning") as update:
            for record in bench_fleets(fleets, cases):
                rows.append(record)
                solved = f"{record['solved']} of {record['cases']}"
                update(f"{record['fleet']}, {record['method']}: {solved}")
    finally:  # an interrupted benchmark reports its finished part
        report.console.print(table_of(rows))
        report.console.print(NOTE)
        report.plot_shares(solved_shares(rows), "solved, of cases")
        report.finish(cases=cases, rows=rows)

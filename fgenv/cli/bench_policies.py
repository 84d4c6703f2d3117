"""``fgenv bench policies``: collision avoidance of policies, against ORCA."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.options import Jobs, Json, SetCases, SharePlot
from fgenv.cli.progress import status

WhichSets = Annotated[
    str,
    typer.Option(
        "--sets",
        help="all, shipped (sets with an included policy), or parts of names, with commas.",
    ),
]


def policies(
    which: WhichSets = "shipped",
    cases: SetCases = 100,
    jobs: Jobs = 1,
    plot: SharePlot = None,
    as_json: Json = False,
) -> None:
    """Compare the included policies, with and without the safety filter, with ORCA on frozen sets.

    An episode succeeds if every robot reaches its goal in time without a collision. The cases are
    those of fgenv eval, from seed 1,000,000 on; training never uses them.
    """
    from fgenv.bench.policies.report import NOTES, success_shares, table_of
    from fgenv.bench.policies.run import run, select_trials

    report = BenchReport(as_json, plot=plot)
    trials, rows = select_trials(which), list[dict[str, Any]]()
    try:
        with status("running") as update:
            for k, trial in enumerate(trials):
                update(f"{trial.name}, {k + 1} of {len(trials)}")
                rows += run(trial, cases, jobs)
    finally:  # an interrupted benchmark reports its finished part
        report.console.print(table_of(rows, cases))
        report.console.print(*NOTES, sep="\n")
        report.plot_shares(success_shares(rows), "success, of episodes")
        report.finish(cases=cases, rows=rows)

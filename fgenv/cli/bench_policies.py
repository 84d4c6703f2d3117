"""``fgenv bench policies``: collision avoidance of policies, against ORCA."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.options import Jobs, Json, SetCases, SharePlot

if TYPE_CHECKING:
    from rich.table import Table

WhichSets = Annotated[
    str,
    typer.Option(
        "--sets",
        help="all, shipped (sets with an included policy), or parts of names, with commas.",
    ),
]
COLUMNS = ("policy", "success", "collide", "late", "extra time *")
NOTES = (
    "success: of episodes, with its 95 % interval; collide, late: of robots",
    "* seconds more than straight, where all policies of the set succeed",
)


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
    from fgenv.bench.policies.run import chosen, run
    from fgenv.view.figures import interval_plot

    report = BenchReport(as_json, plot=plot)
    trials, rows = chosen(which), list[dict[str, Any]]()
    try:
        with report.console.status("running") as status:
            for k, trial in enumerate(trials):
                status.update(f"{trial.name}, {k + 1} of {len(trials)}")
                rows += run(trial, cases, jobs)
    finally:  # an interrupted benchmark reports its finished part
        report.console.print(table_of(rows, cases))
        for note in NOTES:
            report.console.print(note)
        if plot is not None and rows:
            interval_plot.plot_shares(success_shares(rows), "success, of episodes", plot)
        report.finish(cases=cases, rows=rows)


def table_of(rows: list[dict[str, Any]], cases: int) -> Table:
    """Return a table with the sets and the results of their policies."""
    from rich.table import Table

    table = Table(title=f"{cases} cases each", box=None, title_justify="left")
    for title in COLUMNS:
        left = title == "policy"
        table.add_column(title, justify="left" if left else "right", no_wrap=True)
    for row in rows:
        if row["policy"] == rows[0]["policy"]:
            table.add_row(row["set"], f"expected {row['goal']:.2f}")
        table.add_row(*cells(row))
    return table


def cells(row: dict[str, Any]) -> tuple[str, ...]:
    """Return the cells of a policy's row."""
    success = row["success"]
    return (
        f"  {row['policy']}",
        f"{success.value:.2f} [{success.low:.2f}, {success.high:.2f}]",
        f"{row['robot_collision']:.3f}",
        f"{row['time_out']:.3f}",
        f"{row['extra_time'].value:.2f}" if row["shared"] else "-",
    )


def success_shares(rows: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Return the success by set and kind of policy: the files of policies share one color."""
    shares: dict[str, dict[str, Any]] = {}
    for row in rows:
        name = row["policy"]
        kind = name if name.startswith("orca") else name.rpartition(":")[0]
        shares.setdefault(row["set"], {})[kind] = row["success"]
    return shares

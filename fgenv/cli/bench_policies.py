"""``fgenv bench policies``: how policies avoid each other, against ORCA."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from fgenv.cli.options import Json, Shares


def policies(
    which: Annotated[
        str,
        typer.Option(
            "--sets",
            help="all, shipped (a policy comes along for it), or parts of names, with commas.",
        ),
    ] = "shipped",
    cases: Annotated[int, typer.Option("--cases", min=1, help="Of each frozen set.")] = 100,
    jobs: Annotated[
        int, typer.Option("--jobs", min=1, max=256, help="Processes; results are the same.")
    ] = 1,
    plot: Shares = None,
    as_json: Json = False,
) -> None:
    """Policies that come along, the same behind the safety filter, and ORCA, on frozen sets.

    An episode is a success if every robot comes to its goal in time and meets nothing. Cases are
    those of fgenv eval, from seed 1,000,000 on; no training saw them.
    """
    from rich.console import Console
    from rich.table import Table

    from fgenv.bench.policies.run import chosen, run
    from fgenv.view.figures import interval_plot
    from fgenv.view.figures.canvas import check_plot_path

    if plot is not None:
        check_plot_path(plot, "--plot")
    console = Console(stderr=as_json, highlight=False)
    trials, done = chosen(which), list[dict[str, Any]]()
    try:
        with console.status("running") as status:
            for k, trial in enumerate(trials):
                status.update(f"{trial.name}, {k + 1} of {len(trials)}")
                done += run(trial, cases, jobs)
    finally:  # interrupted, what there is by then is told
        table = Table(title=f"{cases} cases each", box=None, title_justify="left")
        for title in ("policy", "success", "collide", "late", "extra time *"):
            left = title == "policy"
            table.add_column(title, justify="left" if left else "right", no_wrap=True)
        for r in done:
            if r["policy"] == done[0]["policy"]:
                table.add_row(r["set"], f"expected {r['goal']:.2f}")
            table.add_row(*row(r))
        console.print(table)
        console.print("success: of episodes, with its 95 % interval; collide, late: of robots")
        console.print("* seconds more than straight, where all policies of the set succeed")
        if plot is not None and done:
            found: dict[str, dict[str, Any]] = {}
            for r in done:  # all that come along in one color, and all that are filtered
                name = r["policy"]
                kind = name if name.startswith("orca") else name.rpartition(":")[0]
                found.setdefault(r["set"], {})[kind] = r["success"]
            interval_plot.plot_shares(found, "success, of episodes", plot)
        if as_json:
            typer.echo(json.dumps({"cases": cases, "rows": done}, indent=1))


def row(r: dict[str, Any]) -> tuple[str, ...]:
    """A policy's line of the table."""
    share = r["success"]
    return (
        f"  {r['policy']}",
        f"{share.value:.2f} [{share.low:.2f}, {share.high:.2f}]",
        f"{r['robot_collision']:.3f}",
        f"{r['time_out']:.3f}",
        f"{r['extra_time'].value:.2f}" if r["shared"] else "-",
    )

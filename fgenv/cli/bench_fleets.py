"""``fgenv bench fleets``: plans for many robots over frozen sets."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from fgenv.cli.options import Json, Shares


def fleets(
    which: Annotated[
        str, typer.Option("--fleets", help="all, or parts of fleets' names, with commas.")
    ] = "all",
    cases: Annotated[int, typer.Option("--cases", min=1, help="Of each frozen set.")] = 100,
    plot: Shares = None,
    as_json: Json = False,
) -> None:
    """Plan frozen sets of many robots by each method: how many are solved, how fast, how well.

    Every plan that counts is certified: the motion of all robots at once, as it is executed. All
    of it takes some hours; --cases 10 minutes.
    """
    from rich.console import Console

    from fgenv.bench.fleets.report import NOTE, table_of
    from fgenv.bench.fleets.run import bench_fleets
    from fgenv.bench.fleets.sets import chosen
    from fgenv.bench.pairs.run import machine
    from fgenv.confidence import rate
    from fgenv.view.figures import interval_plot
    from fgenv.view.figures.canvas import check_plot_path

    if plot is not None:
        check_plot_path(plot, "--plot")
    console = Console(stderr=as_json, highlight=False)
    fleets = chosen(which)
    about = machine()
    console.print(f"{about['processor']}, {about['cores']} cores, {about['system']},", end=" ")
    console.print(f"Python {about['python']}, NumPy {about['numpy']}")
    done: list[dict[str, Any]] = []
    try:
        with console.status("planning") as status:
            for record in bench_fleets(fleets, cases):
                done.append(record)
                solved = f"{record['solved']} of {record['cases']}"
                status.update(f"{record['fleet']}, {record['method']}: {solved}")
    finally:  # interrupted, what there is by then is told
        console.print(table_of(done))
        console.print(NOTE)
        if plot is not None and done:
            found: dict[str, dict[str, Any]] = {}
            for r in done:
                found.setdefault(r["fleet"], {})[r["method"]] = rate(r["solved"], r["cases"])
            interval_plot.plot_shares(found, "solved, of cases", plot)
        if as_json:
            typer.echo(json.dumps({"machine": about, "cases": cases, "rows": done}, indent=1))

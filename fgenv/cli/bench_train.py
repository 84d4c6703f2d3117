"""``fgenv bench train``: samples per CPU second while a policy learns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.options import Json, RatioPlot, Seed

if TYPE_CHECKING:
    from rich.table import Table

Rounds = Annotated[int, typer.Option("--rounds", min=1, help="Number of rounds.")]


def train(
    rounds: Rounds = 3,
    plot: RatioPlot = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Compare our rows for Stable-Baselines3 with SuperSuit's, same environment, same PPO.

    Samples per CPU second on one thread: swap with 8 robots, 32 worlds, the default network.

    Needs the agents and bench extras: pip install "fgenv\\[agents,bench]".
    """
    from fgenv.bench.common.ratios import of_training
    from fgenv.bench.train.run import bench_train
    from fgenv.view.figures import bars

    report = BenchReport(as_json, plot=plot)
    report.machine()
    with report.console.status("learning") as status:
        records = bench_train(rounds=rounds, seed=seed, progress=status.update)
    report.console.print(table_of(records))
    report.console.print(
        "gathered: the environment and the policy's actions; learned from: all of PPO"
    )
    if plot is not None:
        bars.plot_ratios(of_training(records), "Samples in a CPU second", plot)
    report.finish(seed=seed, rates=records)


def table_of(records: list[dict[str, Any]]) -> Table:
    """Return the table of rates."""
    from rich.table import Table

    table = Table(title="Samples in a CPU second", box=None, title_justify="left")
    for name in ("rows by", "rows", "gathered", "learned from"):
        table.add_column(name, justify="left" if name == "rows by" else "right")
    for r in records:
        table.add_row(r["name"], f"{r['rows']:,}", f"{r['gather']:,.0f}", f"{r['learn']:,.0f}")
    return table

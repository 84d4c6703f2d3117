"""``fgenv bench train``: samples in a CPU second while a policy learns."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from fgenv.cli.options import Bars, Json, Seed


def train(
    rounds: Annotated[int, typer.Option("--rounds", min=1, help="Counted rounds.")] = 3,
    plot: Bars = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Race our rows for Stable-Baselines3 against SuperSuit's, same environment, same PPO.

    Samples in a CPU second on one thread: swap with 8 robots, 32 worlds, the default network.

    Needs the agents and bench extras: pip install "fgenv\\[agents,bench]".
    """
    from rich.console import Console
    from rich.table import Table

    from fgenv.bench.common.ratios import of_training
    from fgenv.bench.pairs.run import machine
    from fgenv.bench.train.run import bench_train
    from fgenv.view.figures import bars
    from fgenv.view.figures.canvas import check_plot_path

    if plot is not None:
        check_plot_path(plot, "--plot")
    console = Console(stderr=as_json, highlight=False)
    about = machine()
    console.print(f"{about['processor']}, {about['cores']} cores, {about['system']}")
    with console.status("learning") as status:
        records = bench_train(rounds=rounds, seed=seed, progress=status.update)
    table = Table(title="Samples in a CPU second", box=None, title_justify="left")
    for name in ("rows by", "rows", "gathered", "learned from"):
        table.add_column(name, justify="left" if name == "rows by" else "right")
    for r in records:
        table.add_row(r["name"], f"{r['rows']:,}", f"{r['gather']:,.0f}", f"{r['learn']:,.0f}")
    console.print(table)
    console.print("gathered: the environment and the policy's actions; learned from: all of PPO")
    if plot is not None:
        bars.plot_ratios(of_training(records), "Samples in a CPU second", plot)
    if as_json:
        typer.echo(json.dumps({"machine": about, "seed": seed, "rates": records}, indent=1))

"""``fgenv bench train``: samples per CPU second while a policy learns."""

from __future__ import annotations

from typing import Annotated

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.options import Json, RatioPlot, Seed
from fgenv.cli.progress import status

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
    from fgenv.bench.common.tables import count, table, text
    from fgenv.bench.train.run import bench_train

    report = BenchReport(as_json, plot=plot)
    report.machine()
    with status("learning") as update:
        records = bench_train(rounds=rounds, seed=seed, progress=update)
    columns = {
        "rows by": ("name", text),
        "rows": ("rows", count),
        "gathered": ("gather", count),
        "learned from": ("learn", count),
    }
    report.console.print(table("Samples per CPU second", columns, records))
    report.console.print(
        "gathered: the environment and the policy's actions; learned from: all of PPO"
    )
    report.plot_ratios(of_training(records), "Samples per CPU second")
    report.finish(seed=seed, rates=records)

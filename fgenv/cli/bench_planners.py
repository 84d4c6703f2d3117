"""``fgenv bench planners``: OMPL on fgenv's checks, and on checkers in Python."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.options import Json, RatioPlot, Seed

if TYPE_CHECKING:
    from rich.console import Console

Problems = Annotated[
    str,
    typer.Option(
        "--problems",
        help="Scenarios with commas, NAME or NAME:ROBOTS.",
        show_default="cubicles,twist,home,cubicles:2",
    ),
]
Seeds = Annotated[int, typer.Option("--seeds", min=1, help="Number of searches per problem.")]
TimeLimit = Annotated[float, typer.Option("--time-limit", help="CPU seconds per search.")]
Resolution = Annotated[
    float | None,
    typer.Option(
        "--resolution",
        help="Distance between discrete checks in meters.",
        show_default="1 % of the room",
    ),
]
Peers = Annotated[str, typer.Option("--peers", help="Names of libraries, with commas.")]
Traps = Annotated[
    bool, typer.Option("--traps", help="Also run bug_trap and rings: up to 40 minutes.")
]
Mbm = Annotated[
    int | None,
    typer.Option(
        "--mbm",
        min=0,
        max=100,
        help="Number of MotionBenchMaker problems per family, of 7; needs pinocchio.",
        show_default="3 where pinocchio is installed",
    ),
]
Quick = Annotated[
    bool, typer.Option("--quick", help="Run cubicles, 2 seeds, 5 s, no arms: a few seconds.")
]


def planners(
    problems: Problems = "",
    seeds: Seeds = 10,
    time_limit: TimeLimit = 60.0,
    resolution: Resolution = None,
    peers: Peers = "python-fcl,coal",
    traps: Traps = False,
    mbm: Mbm = None,
    quick: Quick = False,
    plot: RatioPlot = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Compare OMPL on fgenv's plug-in with OMPL on Python checkers of python-fcl and coal.

    RRTConnect, the same seeds, space and range: time to the first solution, checks of the very
    same edges, OMPL's own time, and collisions in solutions that a finer check finds.

    Needs the bench extra: pip install "fgenv\\[bench]".
    """
    from fgenv.bench.common.machine import package_versions
    from fgenv.bench.common.ratios import of_problems
    from fgenv.bench.common.selection import split_names
    from fgenv.bench.planners.run import PlannerBenchConfig, bench_planners

    report = BenchReport(as_json, plot=plot)
    options: dict[str, Any] = {"resolution": resolution, "traps": traps, "mbm": mbm}
    options |= {"limit": time_limit, "peers": split_names(peers)}
    options["seeds"] = tuple(range(seed, seed + seeds))
    if quick:
        options |= {"problems": ("cubicles",), "seeds": (seed, seed + 1), "limit": 5.0}
        options["mbm"] = mbm or 0
    if problems:
        options["problems"] = split_names(problems)
    config = PlannerBenchConfig(**options)
    config.check()
    packages = ("fgenv", "ompl", *config.peers, *(("pin",) if config.arms else ()))
    report.machine(package_versions(packages))
    rows = report.collect(lambda progress: bench_planners(config, progress), show, "building")
    report.plot_ratios(of_problems(rows["problems"]), "Time to the first solution")
    report.finish(settings=asdict(config), **rows)


def show(console: Console, part: str, rows: list[dict[str, Any]]) -> None:
    """Print the tables of one part and their notes."""
    from fgenv.bench.planners.report import tables_of

    for table, note in tables_of(part, rows):
        console.print(table)
        console.print(note, "", sep="\n")

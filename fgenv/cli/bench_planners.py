"""``fgenv bench planners``: OMPL on fgenv's checks, and on checkers in Python."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Annotated, Any

import typer

from fgenv.cli.options import Bars, Json, Seed


def planners(
    problems: Annotated[
        str,
        typer.Option(
            "--problems",
            help="Scenarios with commas, NAME or NAME:ROBOTS.",
            show_default="cubicles,twist,home,cubicles:2",
        ),
    ] = "",
    seeds: Annotated[int, typer.Option("--seeds", min=1, help="Searches of each problem.")] = 10,
    time_limit: Annotated[
        float, typer.Option("--time-limit", help="CPU seconds of a search.")
    ] = 60.0,
    resolution: Annotated[
        float | None,
        typer.Option(
            "--resolution",
            help="Meters a step of discrete checks.",
            show_default="1 % of the room",
        ),
    ] = None,
    peers: Annotated[
        str, typer.Option("--peers", help="Libraries with commas.")
    ] = "python-fcl,coal",
    traps: Annotated[
        bool, typer.Option("--traps", help="Also bug_trap and rings: up to 40 minutes.")
    ] = False,
    mbm: Annotated[
        int | None,
        typer.Option(
            "--mbm",
            min=0,
            max=100,
            help="MotionBenchMaker's problems of each of 7 families; needs pinocchio.",
            show_default="3 where pinocchio is installed",
        ),
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="cubicles, 2 seeds, 5 s, no arms: a few seconds.")
    ] = False,
    plot: Bars = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Race OMPL on fgenv's plug-in against OMPL with Python checkers on python-fcl and coal.

    RRTConnect, the same seeds, space and range: time to the first solution, the very same edges
    asked again, what OMPL itself takes, and collisions hidden in solutions on a finer look.

    Needs the bench extra: pip install "fgenv\\[bench]".
    """
    from importlib.metadata import version

    from rich.console import Console

    from fgenv.bench.common.ratios import of_problems
    from fgenv.bench.pairs.run import machine
    from fgenv.bench.planners.run import PlannerBenchConfig, bench_planners
    from fgenv.view.figures import bars
    from fgenv.view.figures.canvas import check_plot_path

    if plot is not None:
        check_plot_path(plot, "--plot")
    console = Console(stderr=as_json, highlight=False)
    given: dict[str, Any] = {"resolution": resolution, "traps": traps, "mbm": mbm}
    given |= {
        "limit": time_limit,
        "seeds": tuple(range(seed, seed + seeds)),
        "peers": listed(peers),
    }
    if quick:
        given |= {"problems": ("cubicles",), "seeds": (seed, seed + 1), "limit": 5.0}
        given["mbm"] = mbm or 0
    if problems:
        given["problems"] = listed(problems)
    config = PlannerBenchConfig(**given)
    config.check()
    about = machine()
    packages = ("fgenv", "ompl", *config.peers, *(("pin",) if config.arms else ()))
    versions = {name: version(name) for name in packages}
    console.print(f"{about['processor']}, {about['cores']} cores, {about['system']},", end=" ")
    console.print(f"Python {about['python']}, NumPy {about['numpy']}")
    console.print(", ".join(f"{name} {number}" for name, number in versions.items()))
    done: dict[str, list[dict[str, Any]]] = {}
    with console.status("building") as status:
        for kind, record in bench_planners(config, status.update):
            if done and kind not in done:
                show(console, list(done)[-1], done)
            done.setdefault(kind, []).append(record)
    show(console, list(done)[-1], done)
    if plot is not None:
        bars.plot_ratios(of_problems(done["problems"]), "Time to the first solution", plot)
    if as_json:
        document = {"machine": about, "versions": versions, "settings": asdict(config), **done}
        typer.echo(json.dumps(document, indent=1))


def listed(names: str) -> tuple[str, ...]:
    """What stands between commas."""
    return tuple(name.strip() for name in names.split(",") if name.strip())


def show(console: Any, kind: str, done: dict[str, list[dict[str, Any]]]) -> None:
    """The tables of one part and what their columns mean."""
    from fgenv.bench.planners.report import tables_of

    for table, note in tables_of(kind, done[kind]):
        console.print(table)
        console.print(note, "", sep="\n")

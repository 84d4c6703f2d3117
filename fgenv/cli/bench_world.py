"""``fgenv bench world``: many bodies, movers among them, motions."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from fgenv.cli.options import Bars, Json, Seed


def world(
    quick: Annotated[
        bool, typer.Option("--quick", help="Up to 1000 bodies and few motions: a minute.")
    ] = False,
    curves: Annotated[
        Path | None,
        typer.Option("--curves", dir_okay=False, help="Draw steps and tests over bodies to this."),
    ] = None,
    plot: Bars = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Race worlds of 10 to 100,000 bodies, movers among them, and certified motions.

    All pairs a step against python-fcl, coal, trimesh and MuJoCo; what a mover's check costs
    and how many pairs its mask leaves; certified motions against discrete ones and against
    FCL's continuous collision, with what each gets wrong.

    Needs the bench extra: pip install "fgenv\\[bench]".
    """
    from importlib.metadata import version

    from rich.console import Console

    from fgenv.bench.common.ratios import of_steps
    from fgenv.bench.pairs.run import machine
    from fgenv.bench.world import report
    from fgenv.bench.world.run import bench_world
    from fgenv.view.figures import bars
    from fgenv.view.figures.canvas import check_plot_path

    for option, path in (("--plot", plot), ("--curves", curves)):
        if path is not None:
            check_plot_path(path, option)
    console = Console(stderr=as_json, highlight=False)
    about = machine()
    packages = ("fgenv", "python-fcl", "coal", "trimesh", "mujoco")
    versions = {name: version(name) for name in packages}
    console.print(f"{about['processor']}, {about['cores']} cores, {about['system']},", end=" ")
    console.print(f"Python {about['python']}, NumPy {about['numpy']}")
    console.print(", ".join(f"{name} {number}" for name, number in versions.items()))
    done: dict[str, list[dict[str, Any]]] = {}
    with console.status("steps") as status:
        for kind, record in bench_world(seed=seed, quick=quick):
            if done and kind not in done:
                show(console, list(done)[-1], done)
            done.setdefault(kind, []).append(record)
            status.update(f"{kind}: {len(done[kind])} done")
    show(console, list(done)[-1], done)
    if plot is not None:
        bars.plot_ratios(of_steps(done["steps"]), "All pairs a step", plot)
    if curves is not None:
        report.plot(done, curves)
    if as_json:
        settings = {"seed": seed, "quick": quick}
        document = {"machine": about, "versions": versions, "settings": settings, **done}
        typer.echo(json.dumps(document, indent=1))


def show(console: Any, kind: str, done: dict[str, list[dict[str, Any]]]) -> None:
    """The tables of one part and what their columns mean."""
    from fgenv.bench.world.report import NOTES, table_of

    for table in (kind, "truths") if kind == "motions" else (kind,):
        console.print(table_of(table, done[kind]))
        console.print(NOTES.get(table, ""), "", sep="\n")

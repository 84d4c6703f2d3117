"""``fgenv bench``: measurements against other libraries."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from fgenv.cli import (
    bench_env,
    bench_fleets,
    bench_planners,
    bench_policies,
    bench_train,
    bench_world,
)
from fgenv.cli.options import Bars, Json, Seed

app = typer.Typer(
    name="bench",
    help="Race fgenv against other libraries. Each race has options of its own, --seed and "
    "--json among them: fgenv bench pairs --help, fgenv bench env --help.",
    rich_markup_mode="rich",
    no_args_is_help=True,
)
app.command()(bench_world.world)
app.command()(bench_env.env)
app.command()(bench_planners.planners)
app.command()(bench_fleets.fleets)
app.command()(bench_train.train)
app.command()(bench_policies.policies)


@app.command("pairs")
def bench(
    which: Annotated[
        str, typer.Option("--pairs", help="all, quick, or part of a pair's name.")
    ] = "all",
    peers: Annotated[
        str, typer.Option("--peers", help="Names with commas.", show_default="all installed")
    ] = "",
    poses: Annotated[int, typer.Option("--poses", min=10, help="Poses a pair.")] = 4000,
    near: Annotated[
        bool, typer.Option("--near", help="Only poses close to contact, the hardest ones.")
    ] = False,
    threads: Annotated[
        bool, typer.Option("--threads/--no-threads", help="Also race two threads against one.")
    ] = True,
    curves: Annotated[
        Path | None,
        typer.Option("--curves", dir_okay=False, help="Draw µs a query over triangles to this."),
    ] = None,
    plot: Bars = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Race fgenv against the other collision libraries on real meshes, same poses, one process.

    Needs the bench extra: pip install "fgenv\\[bench]".

    The libraries take turns on small chunks of poses; shown are medians over rounds.
    """
    from rich.console import Console

    from fgenv.bench.common.ratios import of_pairs
    from fgenv.bench.pairs.catalog import chosen
    from fgenv.bench.pairs.report import NOTE, peer_table, plot_times, ratio_table
    from fgenv.bench.pairs.run import bench_pairs, machine, summary
    from fgenv.bench.peers import peer, selected
    from fgenv.view.figures import bars
    from fgenv.view.figures.canvas import check_plot_path

    console = Console(stderr=as_json)
    chosen(which)  # a wrong name is told before anything is printed
    names = selected(peers)
    for option, path in (("--plot", plot), ("--curves", curves)):
        if path is not None:
            check_plot_path(path, option)
    versions = {name: peer(name).version for name in names}
    about = machine()
    console.print(f"{about['processor']}, {about['cores']} cores, {about['system']},", end=" ")
    console.print(f"Python {about['python']}, NumPy {about['numpy']}", highlight=False)
    console.print(", ".join(f"{name} {version}" for name, version in versions.items()))
    records = []
    with console.status("loading meshes, drawing poses") as status:
        for record in bench_pairs(
            which=which, peers=names, poses=poses, seed=seed, near=near, threads=threads
        ):
            records.append(record)
            console.print(peer_table(record))
            status.update(f"{len(records)} pairs done")
    overall = summary(records)
    if overall:
        console.print(ratio_table(records, overall))
    console.print(NOTE)
    if plot is not None:
        bars.plot_ratios(of_pairs(records), "A query, poses in one batch", plot)
    if curves is not None:
        plot_times(records, curves)
    if as_json:
        document = {
            "machine": about,
            "versions": versions,
            "settings": {"poses": poses, "seed": seed, "near": near},
            "pairs": records,
            "summary": overall,
        }
        typer.echo(json.dumps(document, indent=1))

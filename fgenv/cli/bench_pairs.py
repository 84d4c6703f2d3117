"""``fgenv bench pairs``: queries of two meshes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.options import Json, RatioPlot, Seed, file_option
from fgenv.cli.progress import status

WhichPairs = Annotated[str, typer.Option("--pairs", help="all, quick, or part of a pair's name.")]
Peers = Annotated[
    str,
    typer.Option("--peers", help="Names of libraries, with commas.", show_default="all installed"),
]
Poses = Annotated[int, typer.Option("--poses", min=10, help="Number of poses per pair.")]
Near = Annotated[
    bool, typer.Option("--near", help="Use only poses close to contact, the hardest ones.")
]
Threads = Annotated[
    bool, typer.Option("--threads/--no-threads", help="Also compare two threads with one.")
]
Curves = Annotated[
    Path | None, file_option("--curves", "Plot µs per query over triangles to this file.")
]


def pairs(
    which: WhichPairs = "all",
    peers: Peers = "",
    poses: Poses = 4000,
    near: Near = False,
    threads: Threads = True,
    curves: Curves = None,
    plot: RatioPlot = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Compare fgenv with the other collision libraries: real meshes, same poses, one process.

    Needs the bench extra: pip install "fgenv\\[bench]".

    The libraries take turns on small batches of poses; the results are medians over rounds.
    """
    from fgenv.bench.common.ratios import of_pairs
    from fgenv.bench.common.records import geometric_means
    from fgenv.bench.pairs.catalog import select_pairs
    from fgenv.bench.pairs.report import NOTE, peer_table, plot_times, ratio_table
    from fgenv.bench.pairs.run import bench_pairs
    from fgenv.bench.peers import peer, selected

    select_pairs(which)  # reports a wrong name before anything is printed
    names = selected(peers)
    report = BenchReport(as_json, plot=plot, curves=curves)
    report.machine({name: peer(name).version for name in names})
    options: dict[str, Any] = {"poses": poses, "seed": seed, "near": near}
    records = []
    with status("loading meshes, drawing poses") as update:
        for record in bench_pairs(which=which, peers=names, threads=threads, **options):
            records.append(record)
            report.console.print(peer_table(record))
            update(f"{len(records)} pairs done")
    overall = geometric_means(records)
    if overall:
        report.console.print(ratio_table(records, overall))
    report.console.print(NOTE)
    report.plot_ratios(of_pairs(records), "A query, poses in one batch")
    if curves is not None:
        plot_times(records, curves)
    report.finish(settings=options, pairs=records, summary=overall)

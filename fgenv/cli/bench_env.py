"""``fgenv bench env``: steps of many robots in many worlds."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from fgenv.cli.options import Bars, Json, Seed


def env(
    quick: Annotated[
        bool, typer.Option("--quick", help="Short rounds, up to 32 worlds: half a minute.")
    ] = False,
    plot: Bars = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Race the batched simulator against VMAS navigation and MPE2 simple_spread.

    Robot-steps in a CPU second, random actions, lidars of 12 rays, 4 and 10 robots in 1 to 1024
    worlds; then 64 carts in a warehouse, and how the cost grows with the robots.

    Needs the bench extra: pip install "fgenv\\[bench]".
    """
    from rich.console import Console

    from fgenv.bench.common.ratios import of_rates
    from fgenv.bench.env.peers import peers, versions
    from fgenv.bench.env.run import bench_env
    from fgenv.bench.pairs.run import machine, summary
    from fgenv.view.figures import bars
    from fgenv.view.figures.canvas import check_plot_path

    if plot is not None:
        check_plot_path(plot, "--plot")
    console = Console(stderr=as_json, highlight=False)
    about, numbers = machine(), versions()
    console.print(f"{about['processor']}, {about['cores']} cores, {about['system']},", end=" ")
    console.print(f"Python {about['python']}, NumPy {about['numpy']}")
    console.print(", ".join(f"{name} {number}" for name, number in numbers.items()))
    done: dict[str, list[dict[str, Any]]] = {}
    with console.status("rates") as status:
        for kind, record in bench_env(peers(), seed=seed, quick=quick):
            if done and kind not in done:
                show(console, list(done)[-1], done)
            done.setdefault(kind, []).append(record)
            status.update(f"{kind}: {len(done[kind])} done")
    show(console, list(done)[-1], done)
    if plot is not None:
        bars.plot_ratios(of_rates(done["rates"]), "Robot-steps in a CPU second", plot)
    if as_json:
        document = {
            "machine": about,
            "versions": numbers,
            "settings": {"seed": seed, "quick": quick},
            **done,
            "summary": summary(done["rates"]),
        }
        typer.echo(json.dumps(document, indent=1))


def show(console: Any, kind: str, done: dict[str, list[dict[str, Any]]]) -> None:
    """The table of one part and what its columns mean."""
    from fgenv.bench.env.report import NOTES, table_of

    console.print(table_of(kind, done[kind]))
    console.print(NOTES[kind], "", sep="\n")

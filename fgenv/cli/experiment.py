"""``fgenv run three_tanks``: the published experiment."""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import typer

from fgenv.cli.errors import FAILED_CHECK


def run_published(
    mesh: Path | None,
    scale: float,
    step: float,
    out: Path,
    pictures: bool,
    seed: int,
    as_json: bool,
) -> None:
    """Run and print the experiment; exit with FAILED_CHECK unless it comes out as published."""
    from rich.console import Console

    from fgenv.paper.experiment import run_experiment
    from fgenv.paper.figures import FIGURES, draw_figures
    from fgenv.paper.report import Report, as_data
    from fgenv.paper.scene import three_tanks

    if not 0 < step <= 1:
        raise ValueError(f"--step: got {step}, expected meters, above 0 and not above 1")
    if not 0 < scale < float("inf"):
        raise ValueError(f"--scale: got {scale}, expected a factor above 0")
    report = Report(Console(stderr=as_json, highlight=False))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        problem = three_tanks(mesh, scale=scale)
    report.heading(problem, seed, [str(warning.message) for warning in caught])
    with report.console.status("driving"):
        experiment = run_experiment(problem, seed=seed, step=step, report=report.progress)
    report.results(experiment)
    written: list[str] = []
    if pictures:
        with report.console.status("drawing") as status:
            for path in draw_figures(experiment, out):
                written.append(str(path))
                status.update(f"drawing, {len(written)} of {len(FIGURES)} done")
        report.console.print(f"{len(written)} pictures in {out}/")
    if as_json:
        typer.echo(json.dumps(as_data(experiment, seed, written), indent=1))
    if not experiment.as_published:
        raise typer.Exit(FAILED_CHECK)

"""``fgenv run three_tanks``: the published experiment."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from fgenv.cli.console import console_of
from fgenv.cli.errors import FAILED_CHECK
from fgenv.cli.progress import status

if TYPE_CHECKING:
    from rich.console import Console

    from fgenv.paper.experiment import Experiment


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

    from fgenv.paper.experiment import run_experiment
    from fgenv.paper.report import ConsoleReport, as_data
    from fgenv.paper.scene import three_tanks

    if not 0 < step <= 1:
        raise ValueError(f"--step: got {step}, expected meters, above 0 and not above 1")
    if not 0 < scale < float("inf"):
        raise ValueError(f"--scale: got {scale}, expected a factor above 0")
    report = ConsoleReport(console_of(as_json))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        problem = three_tanks(mesh, scale=scale)
    report.heading(problem, seed, [str(warning.message) for warning in caught])
    with status("driving"):
        experiment = run_experiment(problem, seed=seed, step=step, report=report.progress)
    report.results(experiment)
    written = draw(report.console, experiment, out) if pictures else []
    if as_json:
        typer.echo(json.dumps(as_data(experiment, seed, written), indent=1))
    if not experiment.as_published:
        raise typer.Exit(FAILED_CHECK)


def draw(console: Console, experiment: Experiment, folder: Path) -> list[str]:
    """Draw the paper's figures into a folder; returns their paths."""
    from fgenv.paper.figures import FIGURES, draw_figures

    written: list[str] = []
    with status("drawing") as update:
        for path in draw_figures(experiment, folder):
            written.append(str(path))
            update(f"drawing, {len(written)} of {len(FIGURES)} done")
    console.print(f"{len(written)} pictures in {folder}/")
    return written

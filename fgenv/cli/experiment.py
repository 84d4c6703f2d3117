"""``fgenv run three_tanks``: the published experiment, told as it happens."""

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
    """Run it; ends with FAILED_CHECK where it does not come out as published."""
    from rich.console import Console

    from fgenv.agents import facts, run_experiment
    from fgenv.cli.experiment_report import Account
    from fgenv.paper.figures import FIGURES, draw_figures
    from fgenv.scenarios import three_tanks

    if not 0 < step <= 1:
        raise ValueError(f"--step: got {step}, want meters, above 0 and not above 1")
    if not 0 < scale < float("inf"):
        raise ValueError(f"--scale: got {scale}, want a factor above 0")
    account = Account(Console(stderr=as_json, highlight=False))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scene = three_tanks(mesh, scale=scale)
    account.begin(scene, seed, [str(warning.message) for warning in caught])
    with account.console.status("driving"):
        experiment = run_experiment(scene, seed=seed, step=step, report=account.tell)
    account.end(experiment)
    written: list[str] = []
    if pictures:
        with account.console.status("drawing") as status:
            for path in draw_figures(experiment, out):
                written.append(str(path))
                status.update(f"drawing, {len(written)} of {len(FIGURES)} done")
        account.console.print(f"{len(written)} pictures in {out}/")
    if as_json:
        typer.echo(json.dumps(facts(experiment, written), indent=1))
    if not experiment.as_published:
        raise typer.Exit(FAILED_CHECK)

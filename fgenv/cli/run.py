"""``fgenv run``: the published experiment, told as it happens."""

from __future__ import annotations

import json
import warnings
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from fgenv.cli.errors import FAILED_CHECK
from fgenv.cli.options import Json, Out, Seed


class Scenario(StrEnum):
    """What to run."""

    THREE_TANKS = "three_tanks"


def run(
    scenario: Annotated[
        Scenario, typer.Argument(help="three_tanks: one mobile robot, three tanks in its way.")
    ],
    mesh: Annotated[
        Path | None,
        typer.Option(
            "--mesh",
            show_default="the built-in robot",
            help="Your own robot: STL, OBJ, PLY, OFF, GLB or DAE, z up, x forward.",
        ),
    ] = None,
    scale: Annotated[
        float, typer.Option("--scale", help="Factor of the mesh to metres; 0.001 for millimetres.")
    ] = 1.0,
    step: Annotated[
        float, typer.Option("--step", help="Metres that the robot moves between two tests.")
    ] = 0.01,
    out: Out = Path("out/three_tanks"),
    pictures: Annotated[
        bool, typer.Option("--pictures/--no-pictures", help="Draw the paper's figures.")
    ] = True,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Run the published experiment and say whether it came out as published.

    The robot takes the straight path to its goal. Its motion box sets the
    collision masks. The collision with tank 2 is found by its feature graph
    and announced as it happens; the masks return to 0. Then OMPL's RRTConnect
    plans a path around it, which is driven to the goal.

    Exit code 0 if all came out as published, 1 if not.
    """
    from rich.console import Console

    from fgenv.agents import facts, run_experiment
    from fgenv.cli.account import Account
    from fgenv.scenarios import three_tanks
    from fgenv.view.figures import FIGURES, draw_figures

    if not 0 < step <= 1:
        raise ValueError(f"--step: got {step}, want metres, above 0 and not above 1")
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

"""``fgenv train``: a policy of your own."""

from __future__ import annotations

import json
import shlex
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.options import Json, Seed
from fgenv.cli.run import names
from fgenv.cli.scenarios import given

if TYPE_CHECKING:
    from rich.console import Console

    from fgenv.agents.training.training import Training
    from fgenv.agents.training.validation import EvaluationResult


def train(
    scenario: Annotated[
        str,
        typer.Argument(help="A built-in scenario, or a scenario file.", autocompletion=names),
    ],
    algo: Annotated[str, typer.Option("--algo", help="ppo.")] = "ppo",
    n: Annotated[
        int | None,
        typer.Option("--n", min=1, help="Robots.", show_default="as the recipe has it"),
    ] = None,
    size: Annotated[float | None, typer.Option("--size", help="Meters; see the scenario.")] = None,
    set: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="What is the scenario's own: jitter=0.1."),
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(
            "--steps", min=1, help="Of robots, in all.", show_default="as the recipe has it"
        ),
    ] = None,
    every: Annotated[
        int, typer.Option("--every", min=1, help="Steps between two evaluations.")
    ] = 250_000,
    seed: Seed = 0,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            file_okay=False,
            help="Folder for what it writes; made if missing.",
            show_default="out/train/SCENARIO",
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with what is in the folder.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Train one policy for all robots of a scenario, and export it to a file without PyTorch.

    All worlds are stepped at once; the recipe of the scenario tells what robots see, what they
    are paid for, and a curriculum. Options given override it in all of its stages. The policy
    that did best in the evaluations on cases apart is OUT/policy.npz: fgenv run SCENARIO
    --policy mlp:OUT/policy.npz. Losses: tensorboard --logdir OUT/log. After Ctrl-C, --resume
    goes on from the last evaluation. Same seed, same file, on one machine.

    Needs the agents extra: pip install "fgenv\\[agents]".
    """
    from rich.console import Console

    if algo != "ppo":
        raise ValueError(f"--algo: got {algo!r}, expected ppo")
    from fgenv.agents.training.config import TrainingConfig
    from fgenv.agents.training.recipes import recipe_of
    from fgenv.agents.training.training import Training

    console = Console(stderr=as_json, highlight=False)
    overrides = given(n, size, set or [])
    recipe = recipe_of(scenario, overrides)
    many = steps or recipe.steps
    told = command(scenario, overrides, many, every, seed)
    config = TrainingConfig(scenario, recipe, overrides, many, seed, told, every)
    folder = out or Path("out/train") / Path(scenario).stem
    training, began = Training(config, folder, resume=resume), time.perf_counter()
    interrupted = run(training, console)
    path = folder / "policy.npz"
    facts: dict[str, Any] = {
        "scenario": scenario,
        "command": told,
        "seed": seed,
        "steps": training.steps,
        "best": training.best and asdict(training.best),
        "policy": training.best and str(path),  # one that was there before is not its own
        "wall_seconds": time.perf_counter() - began,
    }
    if as_json:
        typer.echo(json.dumps(facts, indent=1))
    elif training.best:
        size_of = path.stat().st_size
        typer.echo(f"written: {path}, {size_of:,} bytes, after {facts['wall_seconds']:.0f} s")
        typer.echo(f"try it: fgenv run {scenario} --policy mlp:{path}")
    if interrupted:
        console.print(
            "interrupted: the same command with --resume goes on from the last evaluation"
            if training.best
            else "interrupted before the first evaluation: nothing of it is kept"
        )
        raise KeyboardInterrupt


def run(training: Training, console: Console) -> bool:
    """Learn, with progress; whether it was interrupted."""
    from fgenv.cli.movie import progress

    with progress(console) as bar:
        task = bar.add_task("learning", total=training.config.steps, completed=training.steps)

        def tell(steps: int, check: EvaluationResult | None) -> None:
            bar.update(task, completed=steps)
            if check is not None:
                bar.console.print(
                    f"{steps:>10,} steps: success {check.success:.2f} of episodes,"
                    f" {check.robot_success:.3f} of robots; {check.collision:.3f} collide"
                )

        try:
            training.run(tell)
        except KeyboardInterrupt:
            return True
    return False


def command(scenario: str, overrides: dict[str, Any], steps: int, every: int, seed: int) -> str:
    """The command that gives the same file."""
    parts = ["fgenv", "train", scenario]
    for key, value in overrides.items():
        parts += [f"--{key}", str(value)] if key in ("n", "size") else ["--set", f"{key}={value}"]
    return shlex.join([*parts, "--steps", str(steps), "--every", str(every), "--seed", str(seed)])

"""``fgenv train``: train a policy."""

from __future__ import annotations

import json
import shlex
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.completion import scenario_names
from fgenv.cli.console import console_of
from fgenv.cli.options import ROBOTS_HELP, Json, Seed, Settings, Size
from fgenv.cli.scenario_options import overrides_from

if TYPE_CHECKING:
    from rich.console import Console

    from fgenv.agents.training.training import Training
    from fgenv.agents.training.validation import EvaluationResult

Scenario = Annotated[
    str,
    typer.Argument(help="Built-in scenario, or scenario file.", autocompletion=scenario_names),
]
Algorithm = Annotated[str, typer.Option("--algo", help="Algorithm: ppo.")]
RecipeRobots = Annotated[
    int | None, typer.Option("--n", min=1, help=ROBOTS_HELP, show_default="as in the recipe")
]
Steps = Annotated[
    int | None,
    typer.Option(
        "--steps", min=1, help="Total number of robot steps.", show_default="as in the recipe"
    ),
]
Every = Annotated[
    int, typer.Option("--every", min=1, help="Number of steps between two evaluations.")
]
Folder = Annotated[
    Path | None,
    typer.Option(
        "--out",
        file_okay=False,
        help="Folder for all files of the training; made if missing.",
        show_default="out/train/SCENARIO",
    ),
]
Resume = Annotated[bool, typer.Option("--resume", help="Continue the training in the folder.")]


def train(
    scenario: Scenario,
    algo: Algorithm = "ppo",
    n: RecipeRobots = None,
    size: Size = None,
    set: Settings = None,
    steps: Steps = None,
    every: Every = 250_000,
    seed: Seed = 0,
    out: Folder = None,
    resume: Resume = False,
    as_json: Json = False,
) -> None:
    """Train one policy for all robots of a scenario, and export it to a file without PyTorch.

    All worlds are stepped at once. The recipe of the scenario sets observations, rewards and a
    curriculum; given options override it in all of its stages. OUT/policy.npz is the policy with
    the best evaluation on separate cases: fgenv run SCENARIO --policy mlp:OUT/policy.npz. Losses:
    tensorboard --logdir OUT/log. After Ctrl-C, --resume continues from the last evaluation. Same
    seed, same file, on one machine.

    Needs the agents extra: pip install "fgenv\\[agents]".
    """

    if algo != "ppo":
        raise ValueError(f"--algo: got {algo!r}, expected ppo")
    from fgenv.agents.training.config import TrainingConfig
    from fgenv.agents.training.recipes import recipe_of
    from fgenv.agents.training.training import Training

    console = console_of(as_json)
    overrides = overrides_from(n, size, set)
    recipe = recipe_of(scenario, overrides)
    total = steps or recipe.steps
    command = command_of(scenario, overrides, total, every, seed)
    config = TrainingConfig(scenario, recipe, overrides, total, seed, command, every)
    folder = out or Path("out/train") / Path(scenario).stem
    training, began = Training(config, folder, resume=resume), time.perf_counter()
    interrupted = run(training, console)
    seconds = time.perf_counter() - began
    report(training, scenario, folder / "policy.npz", seconds, as_json)
    if interrupted:
        console.print(
            f"interrupted: the same command with --resume goes on from {training.steps:,} steps"
            if training.steps
            else "interrupted before the first steps: nothing of it is kept"
        )
        raise KeyboardInterrupt


def report(training: Training, scenario: str, path: Path, seconds: float, as_json: bool) -> None:
    """Print the result of a training."""
    if as_json:
        data: dict[str, Any] = {
            "scenario": scenario,
            "command": training.config.command,
            "seed": training.config.seed,
            "steps": training.steps,
            "best": training.best and asdict(training.best),
            "policy": str(path) if path.exists() else None,
            "wall_seconds": seconds,
        }
        typer.echo(json.dumps(data, indent=1))
    elif path.exists():
        typer.echo(f"written: {path}, {path.stat().st_size:,} bytes, after {seconds:.0f} s")
        typer.echo(f"try it: fgenv run {scenario} --policy mlp:{path}")


def run(training: Training, console: Console) -> bool:
    """Train with progress; return whether the training was interrupted."""
    from fgenv.cli.progress import progress

    with progress() as bar:
        task = bar.add_task("learning", total=training.config.steps, completed=training.steps)

        def show(steps: int, check: EvaluationResult | None) -> None:
            bar.update(task, completed=min(steps, training.config.steps))
            if check is not None:
                console.print(
                    f"{steps:>10,} steps: success {check.success:.2f} of episodes,"
                    f" {check.robot_success:.3f} of robots; {check.collision:.3f} collide"
                )

        try:
            training.run(show)
        except KeyboardInterrupt:
            return True
    return False


def command_of(scenario: str, overrides: dict[str, Any], steps: int, every: int, seed: int) -> str:
    """Return the command that makes the same file."""
    parts = ["fgenv", "train", scenario]
    for key, value in overrides.items():
        parts += [f"--{key}", str(value)] if key in ("n", "size") else ["--set", f"{key}={value}"]
    return shlex.join([*parts, "--steps", str(steps), "--every", str(every), "--seed", str(seed)])

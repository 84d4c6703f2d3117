"""``fgenv eval``: policies on a frozen set, with intervals."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.options import Json, Seed
from fgenv.cli.run import names, policies
from fgenv.cli.scenarios import given, target

if TYPE_CHECKING:
    from rich.console import Console

    from fgenv.agents.evaluation.evaluation import Evaluation
    from fgenv.scenarios import FrozenSet


def evaluate(
    scenario: Annotated[
        str,
        typer.Argument(help="A built-in scenario, or a frozen set.", autocompletion=names),
    ],
    policy: Annotated[
        list[str] | None,
        typer.Option(
            "--policy",
            help="What acts; several are compared.",
            show_default="goto",
            autocompletion=policies,
        ),
    ] = None,
    n: Annotated[int | None, typer.Option("--n", min=1, help="Robots.")] = None,
    size: Annotated[float | None, typer.Option("--size", help="Meters; see the scenario.")] = None,
    set: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="What is the scenario's own: jitter=0.1."),
    ] = None,
    cases: Annotated[
        int | None,
        typer.Option("--cases", min=1, help="Of the set to make.", show_default="100"),
    ] = None,
    jobs: Annotated[
        int, typer.Option("--jobs", min=1, max=256, help="Processes; results are the same.")
    ] = 1,
    csv: Annotated[Path | None, target("--csv", "Write a row for each robot and episode.")] = None,
    plot: Annotated[Path | None, target("--plot", "Draw the scores (.png, .svg, .pdf).")] = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Run policies through the cases of a frozen set, and compare them.

    Case i of a built-in scenario has the seed 1,000,000 + i. An episode is a success if every
    robot comes to its goal in time and meets nothing; extra time and distance are over the
    episodes that all policies solve. Intervals hold with 95 % confidence. --seed is that of
    policies that act at random. After Ctrl-C what there is by then is told and written.
    """
    from rich.console import Console

    from fgenv.agents.evaluation.evaluation import Evaluation
    from fgenv.cli.scores_report import csv_of, facts, tell
    from fgenv.envs import policy_of

    console = Console(stderr=as_json, highlight=False)
    writable(csv, plot)
    acting = tuple(dict.fromkeys(policy or ["goto"]))
    for name in acting:  # one that is not known is told before the cases are made
        policy_of(name, seed)
    chosen = set_of(scenario, cases, given(n, size, set or []), console)
    result, began = Evaluation(chosen, acting), time.perf_counter()
    interrupted = run(result, seed, jobs, console)
    document = {**facts(result, seed), "wall_seconds": time.perf_counter() - began}
    if not as_json:
        tell(console, result, document["wall_seconds"])
    written = []
    if csv is not None:
        csv.write_text(csv_of(result), encoding="utf-8")
        written.append(str(csv))
    if plot is not None and result.done:
        from fgenv.view.figures.interval_plot import plot_scores

        plot_scores(result.scores, document["name"], plot)
        written.append(str(plot))
    if as_json:
        typer.echo(json.dumps({**document, "written": written}, indent=1))
    else:
        for path in written:
            typer.echo(f"written: {path}")
    if interrupted:
        raise KeyboardInterrupt


def set_of(
    scenario: str, cases: int | None, overrides: dict[str, Any], console: Console
) -> FrozenSet:
    """The set meant, made with progress or read."""
    from fgenv.cli.movie import progress
    from fgenv.scenarios import frozen

    if Path(scenario).suffix == ".npz":
        if cases is not None:
            raise ValueError("--cases: a set that is a file has its own, leave it out")
        return frozen(scenario, **overrides)
    many = cases or 100
    with progress(console) as bar:
        task = bar.add_task("making cases", total=many)
        return frozen(
            scenario,
            cases=many,
            progress=lambda done: bar.update(task, completed=done),
            **overrides,
        )


def run(result: Evaluation, seed: int, jobs: int, console: Console) -> bool:
    """Fill it, with progress; whether it was interrupted."""
    from fgenv.agents.evaluation.evaluation import run_batches
    from fgenv.cli.movie import progress

    with progress(console) as bar:
        total = len(result.cases) * (len(result.policies) + 1)
        task = bar.add_task(result.cases.template.name, total=total)
        try:
            for policy, found in run_batches(result, seed, jobs):
                result.add(policy, found)
                bar.advance(task, len(found))
        except KeyboardInterrupt:
            return True
    return False


def writable(csv: Path | None, plot: Path | None) -> None:
    """What would only be told after the run is told now."""
    for path in (csv, plot):
        if path is not None and not path.parent.is_dir():
            raise ValueError(f"{path}: there is no folder {path.parent}; make it first")
    if plot is not None:
        from fgenv.view.figures.canvas import check_plot_path

        check_plot_path(plot, "--plot")

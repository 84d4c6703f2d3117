"""``fgenv eval``: policies on a frozen set, with confidence intervals."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.completion import policy_names, scenario_names
from fgenv.cli.console import console_of
from fgenv.cli.files import check_target
from fgenv.cli.options import (
    PLOT_SUFFIXES,
    POLICY_HELP,
    Jobs,
    Json,
    Robots,
    Seed,
    Settings,
    Size,
    Trust,
    check_trust,
    file_option,
)
from fgenv.cli.scenario_options import is_frozen_set, overrides_from
from fgenv.saving import save_text

if TYPE_CHECKING:
    from fgenv.agents.evaluation.evaluation import Evaluation
    from fgenv.scenarios import FrozenSet

ScenarioOrSet = Annotated[
    str,
    typer.Argument(help="Built-in scenario, or frozen set.", autocompletion=scenario_names),
]
Policies = Annotated[
    list[str] | None,
    typer.Option(
        "--policy",
        help=f"{POLICY_HELP}; repeat the option to compare several.",
        show_default="goto",
        autocompletion=policy_names,
    ),
]
Cases = Annotated[
    int | None,
    typer.Option("--cases", min=1, help="Number of cases of the set.", show_default="100"),
]
Csv = Annotated[Path | None, file_option("--csv", "Write a row for each robot and episode.")]
Plot = Annotated[Path | None, file_option("--plot", f"Plot the scores {PLOT_SUFFIXES}.")]


def evaluate(
    scenario: ScenarioOrSet,
    policy: Policies = None,
    n: Robots = None,
    size: Size = None,
    set: Settings = None,
    cases: Cases = None,
    jobs: Jobs = 1,
    csv: Csv = None,
    plot: Plot = None,
    seed: Seed = 0,
    trust: Trust = False,
    as_json: Json = False,
) -> None:
    """Run policies on the cases of a frozen set, and compare them.

    Case i of a built-in scenario has the seed 1,000,000 + i. An episode succeeds if every robot
    reaches its goal in time without a collision; extra time and distance are over the episodes
    that all policies solve. Intervals have 95 % confidence. --seed is that of policies with
    random actions. After Ctrl-C the finished part is reported and written.
    """

    from fgenv.agents.evaluation.evaluation import Evaluation
    from fgenv.cli.evaluation_report import as_data, print_report
    from fgenv.envs import policy_of

    console = console_of(as_json)
    check_targets(csv, plot)
    names = tuple(policy or ["goto"])
    check_trust(trust, names)
    for name in names:  # raises the error of an unknown policy before the cases are made
        if names.count(name) > 1:
            raise ValueError(f"--policy: got {name!r} twice, expected each policy once")
        policy_of(name, seed, trust=trust)
    frozen_set = frozen_set_of(scenario, cases, overrides_from(n, size, set))
    result, began = Evaluation(frozen_set, names), time.perf_counter()
    interrupted = run(result, seed, jobs, trust)
    data = {**as_data(result, seed), "wall_seconds": time.perf_counter() - began}
    if not as_json:
        print_report(console, result, data["wall_seconds"])
    written = write_files(result, csv, plot, data["name"])
    if as_json:
        typer.echo(json.dumps({**data, "written": written}, indent=1))
    else:
        for path in written:
            typer.echo(f"written: {path}")
    if interrupted:
        raise KeyboardInterrupt


def write_files(result: Evaluation, csv: Path | None, plot: Path | None, title: str) -> list[str]:
    """Write the requested files and return their names."""
    written = []
    if csv is not None:
        from fgenv.cli.evaluation_report import to_csv

        save_text(csv, to_csv(result))
        written.append(str(csv))
    if plot is not None and result.done:
        from fgenv.view.figures.interval_plot import plot_scores

        plot_scores(result.scores, title, plot)
        written.append(str(plot))
    return written


def frozen_set_of(scenario: str, cases: int | None, overrides: dict[str, Any]) -> FrozenSet:
    """Return the frozen set of a file, or make one of a scenario."""
    from fgenv.cli.progress import progress
    from fgenv.scenarios import frozen

    if is_frozen_set(scenario):
        if cases is not None:
            raise ValueError("--cases: a set that is a file has its own, leave it out")
        return frozen(scenario, **overrides)
    count = cases or 100
    with progress() as bar:
        task = bar.add_task("making cases", total=count)
        return frozen(
            scenario,
            cases=count,
            progress=lambda done: bar.update(task, completed=done),
            **overrides,
        )


def run(result: Evaluation, seed: int, jobs: int, trust: bool) -> bool:
    """Run the episodes of an evaluation; return whether it was interrupted."""
    from fgenv.agents.evaluation.evaluation import run_batches
    from fgenv.cli.progress import progress

    with progress() as bar:
        total = len(result.cases) * (len(result.policies) + 1)
        task = bar.add_task(result.cases.template.name, total=total)
        try:
            for policy, episodes in run_batches(result, seed, jobs, trust=trust):
                result.add(policy, episodes)
                bar.advance(task, len(episodes))
        except KeyboardInterrupt:
            return True
    return False


def check_targets(csv: Path | None, plot: Path | None) -> None:
    """Raise the errors of files that cannot be written, before the run."""
    check_target(csv, "--csv")
    if plot is not None:
        from fgenv.view.figures.canvas import check_plot_path

        check_plot_path(plot, "--plot")

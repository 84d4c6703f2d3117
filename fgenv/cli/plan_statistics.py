"""``fgenv plan --seeds``: planners compared over seeds, with intervals; resumable."""

from __future__ import annotations

import csv
import io
import json
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from fgenv.cli.progress import progress
from fgenv.regular_file import read_regular

if TYPE_CHECKING:
    from rich.table import Table

    from fgenv.confidence import Estimate
    from fgenv.scenarios import Scenario

MAX_BYTES = 1 << 28


@dataclass(frozen=True)
class Attempt:
    """The result of one planner with one seed; a row of the CSV file.

    Attributes:
        setting: hash of the scenario and of the options that are the same for all attempts.
        seconds: until the plan was certified, or the planner gave up.
        makespan, sum_of_costs: s; None without a plan.
        reason: why there is no plan.
    """

    setting: str
    planner: str
    seed: int
    solved: bool
    seconds: float
    makespan: float | None
    sum_of_costs: float | None
    reason: str


COLUMNS = tuple(field.name for field in fields(Attempt))


def seed_range(text: str) -> range:
    """Return the seeds of FIRST:END, without END.

    Raises:
        ValueError: not two integers, 0 or more, in ascending order.
    """
    first, colon, end = text.partition(":")
    if not (colon and first.isdecimal() and end.isdecimal() and int(first) < int(end)):
        raise ValueError(f"--seeds: got {text!r}, expected FIRST:END, such as 0:20")
    return range(int(first), int(end))


def compare_planners(
    problem: Scenario,
    planners: Sequence[str],
    seeds: range,
    options: dict[str, Any],
    table: Path | None,
    as_json: bool,
) -> None:
    """Plan with each planner and each seed, and print success, time and cost of each planner.

    Args:
        planners: names of OMPL's planners, or of methods for methods that use none of them.
        options: of `fgenv.plan`, the same for all.
        table: CSV file; attempts that it has are not repeated.
    """
    setting = hash_of(problem, options)
    kept = [a for a in read_attempts(table) if a.setting == setting]
    done = {(a.planner, a.seed): a for a in kept}
    tasks = [(p, s) for s in seeds for p in planners if (p, s) not in done]
    interrupted = False
    with progress() as bar:
        task = bar.add_task("planning", total=len(tasks))
        try:
            for planner, seed in tasks:
                done[planner, seed] = attempt(problem, planner, seed, options, setting)
                append(table, done[planner, seed])
                bar.advance(task)
        except KeyboardInterrupt:
            interrupted = True
    rows = [
        summary(p, [a for (name, seed), a in done.items() if name == p and seed in seeds])
        for p in planners
    ]
    written = [] if table is None else [str(table)]
    if as_json:
        document = {"scenario": problem.name, "rows": rows, "written": written}
        typer.echo(json.dumps(document, indent=1))
    else:
        print_rows(problem.name, rows, written)
    if interrupted:
        raise KeyboardInterrupt


def hash_of(problem: Scenario, options: dict[str, Any]) -> str:
    """Return the hash of everything that attempts share, 12 hexadecimal digits."""
    import hashlib

    text = json.dumps([problem.model_dump(mode="json"), options], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def attempt(
    problem: Scenario, planner: str, seed: int, options: dict[str, Any], setting: str
) -> Attempt:
    """Plan once."""
    from fgenv.planners import METHODS, PlanningError
    from fgenv.planners.planning import plan

    chosen = {"method": planner} if planner in METHODS else {"planner": planner}
    began = time.perf_counter()
    try:
        result = plan(problem, seed=seed, **{**options, **chosen})
    except PlanningError as error:
        reason = " ".join(str(error).split())
        seconds = time.perf_counter() - began
        return Attempt(setting, planner, seed, False, seconds, None, None, reason)
    seconds = time.perf_counter() - began
    costs = result.makespan, result.sum_of_costs
    return Attempt(setting, planner, seed, True, seconds, *costs, "")


def read_attempts(table: Path | None) -> Iterator[Attempt]:
    """Yield the attempts of a CSV file, if there is one.

    Raises:
        ValueError: another file.
    """
    if table is None or not table.exists():
        return
    content = read_regular(table, "a CSV file of attempts", MAX_BYTES)
    rows = csv.DictReader(io.StringIO(content.decode("utf-8", "replace"), newline=""))
    if rows.fieldnames is None or tuple(rows.fieldnames) != COLUMNS:
        raise ValueError(f"--csv: {table} has other columns, expected {', '.join(COLUMNS)}")
    for row in rows:
        try:
            makespan, cost = (float(row[k]) if row[k] else None for k in COLUMNS[5:7])
            key = row["setting"], row["planner"], int(row["seed"]), row["solved"] == "True"
            yield Attempt(*key, float(row["seconds"]), makespan, cost, row["reason"])
        except (TypeError, ValueError):  # the last line of a run that was killed
            continue


def append(table: Path | None, result: Attempt) -> None:
    """Add a line to the CSV file; a new file gets its heading."""
    if table is None:
        return
    new = not table.exists()
    with table.open("a", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        if new:
            writer.writeheader()
        writer.writerow(asdict(result))


def summary(planner: str, attempts: Sequence[Attempt]) -> dict[str, Any]:
    """Return the share of solved seeds, and medians over them, each with its 95 % interval."""
    from fgenv.confidence import median, rate

    solved = [a for a in attempts if a.solved]
    estimates = {
        "success": rate(len(solved), len(attempts)),
        "seconds": median([a.seconds for a in solved]),
        "makespan": median([a.makespan for a in solved if a.makespan is not None]),
        "sum_of_costs": median([a.sum_of_costs for a in solved if a.sum_of_costs is not None]),
    }
    return {
        "planner": planner,
        "attempts": len(attempts),
        **{name: [None if np.isnan(x) else x for x in e] for name, e in estimates.items()},
    }


def print_rows(name: str, rows: Sequence[dict[str, Any]], written: Sequence[str]) -> None:
    """Print a row per planner."""
    from rich.console import Console

    from fgenv.cli.files import echo_written

    Console(highlight=False).print(table_of(name, rows))
    typer.echo("success and medians over the solved seeds, with 95 % intervals")
    echo_written(written)


def table_of(name: str, rows: Sequence[dict[str, Any]]) -> Table:
    """Return the table of planners."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(title=escape(name), box=None, title_justify="left", padding=(0, 0, 0, 1))
    for column in ("planner", "seeds", "success", "time (s)", "makespan (s)"):
        table.add_column(column, justify="left" if column == "planner" else "right")
    for row in rows:
        cells = [estimate(row[k]) for k in ("success", "seconds", "makespan")]
        table.add_row(row["planner"], str(row["attempts"]), *cells)
    return table


def estimate(values: Estimate | Sequence[float | None]) -> str:
    """Format an estimate with its interval; a dash if there is none."""
    value, low, high = values
    return "-" if value is None else f"{value:.3g} [{low:.3g}, {high:.3g}]"

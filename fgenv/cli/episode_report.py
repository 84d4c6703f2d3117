"""How an episode went, for a reader and for a machine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rich.markup import escape
from rich.table import Table

if TYPE_CHECKING:
    from rich.console import Console

    from fgenv.envs import Record
    from fgenv.metrics import Results

COLUMNS = ("success", "arrived (s)", "collisions", "path", "least clearance (m)")
ENDS = {
    "terminated": "over",
    "truncated": "out of time",
    "stopped": "stopped before its end",
}


def tell(
    console: Console, record: Record, results: Results, seconds: float, notes: Sequence[str]
) -> None:
    """A table with a row for each robot, and what is said of all."""
    scenario = record.scenario
    title = escape(f"{scenario.name}, seed {record.about['seed']}, by {record.policy}")
    table = Table(title=title, box=None, title_justify="left")
    table.add_column("robot")
    for name in COLUMNS:
        table.add_column(name, justify="right", no_wrap=True)
    for robot in results.robots:
        table.add_row(
            escape(robot.name),
            "[green]yes[/]" if robot.success else "[red]no[/]",
            number(robot.arrival, 1),
            str(robot.collisions),
            f"{robot.path_length:.2f} {robot.unit}",
            number(robot.least_clearance, 3),
        )
    console.print(table)
    for note in notes:
        console.print(f"note: {note}", markup=False)
    ended = ENDS[record.about["ended"]]
    console.print(f"{ended} after {results.seconds:.1f} s, {results.steps} steps", end="")
    console.print(f" ({seconds:.2f} s to simulate)")
    done, n = sum(robot.success for robot in results.robots), len(results.robots)
    console.print(
        f"success {done} of {n}, collisions {results.collisions},"
        f" makespan {number(results.makespan, 1, ' s')},"
        f" sum of costs {number(results.sum_of_costs, 1, ' s')}"
    )


def number(x: float | None, digits: int, unit: str = "") -> str:
    """A number, or a dash where there is none."""
    return "-" if x is None or not math.isfinite(x) else f"{x:.{digits}f}{unit}"


def facts(
    record: Record, results: Results, seconds: float, notes: Sequence[str], written: Sequence[str]
) -> dict[str, Any]:
    """The same for JSON: meters, radians, seconds of simulated time.

    Equal for equal arguments, but for `wall_seconds`.
    """
    return {
        "scenario": record.scenario.name,
        "seed": record.about["seed"],
        "policy": record.policy,
        "ended": record.about["ended"],
        "dt": record.dt,
        **results.facts,
        "notes": list(notes),
        "written": list(written),
        "wall_seconds": seconds,
    }

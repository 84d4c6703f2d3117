"""The report of an episode: a table for readers, data for JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rich.markup import escape
from rich.table import Table

from fgenv.envs.contact_events import contact_events

if TYPE_CHECKING:
    from rich.console import Console

    from fgenv.envs import Record
    from fgenv.metrics import Results

COLUMNS = ("success", "arrived (s)", "steps in contact", "path", "least clearance (m)")
ENDS = {
    "terminated": "over",
    "truncated": "out of time",
    "stopped": "stopped before its end",
}


def print_report(
    console: Console, record: Record, results: Results, seconds: float, notes: Sequence[str]
) -> None:
    """Print a table with a row per robot, and a summary."""
    console.print(table_of(record, results))
    for note in notes:
        console.print(f"note: {note}", markup=False)
    ended = ENDS[record.about["ended"]]
    console.print(f"{ended} after {results.seconds:.1f} s, {results.steps} steps", end="")
    console.print(f" ({seconds:.2f} s to simulate)")
    successes, n = sum(robot.success for robot in results.robots), len(results.robots)
    console.print(
        f"success {successes} of {n}, contact events {len(contact_events(record))},"
        f" steps in contact {results.steps_in_contact},"
        f" makespan {number(results.makespan, 1, ' s')},"
        f" sum of costs {number(results.sum_of_costs, 1, ' s')}"
    )


def table_of(record: Record, results: Results) -> Table:
    """Return the table of robots."""
    title = escape(f"{record.scenario.name}, seed {record.about['seed']}, by {record.policy}")
    table = Table(title=title, box=None, title_justify="left")
    table.add_column("robot")
    for name in COLUMNS:
        table.add_column(name, justify="right", no_wrap=True)
    for robot in results.robots:
        table.add_row(
            escape(robot.name),
            "[green]yes[/]" if robot.success else "[red]no[/]",
            number(robot.arrival, 1),
            str(robot.steps_in_contact),
            f"{robot.path_length:.2f} {robot.unit}",
            number(robot.least_clearance, 3),
        )
    return table


def number(x: float | None, digits: int, unit: str = "") -> str:
    """Format a number; a dash if there is none."""
    return "-" if x is None or not math.isfinite(x) else f"{x:.{digits}f}{unit}"


def as_data(
    record: Record, results: Results, seconds: float, notes: Sequence[str], written: Sequence[str]
) -> dict[str, Any]:
    """Return the report for JSON, in meters, radians and seconds of simulated time.

    All values but `wall_seconds` are equal for equal arguments.
    """
    return {
        "scenario": record.scenario.name,
        "seed": record.about["seed"],
        "policy": record.policy,
        "ended": record.about["ended"],
        "dt": record.dt,
        "contact_events": len(contact_events(record)),
        **results.facts,
        "notes": list(notes),
        "written": list(written),
        "wall_seconds": seconds,
    }

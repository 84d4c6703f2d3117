"""The report of an evaluation: a table for readers, data for JSON and CSV."""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, Any

from rich.markup import escape
from rich.table import Table

if TYPE_CHECKING:
    from rich.console import Console

    from fgenv.agents.evaluation.evaluation import Evaluation
    from fgenv.confidence import Estimate
    from fgenv.scenarios import FrozenSet

# Rows of the table by attribute of a score: name, unit, digits
ROWS = {
    "success": ("success", "of episodes", 2),
    "robot_success": ("success", "of robots", 3),
    "robot_collision": ("ran into a robot", "of robots", 3),
    "body_collision": ("ran into anything else", "of robots", 3),
    "time_out": ("out of time", "of robots", 3),
    "extra_time": ("extra time *", "s", 2),
    "extra_distance": ("extra distance *", "m", 2),
    "makespan": ("makespan *", "s", 1),
    "speed": ("mean speed", "m/s", 2),
    "least_clearance": ("least clearance", "m", 3),
}
COLUMNS = (
    "policy",
    "case",
    "seed",
    "robot",
    "success",
    "arrival_s",
    "steps_met_robot",
    "steps_met_other",
    "path",
    "path_unit",
    "least_clearance_m",
    "straight_arrival_s",
    "straight_path",
)


def name_of(cases: FrozenSet) -> str:
    """Return the title of a set: scenario, robots, time limit, cases and id."""
    t = cases.template
    return (
        f"{t.name}, {len(t.robots)} robots, {t.horizon:g} s, {len(cases)} cases"
        f" from seed {int(cases.seeds[0])}, id {cases.id[:12]}"
    )


def print_report(console: Console, result: Evaluation, seconds: float) -> None:
    """Print a table with a row per score and a column per policy."""
    done, total = len(result.done), len(result.cases)
    if not done:
        console.print("no case is done by all policies, nothing to report")
        return
    table = Table(title=escape(name_of(result.cases)), box=None, title_justify="left")
    table.add_column("")
    table.add_column("")
    scores = result.scores
    for name in scores:
        table.add_column(escape(name), justify="right")
    for key, (about, unit, digits) in ROWS.items():
        estimates = [getattr(score, key) for score in scores.values()]
        table.add_row(about, unit, *(with_interval(x, digits) for x in estimates))
    console.print(table)
    console.print(f"{done} of {total} cases, 95 % confidence in brackets", end="")
    console.print(f"; * over the {len(result.shared)} that all solve ({seconds:.1f} s)")


def with_interval(estimate: Estimate, digits: int) -> str:
    """Format a number and its interval; a dash if there is none."""
    if math.isnan(estimate.value):
        return "-"
    value, low, high = (f"{x:.{digits}f}" for x in estimate)
    return f"{value} \\[{low}, {high}]"


def as_data(result: Evaluation, seed: int) -> dict[str, Any]:
    """Return the report for JSON, in meters, radians, seconds of simulated time; null: no value."""
    cases = result.cases
    scores = {
        name: {
            "episodes": score.episodes,
            "shared": score.shared,
            **{key: [finite(x) for x in getattr(score, key)] for key in ROWS},
            "failed_cases": [c for c in result.done if not result.results[name][c].success],
        }
        for name, score in result.scores.items()
    }
    return {
        "name": name_of(cases),
        "scenario": cases.template.name,
        "id": cases.id,
        "cases": len(cases),
        "done": len(result.done),
        "robots": len(cases.template.robots),
        "horizon": cases.template.horizon,
        "seed": seed,
        "policies": scores,
    }


def finite(x: float) -> float | None:
    """Return a finite number, or None."""
    return x if math.isfinite(x) else None


def to_csv(result: Evaluation) -> str:
    """Return a row for each robot of each episode; cells without a value are empty."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    for policy in result.policies:
        for case in result.done:
            episode, straight = result.results[policy][case], result.unobstructed[case].robots
            seed = int(result.cases.seeds[case])
            for i, (robot, direct) in enumerate(zip(episode.results.robots, straight, strict=True)):
                key = policy, case, seed, robot.name, int(robot.success), robot.arrival
                contacts = episode.robot_collisions[i], episode.body_collisions[i]
                path = robot.path_length, robot.unit, robot.least_clearance
                writer.writerow([*key, *contacts, *path, direct.arrival, direct.path_length])
    return out.getvalue()

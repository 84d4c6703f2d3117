"""The report of a plan: a table for readers, data for JSON."""

from __future__ import annotations

import json
from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING, Any

import typer

from fgenv.cli.files import echo_written

if TYPE_CHECKING:
    from rich.table import Table

    from fgenv.planners import Certificate, Plan


def print_plan(plan: Plan, written: list[str], as_json: bool) -> None:
    """Print a row per robot and a summary, or one JSON document."""
    if as_json:
        typer.echo(json.dumps(plan_data(plan, written), indent=1))
        return
    from rich.console import Console

    Console(highlight=False).print(table_of(plan))
    typer.echo(
        f"makespan {plan.makespan:.1f} s, sum of costs {plan.sum_of_costs:.1f} s;"
        f" {plan.facts['seconds']:.2f} s to plan{checks(plan)}"
    )
    typer.echo(describe(plan.certificate, plan.dt))
    echo_written(written)


def table_of(plan: Plan) -> Table:
    """Return the table of robots."""
    from rich.markup import escape
    from rich.table import Table

    title = f"{plan.scenario.name}, seed {plan.seed}, by {plan.method}"
    table = Table(title=escape(title), box=None, title_justify="left")
    table.add_column("robot")
    for column in ("arrives (s)", "path (m)"):
        table.add_column(column, justify="right", no_wrap=True)
    names = [robot.name for robot in plan.scenario.robots]
    for name, arrival, length in zip(names, plan.arrivals, plan.lengths, strict=True):
        table.add_row(escape(name), f"{arrival:.1f}", f"{length:.2f}")
    return table


def checks(plan: Plan) -> str:
    """Return the number of checked motions as text, if the method counts them."""
    count = plan.facts.get("motions_checked", plan.facts.get("checks"))
    return "" if count is None else f", {count:,} motions checked"


def describe(certificate: Certificate, dt: float) -> str:
    """Return a certificate in words."""
    if not certificate:
        step = certificate.failed_step or 0
        return f"not proved: step {step} (at {step * dt:.1f} s) is not free"
    margin = f" with {certificate.margin:g} m to spare" if certificate.margin else ""
    text = f"proved free{margin}: {certificate.steps} steps"
    if certificate.nearest is None:
        return f"{text}, no robot is near anything"
    step, robot, other = certificate.nearest
    return (
        f"{text}, no robot comes nearer than {certificate.clearance:.4f} m"
        f" (nearest at {step * dt:.1f} s: {robot} to {other})"
    )


def plan_data(plan: Plan, written: list[str]) -> dict[str, Any]:
    """Return the report for JSON, in meters and seconds; `facts.seconds` is computing time.

    `configurations` of a robot (steps + 1, nq) are `dt` apart; it moves straight between them.
    """
    names = [robot.name for robot in plan.scenario.robots]
    rows = zip(names, plan.arrivals, plan.lengths, plan.configurations, strict=True)
    return {
        "scenario": plan.scenario.name,
        "seed": plan.seed,
        "method": plan.method,
        "planner": plan.planner,
        "robots": [
            {"name": n, "arrival": a, "path_length": length, "configurations": q.tolist()}
            for n, a, length, q in rows
        ],
        "makespan": plan.makespan,
        "sum_of_costs": plan.sum_of_costs,
        "dt": plan.dt,
        "steps": plan.steps,
        "certificate": certificate_data(plan.certificate),
        "facts": plan.facts,
        "id": plan.id,
        "written": written,
    }


def certificate_data(certificate: Certificate) -> dict[str, Any]:
    """Return a certificate for JSON; an infinite clearance is None."""
    data = asdict(certificate)
    data["clearance"] = data["clearance"] if isfinite(data["clearance"]) else None
    return data

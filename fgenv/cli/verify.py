"""``fgenv verify``: certify a plan again, from its file alone."""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.errors import FAILED_CHECK
from fgenv.cli.options import Json
from fgenv.cli.plan_report import certificate_data, describe

if TYPE_CHECKING:
    from fgenv.planners import Certificate, Plan

PlanFile = Annotated[Path, typer.Argument(metavar="PLAN", help="Plan file (.npz).")]
Margin = Annotated[
    float | None,
    typer.Option(
        "--margin", min=0.0, help="Distance to keep, meters.", show_default="that of the plan"
    ),
]


def verify(file: PlanFile, margin: Margin = None, as_json: Json = False) -> None:
    """Certify a plan again from its file: the scenario is built anew, no stored result is used.

    Exit code 0: proved. 1: not proved; the report names the step and the
    bodies. 2: the file is no plan, damaged, or does not fit its own scenario.
    """
    from fgenv.planners.plan import Plan
    from fgenv.planners.verification import verify as certify_again

    plan = Plan.load(file)
    certificate = certify_again(plan, margin)
    bodies = "" if certificate else colliding_bodies(plan, certificate)
    if as_json:
        data: dict[str, Any] = {"file": str(file), "id": plan.id, "scenario": plan.scenario.name}
        data |= {**certificate_data(certificate), "met": bodies or None}
        typer.echo(json.dumps(data, indent=1))
    else:
        details = f": {bodies}" if bodies else ""
        typer.echo(f"{file}: {describe(certificate, plan.dt)}{details}")
    if not certificate:
        raise typer.Exit(FAILED_CHECK)


def colliding_bodies(plan: Plan, certificate: Certificate) -> str:
    """Return the names of two bodies that collide in the step that is not proved, or ''."""
    from fgenv.planners import Problem

    step = certificate.failed_step or 0
    problem = Problem.from_scenario(plan.scenario, certificate.margin)
    names, margin, last = problem.names, certificate.margin, min(step + 1, plan.steps)
    motions = [(q[step], q[last]) for q in plan.configurations]
    for i, motion in enumerate(motions):
        alone = problem.world_with(i)
        result = alone.check_motion(names[i], *motion, margin=margin)
        if not result:
            bodies = dict(zip(alone.ids.tolist(), alone.names, strict=True))
            return f"{names[i]} and {bodies.get(int(result.other), 'something').split('/')[0]}"
    robots = enumerate(zip(problem.robot_ids, motions, strict=True))
    for (i, a), (j, b) in combinations(robots, 2):
        if problem.world.motions_collide(a[0], *a[1], b[0], *b[1], margin=margin):
            return f"{names[i]} and {names[j]}"
    return ""

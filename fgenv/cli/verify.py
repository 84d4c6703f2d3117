"""``fgenv verify``: prove a plan again, from its file alone."""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.errors import FAILED_CHECK
from fgenv.cli.options import Json
from fgenv.cli.plan import claims, told

if TYPE_CHECKING:
    from fgenv.planners import Certificate, Plan


def verify(
    file: Annotated[Path, typer.Argument(metavar="PLAN", help="A plan file (.npz).")],
    margin: Annotated[
        float | None,
        typer.Option(
            "--margin", min=0.0, help="Meters to keep.", show_default="what the plan claims"
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Prove a plan again from its file: the scenario is built anew, nothing is believed.

    Exit code 0: proved. 1: not proved, it says which step and who. 2: the file
    is no plan, damaged, or does not fit its own scenario.
    """
    from fgenv.planners.plan import Plan
    from fgenv.planners.verification import verify as prove

    plan = Plan.load(file)
    found = prove(plan, margin)
    who = "" if found else met(plan, found)
    if as_json:
        about: dict[str, Any] = {"file": str(file), "id": plan.id, "scenario": plan.scenario.name}
        met_by = who or None
        typer.echo(json.dumps({**about, **claims(found), "met": met_by}, indent=1))
    else:
        typer.echo(f"{file}: {told(found, plan.dt)}{f': {who}' if who else ''}")
    if not found:
        raise typer.Exit(FAILED_CHECK)


def met(plan: Plan, certificate: Certificate) -> str:
    """Who meets whom in the step that is not proved, or ''."""
    from fgenv.planners import Problem

    step = certificate.failed_step or 0
    problem = Problem.of(plan.scenario, certificate.margin)
    names, margin, last = problem.names, certificate.margin, min(step + 1, plan.steps)
    ways = [(q[step], q[last]) for q in plan.configurations]
    for i, way in enumerate(ways):
        alone = problem.alone(i)
        found = alone.check_motion(names[i], *way, margin=margin)
        if not found:
            others = dict(zip(alone.ids.tolist(), alone.names, strict=True))
            return f"{names[i]} and {others.get(int(found.other), 'something').split('/')[0]}"
    for (i, a), (j, b) in combinations(enumerate(zip(problem.robots, ways, strict=True)), 2):
        if problem.world.motions_collide(a[0], *a[1], b[0], *b[1], margin=margin):
            return f"{names[i]} and {names[j]}"
    return ""

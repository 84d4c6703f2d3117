"""Verification of plans from their files alone."""

from __future__ import annotations

from pathlib import Path

from fgenv.scenarios.hashes import urdf_hashes
from fgenv.scenarios.validation import file_faults

from .certificate import Certificate, certify
from .limits import path_fault
from .plan import Plan, PlanError
from .problem import Problem


def verify(plan: Plan | str | Path, margin: float | None = None) -> Certificate:
    """Certify a plan again, with the scenario built anew.

    Starts, goals and the limits of configurations, speeds and accelerations are checked too.

    Args:
        plan: a Plan or its file.
        margin: meters; that of the plan's certificate by default.

    Raises:
        PlanError: the plan does not fit its scenario: ends, limits, shapes or mesh files.
    """
    if not isinstance(plan, Plan):
        plan = Plan.load(plan)
    for error in file_faults(plan.scenario):
        raise PlanError(f"plan: {error.problem}")
    changed = {m for m, h in urdf_hashes(plan.scenario).items() if h != plan.urdf.get(m)}
    if plan.urdf and changed:
        raise PlanError(f"plan: the URDF of {changed.pop()!r} has changed; plan again")
    problem = Problem.from_scenario(
        plan.scenario, plan.certificate.margin if margin is None else margin
    )
    steps = {len(q) if q.ndim else 0 for q in plan.configurations}
    if len(plan.configurations) != len(problem.models) or len(steps) != 1 or 0 in steps:
        raise PlanError("plan: expected one configuration per robot and step; plan again")
    for i, q in enumerate(plan.configurations):
        wrong = path_fault(problem, i, q)
        if wrong:
            raise PlanError(f"plan: {problem.names[i]!r} {wrong}; plan again")
    return certify(problem, plan.configurations)

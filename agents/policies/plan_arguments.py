"""Checks of the arguments of planning policies."""

from __future__ import annotations

from fgenv.agents.tracking.executable_plan import ExecutablePlan
from fgenv.envs import View
from fgenv.planners import METHODS, PLANNERS, PlanningError
from fgenv.scenarios.errors import near


def method_and_planner(argument: str) -> tuple[str | None, str | None]:
    """Return method and planner of METHOD[:PLANNER]; each may be empty.

    Raises:
        ValueError: unknown method or planner, or a planner of another method than composite.
    """
    method, _, planner = argument.partition(":")
    for kind, name, known in (("method", method, METHODS), ("planner", planner, PLANNERS)):
        if name and name not in known:
            raise ValueError(f"{kind}: got {name!r}, which is unknown; {near(name, known)}")
    if method not in ("", "composite") and planner:
        raise ValueError(
            f"planner: got {planner!r} with the method {method!r}, which does not use it; expected"
            " composite:PLANNER"
        )
    return method or None, planner or None


def check_plan(course: ExecutablePlan, view: View, world: int) -> None:
    """Raise PlanningError if a plan is not for a world's episode."""
    names = tuple(robot.name for robot in course.plan.scenario.robots)
    if names != view.names:
        raise PlanningError(
            f"plan: got robots {', '.join(names)}, expected {', '.join(view.names)}"
        )
    if course.plan.dt != view.dt:
        raise PlanningError(f"plan: got steps of {course.plan.dt} s, expected {view.dt} s")
    for i, (name, model) in enumerate(zip(names, course.models, strict=True)):
        for end, row, q in (
            ("start", course.plan.configurations[i][0], view.configurations),
            ("goal", course.plan.configurations[i][-1], view.goals),
        ):
            if (
                model.nq != view.robots[i].nq
                or model.displacement_bound(row, q[world, i, : model.nq])
                > model.required_drive.base_drive.tracking_error
            ):
                raise PlanningError(
                    f"plan: the {end} of {name!r} differs from this episode;"
                    " run the scenario with the options of the plan"
                )

"""Executable plans: plans as a simulator executes them.

A robot arrives as soon as it is within its goal's tolerance: it stops there, or disappears, even if
its plan continues. An executable plan is truncated accordingly, and certified again.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.planners import Plan, PlanningError, Problem, certify
from fgenv.planners.planning import plan as plan_scenario
from fgenv.robots import Robot
from fgenv.scenarios import Scenario
from fgenv.scenarios.schema import RobotSpec

MAX_SEEDS = 8
ROUNDING = 1e-9  # meters or radians


@dataclass(frozen=True, eq=False)
class ExecutablePlan:
    """Configurations of robots at each step of an episode.

    Attributes:
        plan: the plan that it executes.
        configurations: (k + 1, nq) of each robot, constant from its arrival.
        models: of the robots.
    """

    plan: Plan
    configurations: tuple[Floats, ...] = field(repr=False)
    models: tuple[Robot, ...] = field(repr=False)

    @classmethod
    def of(cls, plan: Plan) -> ExecutablePlan:
        """Return a plan as the simulator executes it."""
        built = plan.scenario.build()
        rows = zip(
            built.robots, plan.scenario.robots, plan.configurations, built.goals, strict=True
        )
        return cls(plan, tuple(truncated_at_arrival(*row) for row in rows), built.robots)

    @property
    def last(self) -> int:
        """Number of the last step."""
        return len(self.configurations[0]) - 1

    def at(self, clock: float) -> list[Floats]:
        """Configurations (nq,) of each robot at a time in steps, interpolated within a step."""
        k = min(int(clock), self.last)
        rows = [q[k] for q in self.configurations]
        if clock == k or k == self.last:
            return rows
        after = [q[k + 1] for q in self.configurations]
        return [
            model.interpolate(a, b, clock - k)
            for model, a, b in zip(self.models, rows, after, strict=True)
        ]


def truncated_at_arrival(model: Robot, spec: RobotSpec, q: Floats, goal: Floats) -> Floats:
    """Configurations (k + 1, nq), at rest from the first step that ends at the goal."""
    there = np.flatnonzero(at_goal(model, spec, q[1:], goal))
    if len(there) == 0:
        return q
    stop = int(there[0]) + 1
    return np.concatenate([q[: stop + 1], np.repeat(q[stop : stop + 1], len(q) - 1 - stop, axis=0)])


def at_goal(model: Robot, spec: RobotSpec, q: Floats, goal: Floats) -> NDArray[np.bool_]:
    """Whether configurations (k, nq) are within the tolerance of the goal, (k,)."""
    off = np.abs(model.difference(q, np.broadcast_to(goal, q.shape)))
    far, turn = spec.goal_tolerance.position, spec.goal_tolerance.angle
    n = len(model.moving_joints)
    base, joints = off[:, : off.shape[1] - n], off[:, off.shape[1] - n :]
    slides = [joint.kind == "prismatic" for joint in model.moving_joints]
    there = (joints <= np.where(slides, far, turn)).all(axis=1)
    if model.base != "fixed":
        place = 3 if model.base == "free" else 2
        there &= np.linalg.norm(base[:, :place], axis=1) <= far
        there &= np.linalg.norm(base[:, place:], axis=1) <= turn
    return np.asarray(there)


def plan_executable(
    scenario: Scenario,
    method: str | None = None,
    planner: str | None = None,
    *,
    seed: int = 0,
    time_limit: float = 10.0,
    way_points: bool = False,
) -> ExecutablePlan:
    """Plan a scenario; try more seeds while the simulator cannot execute the plan.

    Args:
        scenario: the scenario.
        method, planner, seed, time_limit: see `fgenv.plan`.
        way_points: actions are way points, for which some drives do not back up.

    Raises:
        PlanningError: no plan within the time limit, with the reason.
    """
    problem, end = with_tracking_margin(scenario, seed), time.monotonic() + time_limit
    if method is None and all(model.base == "fixed" for model in problem.models):
        method = "composite"  # roadmaps of arms take long
    why = PlanningError(f"no plan within {time_limit:g} s: give more time")
    for attempt in range(MAX_SEEDS):
        left = end - time.monotonic()
        if left <= 0:
            break
        again = replace(problem, seed=seed + attempt)
        try:
            course = ExecutablePlan.of(
                plan_scenario(again, planner, left, seed + attempt, method=method)
            )
        except PlanningError as error:
            why = error
            continue
        wrong = execution_fault(problem, course, way_points)
        if wrong is None:
            return course
        why = PlanningError(f"the plans of {attempt + 1} seeds cannot be driven: {wrong}")
    raise why


def execution_fault(
    problem: Problem, course: ExecutablePlan, way_points: bool = False
) -> str | None:
    """Reason that the simulator cannot execute a plan, or None."""
    for name, model, q in zip(problem.names, problem.models, course.configurations, strict=True):
        if ((q < model.lower - ROUNDING) | (q > model.upper + ROUNDING)).any():
            return f"{name} leaves the workspace on its path; enlarge the workspace"
        drive = model.required_drive
        if (
            way_points
            and not drive.tracking_waypoint(model, q[:-1], q[1:], problem.dt, 1.0)[1].all()
        ):
            return f"{name} backs up, which way points cannot express; use actions='drive'"
    if not certify(problem, course.configurations):
        return (
            "a robot that stops within its goal's tolerance blocks another;"
            " use a smaller goal_tolerance, or another method"
        )
    return None


def with_tracking_margin(scenario: Scenario, seed: int) -> Problem:
    """The problem with a margin for the tracking errors of two robots.

    Without a margin if starts or goals are closer than it to an obstacle.
    """
    problem = Problem.from_scenario(scenario, 0.0, seed)
    wide = replace(
        problem, margin=2 * max(r.required_drive.base_drive.tracking_error for r in problem.models)
    )
    try:
        wide.check()
    except PlanningError:
        return problem
    return wide

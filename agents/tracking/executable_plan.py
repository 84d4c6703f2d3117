"""Courses: plans as a simulator lets robots execute them.

A robot has arrived as soon as it is within its goal's tolerance: it stops there, or is gone,
wherever its plan goes from there. A course is a plan cut so, and proved again.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.planners import Plan, PlanningError, Problem, certify
from fgenv.planners.planning import plan as plan_all
from fgenv.robots import Robot
from fgenv.scenarios import Scenario
from fgenv.scenarios.schema import RobotSpec

TRIES = 8  # seeds
INSIDE = 1e-9  # meters, for rounding


@dataclass(frozen=True, eq=False)
class Course:
    """Where robots are at each step of an episode.

    Attributes:
        plan: that it is of.
        configurations: (k + 1, nq) of each robot, constant from where it has arrived.
        models: of the robots.
    """

    plan: Plan
    configurations: tuple[Floats, ...] = field(repr=False)
    models: tuple[Robot, ...] = field(repr=False)

    @classmethod
    def of(cls, plan: Plan) -> Course:
        """As the simulator executes it."""
        built = plan.scenario.build()
        rows = zip(
            built.robots, plan.scenario.robots, plan.configurations, built.goals, strict=True
        )
        return cls(plan, tuple(cut(*row) for row in rows), built.robots)

    @property
    def last(self) -> int:
        """Steps."""
        return len(self.configurations[0]) - 1

    def at(self, clock: float) -> list[Floats]:
        """Configurations (nq,) of each robot at a time in steps, straight between two of them."""
        k = min(int(clock), self.last)
        rows = [q[k] for q in self.configurations]
        if clock == k or k == self.last:
            return rows
        after = [q[k + 1] for q in self.configurations]
        return [
            model.interpolate(a, b, clock - k)
            for model, a, b in zip(self.models, rows, after, strict=True)
        ]


def cut(model: Robot, spec: RobotSpec, q: Floats, goal: Floats) -> Floats:
    """Configurations (k + 1, nq), at rest from the first step after which it has arrived."""
    there = np.flatnonzero(arrived(model, spec, q[1:], goal))
    if len(there) == 0:
        return q
    stop = int(there[0]) + 1
    return np.concatenate([q[: stop + 1], np.repeat(q[stop : stop + 1], len(q) - 1 - stop, axis=0)])


def arrived(model: Robot, spec: RobotSpec, q: Floats, goal: Floats) -> NDArray[np.bool_]:
    """Whether configurations (k, nq) are at the goal as the simulator sees it, (k,)."""
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


def find(
    scenario: Scenario,
    method: str | None = None,
    planner: str = "RRTConnect",
    *,
    seed: int = 0,
    time_limit: float = 10.0,
    way_points: bool = False,
) -> Course:
    """Plan a scenario, with other seeds where the plan does not hold as the simulator executes it.

    Args:
        way_points: it is driven by way points: who drives at those does not back up.

    Raises:
        PlanningError: no plan in time, and why.
    """
    problem, end = careful(scenario, seed), time.monotonic() + time_limit
    if method is None and all(model.base == "fixed" for model in problem.models):
        method = "composite"  # roadmaps of arms take long
    why = PlanningError(f"no plan within {time_limit:g} s: give more time")
    for attempt in range(TRIES):
        left = end - time.monotonic()
        if left <= 0:
            break
        again = replace(problem, seed=seed + attempt)
        try:
            course = Course.of(plan_all(again, planner, left, seed + attempt, method=method))
        except PlanningError as error:
            why = error
            continue
        wrong = fault(problem, course, way_points)
        if wrong is None:
            return course
        why = PlanningError(f"the plans of {attempt + 1} seeds cannot be driven: {wrong}")
    raise why


def fault(problem: Problem, course: Course, way_points: bool = False) -> str | None:
    """Why a course does not come out as planned in the simulator, or None."""
    for name, model, q in zip(problem.names, problem.models, course.configurations, strict=True):
        if ((q < model.lower - INSIDE) | (q > model.upper + INSIDE)).any():
            return f"{name} swings out of the workspace on its way; give it more room"
        drive = model.required_drive
        if (
            way_points
            and not drive.tracking_waypoint(model, q[:-1], q[1:], problem.dt, 1.0)[1].all()
        ):
            return f"{name} backs up, which way points do not; take actions='drive'"
    if not certify(problem, course.configurations):
        return (
            "who stops within its goal's tolerance is in the way of others;"
            " take a smaller goal_tolerance, or another method"
        )
    return None


def careful(scenario: Scenario, seed: int) -> Problem:
    """The problem with a margin that both of two robots may be off by.

    With none, where starts or goals are nearer than that to anything.
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

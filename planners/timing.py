"""Timed paths: configurations at each step, within limits of speed and acceleration.

In each step a robot moves straight from one configuration to the next: `env.step` executes this
motion, and a certificate verifies it. A robot stops at a waypoint where its direction
changes. Ruckig (L. Berscheid and T. Kroeger, "Jerk-limited real-time trajectory generation with
arbitrary target states", 2021) computes the profile along each stretch between stops: offline, in
closed form, with a duration of whole steps, and without leaving the straight line. TOPP-RA needs a
spline through the waypoints, which leaves the verified polyline.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots import Robot
from fgenv.robots.drives.base import ZERO, LegLimit, continues

from .errors import PlanningError

SPEED = 1.0  # m/s of the fastest point of a robot without a drive


def steps_of(robot: Robot, path: Floats, dt: float) -> Floats:
    """Configurations at each step of dt seconds along a path (m, nq), rest to rest: (k + 1, nq)."""
    return steps_together((robot,), (path,), dt)[0]


def steps_together(robots: Sequence[Robot], paths: Sequence[Floats], dt: float) -> list[Floats]:
    """Configurations of robots that pass waypoint i at the same time, (k + 1, nq) each.

    Args:
        robots: the robots, each within its own limits.
        paths: (m, nq) each, of equal length.
        dt: seconds.
    """
    durations, accelerations, stops = [], [], [0]
    before: list[Floats] = []
    for k in range(len(paths[0]) - 1):
        legs = [(path[k], path[k + 1]) for path in paths]
        limits = [
            limit
            for robot, leg in zip(robots, legs, strict=True)
            for limit in leg_limits(robot, *leg, dt)
        ]
        duration = full_speed_time(limits)
        durations.append(duration)
        lowest = min((limit.acceleration / limit.change for limit in limits), default=math.inf)
        accelerations.append(lowest * duration if duration > 0 else math.inf)
        after = [
            robot.difference(*leg) / max(duration, ZERO)
            for robot, leg in zip(robots, legs, strict=True)
        ]
        if k and not all(map(_passes, robots, before, after)):
            stops.append(k)
        before = after
    stops.append(len(durations))
    positions = [np.zeros(1)]
    for first, last in pairwise(stops):
        acceleration = min(accelerations[first:last], default=math.inf)
        positions.append(_profile(durations[first:last], acceleration, first, dt))
    at = np.concatenate(positions)
    return [_along(robot, path, at) for robot, path in zip(robots, paths, strict=True)]


def _profile(durations: list[float], acceleration: float, first: int, dt: float) -> Floats:
    """Positions after each step of a stretch between stops: index of the leg plus fraction."""
    ends = np.concatenate([[0.0], np.cumsum(durations)])
    if ends[-1] < ZERO:
        return np.array([first + float(len(durations))]) if ends[-1] > 0 else np.empty(0)
    legs = np.interp(_ruckig(ends[-1], acceleration, dt), ends, np.arange(len(ends), dtype=float))
    legs[-1] = len(durations)
    positions: Floats = first + legs
    return positions


def _ruckig(length: float, acceleration: float, dt: float) -> Floats:
    """Positions after each step, rest to rest at a speed of at most 1, in whole steps."""
    solver, problem, trajectory = _solver(dt)
    problem.target_position = [length]
    problem.max_velocity = [1.0]
    problem.max_acceleration = [acceleration]
    solver.calculate(problem, trajectory)
    steps = max(1, round(trajectory.duration / dt))
    return np.array([trajectory.at_time(k * dt)[0][0] for k in range(1, steps + 1)])


@cache
def _solver(dt: float):  # type: ignore[no-untyped-def]
    import ruckig

    problem = ruckig.InputParameter(1)
    problem.current_position = problem.current_velocity = problem.current_acceleration = [0.0]
    problem.target_velocity = problem.target_acceleration = [0.0]
    problem.duration_discretization = ruckig.DurationDiscretization.Discrete
    return ruckig.Ruckig(1, dt), problem, ruckig.Trajectory(1)


def _along(robot: Robot, path: Floats, at: Floats) -> Floats:
    """Configurations at positions along a path: index of the leg plus fraction."""
    if len(path) == 1:
        return np.repeat(path, len(at), axis=0)
    leg = np.minimum(at.astype(int), len(path) - 2)
    return robot.interpolate(path[leg], path[leg + 1], np.clip(at - leg, 0.0, 1.0))


def _passes(robot: Robot, before: Floats, after: Floats) -> bool:
    """Whether a robot may pass a waypoint without a stop, from its velocities (dof,) around it."""
    if robot.drive is None:
        return continues(before, after)
    return robot.drive.passes_waypoint(before, after)


def full_speed_time(limits: Sequence[LegLimit]) -> float:
    """Duration of a leg at full speed, seconds."""
    return max((limit.change / limit.speed for limit in limits), default=0.0)


def leg_limits(robot: Robot, q0: Floats, q1: Floats, dt: float) -> list[LegLimit]:
    """Quantities that change on a straight leg from q0 to q1 (nq,), with their limits.

    Raises:
        PlanningError: the robot's drive cannot move along the leg.
    """
    if robot.drive is None:
        length = float(robot.displacement_bound(q0, q1))
        return [LegLimit(length, SPEED, math.inf)] if length > ZERO else []
    try:
        return robot.drive.leg_limits(robot, q0, q1, dt)
    except ValueError as error:
        raise PlanningError(str(error)) from None

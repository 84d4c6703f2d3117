"""Limits of timed paths: configurations, speeds and accelerations."""

from __future__ import annotations

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots import Robot

from .problem import Problem

END_TOLERANCE = 1e-9  # meters of displacement, for rounding
SLACK = 1e-6  # of a limit
CORNER = 0.03  # of a car's speed: its deviation where a step crosses a corner between chords


def broken_limits(robot: Robot, q: Floats, dt: float) -> str | None:
    """First limit that configurations (k + 1, nq) at steps of dt seconds break, or None."""
    outside = ~np.asarray(robot.valid(q))
    if outside.any():
        return f"is beyond its limits at step {int(outside.argmax())}"
    drive = robot.drive
    if drive is None or len(q) < 2:
        return None
    q = np.concatenate([q, q[-1:]])  # the robot comes to rest
    actions, residual = drive.inverse(robot, q[:-1], q[1:], dt)
    undriven = residual > CORNER * np.abs(actions).max(axis=1) + SLACK
    if undriven.any():
        return f"goes where its drive cannot at step {int(undriven.argmax())}"
    before = np.concatenate([np.zeros_like(actions[:1]), actions[:-1]])
    values = drive.limited_values(robot, actions)
    too_fast, too_sudden = drive.limit_violations(robot, actions, before, dt, SLACK)
    for k, limit in enumerate(drive.limits(robot)):
        if too_fast[:, k].any():
            step = int(too_fast[:, k].argmax())
            return f"needs {limit.name} of {values[step, k]:.4g} {limit.unit} at step {step}"
        if too_sudden[:, k].any():
            step = int(too_sudden[:, k].argmax())
            return f"changes {limit.name} faster than it can at step {step}"
    return None


def path_fault(problem: Problem, i: int, q: Floats) -> str | None:
    """First fault of a robot's timed path in a problem, or None."""
    model = problem.models[i]
    if q.ndim != 2 or q.shape[1] != model.nq or not np.isfinite(q).all():
        return f"has configurations of shape {q.shape}, expected (steps + 1, {model.nq}), finite"
    if model.displacement_bound(q[0], problem.starts[i]) > END_TOLERANCE:
        return "does not begin at its start"
    if model.displacement_bound(q[-1], problem.goals[i]) > END_TOLERANCE:
        return "does not end at its goal"
    return broken_limits(model, q, problem.dt)

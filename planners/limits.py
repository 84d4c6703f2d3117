"""Whether a timed path keeps a robot's limits: of configurations, speeds and accelerations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots import Robot
from fgenv.robots.inverse_drive import actions_between, left_over

if TYPE_CHECKING:
    from .problem import Problem


THERE = 1e-9  # meters, or so much of a turn: rounding
SLACK = 1e-6  # of a limit
CORNER = 0.03  # of its speed, that a car is off where a step crosses a corner of its chords


def broken_limits(robot: Robot, q: Floats, dt: float) -> str | None:
    """What is wrong with configurations at steps of dt seconds, (k + 1, nq), or None."""
    outside = ~np.asarray(robot.valid(q))
    if outside.any():
        return f"is beyond its limits at step {int(outside.argmax())}"
    if robot.drive is None or len(q) < 2:
        return None
    q = np.concatenate([q, q[-1:]])  # it comes to rest
    asked = actions_between(robot, q[:-1], q[1:], dt)
    left = left_over(robot, q[:-1], q[1:], dt)
    beside = left > CORNER * np.abs(asked).max(axis=1) + SLACK
    if beside.any():
        return f"goes where its drive cannot at step {int(beside.argmax())}"
    before = np.concatenate([np.zeros_like(asked[:1]), asked[:-1]])
    for k, action in enumerate(robot.actions):
        value = asked[:, k]
        least, most = action.low - SLACK * abs(action.low), action.high + SLACK * abs(action.high)
        fast = (value < least) | (value > most)
        if fast.any():
            step = int(fast.argmax())
            return f"needs {action.name} of {value[step]:.4g} {action.unit} at step {step}"
        sudden = np.abs(value - before[:, k]) > action.rate * dt * (1 + SLACK) + 1e-9
        if sudden.any():
            return f"changes {action.name} faster than it can at step {int(sudden.argmax())}"
    return None


def wrong_with(problem: Problem, i: int, q: Floats) -> str | None:
    """What of a robot's timed path does not fit the problem, or None."""
    model = problem.models[i]
    if q.ndim != 2 or q.shape[1] != model.nq or not np.isfinite(q).all():
        return f"has configurations of shape {q.shape}, expected (steps + 1, {model.nq}), finite"
    for row, end, told in ((q[0], problem.starts[i], "begin"), (q[-1], problem.goals[i], "end")):
        if model.distance(row, end) > THERE:
            return f"does not {told} at its {'start' if told == 'begin' else 'goal'}"
    return broken_limits(model, q, problem.dt)

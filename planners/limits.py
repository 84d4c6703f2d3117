"""Whether a timed path keeps a robot's limits: of configurations, speeds and accelerations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fgenv.robots import Robot
from fgenv.robots.driving import actions_between

Floats = NDArray[np.float64]

SLACK = 1e-6  # of a limit


def broken_limits(robot: Robot, q: Floats, dt: float) -> str | None:
    """What is wrong with configurations at steps of dt seconds, (k + 1, nq), or None."""
    outside = ~np.asarray(robot.valid(_turned(robot, q)))
    if outside.any():
        return f"is beyond its limits at step {int(outside.argmax())}"
    if robot.drive is None or len(q) < 2:
        return None
    asked = actions_between(robot, q[:-1], q[1:], dt)
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


def _turned(robot: Robot, q: Floats) -> Floats:
    """Workspaces bound where a base is sent, not where it swings on its way: they are not asked."""
    if robot.workspace is None:
        return q
    q = q.copy()
    place = slice(0, robot.workspace.shape[1])
    q[:, place] = np.clip(q[:, place], robot.workspace[0], robot.workspace[1])
    return q

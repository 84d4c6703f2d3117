"""Next targets of robots: the hint of a global path, or the goal."""

from __future__ import annotations

import math

import numpy as np

from fgenv import _core
from fgenv.arrays import Floats, Floats32
from fgenv.envs import View


def path_targets(view: View, observations: Floats32) -> Floats:
    """Next target configurations, (worlds, robots, nq): path hints of planar robots, else goals.

    A planar robot faces its direction of travel until the time left suffices just for the turn to
    its goal's heading: its observations and actions are then in a frame with its path ahead.
    """
    q, targets, remaining = view.configurations, view.goals, view.remaining
    for i, (robot, parts) in enumerate(zip(view.robots, view.layouts, strict=True)):
        if robot.base != "planar":
            continue
        hint = next((part.slice for part in parts if part.name == "path_hint"), None)
        if hint is not None:
            base = robot.forward(q[:, i, : robot.nq], 0)
            x, y = np.moveaxis(observations[:, i, hint].astype(np.float64), -1, 0)
            for k in range(2):
                targets[:, i, k] = base[:, k, 0] * x + base[:, k, 1] * y + base[:, k, 3]
        offset = targets[:, i, :2] - q[:, i, :2]
        rests = (offset == 0.0).all(axis=1)
        yaw = np.where(rests, q[:, i, 2], [_core.arc_tangent(y, x) for x, y in offset.tolist()])
        turn = np.abs(np.remainder(targets[:, i, 2] - q[:, i, 2] + math.pi, 2 * math.pi) - math.pi)
        turn_rate = next((a.high for a in robot.actions if a.name == "yaw_rate"), math.inf)
        turns_to_goal = turn / turn_rate * robot.actions[0].high >= remaining[:, i]
        targets[:, i, 2] = np.where(turns_to_goal, targets[:, i, 2], yaw)
    return targets

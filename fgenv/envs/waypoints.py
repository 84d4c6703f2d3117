"""Waypoints toward a configuration: the actions of `actions="way_points"`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from fgenv.arrays import Floats

    from .simulator import Simulator


def way_points_toward(simulator: Simulator, targets: ArrayLike) -> Floats:
    """Waypoints straight toward targets (worlds, robots, nq), at most as far as speeds reach.

    Raises:
        ValueError: wrong shape, or a number that is not finite.
    """
    expected, q = np.asarray(targets, dtype=np.float64), simulator.configurations
    if expected.shape != q.shape:
        raise ValueError(f"targets: got shape {expected.shape}, expected {q.shape}")
    if not np.isfinite(expected).all():
        raise ValueError("targets: expected finite numbers")
    actions = np.zeros((simulator.n_worlds, simulator.n_robots, simulator.action_size))
    for i, robot in enumerate(simulator.robots):
        ends = q[:, i, : robot.nq], expected[:, i, : robot.nq]
        drive = robot.required_drive
        waypoints = drive.waypoint_toward(robot, *ends, simulator.way_point_seconds)
        actions[:, i, : waypoints.shape[1]] = waypoints
    return actions

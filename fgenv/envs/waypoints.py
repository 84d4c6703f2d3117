"""Waypoints toward a configuration: the actions of `actions="way_points"`."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats

from .state_readers import SimulatorState


def way_points_toward(simulator: SimulatorState, targets: ArrayLike) -> Floats:
    """Return waypoints straight toward targets (worlds, robots, nq), within reach of the speeds.

    Raises:
        ValueError: wrong shape, or a number that is not finite.
    """
    ends, q = np.asarray(targets, dtype=np.float64), simulator.configurations
    if ends.shape != q.shape:
        raise ValueError(f"targets: got shape {ends.shape}, expected {q.shape}")
    if not np.isfinite(ends).all():
        raise ValueError("targets: expected finite numbers")
    seconds = simulator.settings.way_point_seconds
    actions = np.zeros((simulator.n_worlds, simulator.n_robots, simulator.action_size))
    for i, robot in enumerate(simulator.robots):
        nq, drive = robot.nq, robot.required_drive
        waypoints = drive.waypoint_toward(robot, q[:, i, :nq], ends[:, i, :nq], seconds)
        actions[:, i, : waypoints.shape[1]] = waypoints
    return actions

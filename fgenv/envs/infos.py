"""Infos of a step, beside observations and rewards: the same keys and types on every interface."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .simulator import Simulator
from .state_readers import MOVING

Info = dict[str, Any]
NO_COLLISION: Info = {
    "collision": False,
    "other": -1,
    "collision_time": -1.0,
    "collision_x": 0.0,
    "collision_y": 0.0,
    "collision_z": 0.0,
}


def info_arrays(simulator: Simulator) -> dict[str, NDArray[Any]]:
    """Return the infos of all robots as arrays (worlds, robots).

    - `collision`: whether the motion of the robot met another body in this step;
    - `other`: index of the robot that it met; -1: another body, or none;
    - `collision_time`: seconds since the begin of the step; -1 without a collision;
    - `collision_x`, `collision_y`, `collision_z`: contact point, world frame, m; 0 without one;
    - `masked`: number of bodies in the mask of its motion;
    - `checks`: number of tested pairs of bodies;
    - `success`: whether the robot has arrived;
    - `clearance`: distance to the nearest body, m, if measured.

    `Simulator.collisions` returns the collisions with the names of the bodies.
    """
    hit = simulator.hits >= 0
    x, y, z = np.moveaxis(simulator.hit_points, -1, 0)
    arrays: dict[str, NDArray[Any]] = {
        "collision": hit,
        "other": np.where(hit, simulator.hit_robots, -1),
        "collision_time": np.where(hit, simulator.hit_times, -1.0),
        "collision_x": x,
        "collision_y": y,
        "collision_z": z,
        "masked": simulator.masked,
        "checks": simulator.checks,
        "success": simulator.status != MOVING,
    }
    if has_clearances(simulator):
        arrays["clearance"] = simulator.clearances
    return arrays


def infos(simulator: Simulator, world: int = 0) -> list[Info]:
    """Return the info of each robot of a world, see `info_arrays`: numbers and booleans."""
    arrived = (simulator.status[world] != MOVING).tolist()
    masked, checks = simulator.masked[world].tolist(), simulator.checks[world].tolist()
    rows: list[Info] = [
        {**NO_COLLISION, "masked": m, "checks": c, "success": s}
        for m, c, s in zip(masked, checks, arrived, strict=True)
    ]
    if has_clearances(simulator):
        for info, clearance in zip(rows, simulator.clearances[world].tolist(), strict=True):
            info["clearance"] = clearance
    hits = simulator.hits[world].tolist()
    if max(hits) >= 0:  # rare: the arrays of the contacts are read in no other step
        robots, times = simulator.hit_robots[world].tolist(), simulator.hit_times[world].tolist()
        points = simulator.hit_points[world].tolist()
        for info, hit, *contact, point in zip(rows, hits, robots, times, points, strict=True):
            if hit >= 0:
                info.update(zip(NO_COLLISION, (True, *contact, *point), strict=True))
    return rows


def has_clearances(simulator: Simulator) -> bool:
    """Whether the simulator measures clearances."""
    return simulator.settings.clearance or bool(simulator.reward.weights.get("closeness"))

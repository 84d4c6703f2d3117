"""Infos of a step, beside observations and rewards: the same keys and types on every interface."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .simulator import Simulator
from .state_readers import MOVING

Info = dict[str, Any]


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
    """Return the info of each robot of a world: numbers and booleans, see `info_arrays`."""
    columns = {name: values[world].tolist() for name, values in info_arrays(simulator).items()}
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def has_clearances(simulator: Simulator) -> bool:
    """Whether the simulator measures clearances."""
    return simulator.settings.clearance or bool(simulator.reward.weights.get("closeness"))

"""Infos of a step, beside observations and rewards."""

from __future__ import annotations

from typing import Any

from .simulator import Simulator
from .state_readers import MOVING

Info = dict[str, Any]


def infos(simulator: Simulator, world: int = 0) -> list[Info]:
    """Return the info of each robot of a world.

    - `collision`: a `Collision` (with which body, where, when), or None;
    - `masked`: number of bodies in the mask of its motion;
    - `checks`: number of tested pairs of bodies;
    - `success`: whether the robot has arrived;
    - `clearance`: distance to the nearest body, m, if measured.
    """
    arrived = (simulator.status[world] != MOVING).tolist()
    masked, checks = simulator.masked[world].tolist(), simulator.checks[world].tolist()
    rows: list[Info] = [
        {"collision": None, "masked": m, "checks": c, "success": s}
        for m, c, s in zip(masked, checks, arrived, strict=True)
    ]
    if has_clearances(simulator):
        for info, clearance in zip(rows, simulator.clearances[world].tolist(), strict=True):
            info["clearance"] = clearance
    if max(simulator.hits[world].tolist()) >= 0:
        for collision in simulator.collisions(world):
            rows[simulator.names.index(collision.robot)]["collision"] = collision
    return rows


def has_clearances(simulator: Simulator) -> bool:
    """Whether the simulator measures clearances."""
    return simulator.settings.clearance or bool(simulator.reward.weights.get("closeness"))

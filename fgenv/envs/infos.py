"""What is told of each robot's last step, beside observation and reward."""

from __future__ import annotations

from typing import Any

from .simulator import Simulator
from .state_readers import MOVING

Told = dict[str, Any]


def infos(simulator: Simulator, world: int = 0) -> list[Told]:
    """Of each robot of a world:

    - `collision`: None, or a `Collision`: whom it met, where, when;
    - `masked`: how many bodies its motion's mask left;
    - `checks`: how many pairs of bodies were looked at;
    - `success`: whether it has arrived;
    - `clearance`: meters to what is nearest, where that is measured.
    """
    arrived = (simulator.status[world] != MOVING).tolist()
    masked, checks = simulator.masked[world].tolist(), simulator.checks[world].tolist()
    told: list[Told] = [
        {"collision": None, "masked": m, "checks": c, "success": s}
        for m, c, s in zip(masked, checks, arrived, strict=True)
    ]
    if measured(simulator):
        for info, clearance in zip(told, simulator.clearances[world].tolist(), strict=True):
            info["clearance"] = clearance
    if max(simulator.hits[world].tolist()) >= 0:
        for collision in simulator.collisions(world):
            told[simulator.names.index(collision.robot)]["collision"] = collision
    return told


def measured(simulator: Simulator) -> bool:
    """Whether clearances are."""
    return simulator.clearance or bool(simulator.reward.weights.get("closeness"))

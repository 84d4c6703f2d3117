"""Shared set-up of tests of policies, records and runs: one robot per kind in free space."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fgenv.scenarios import Scenario
from fgenv.scenarios.schema import yaw_quaternion

Drives = dict[str, dict[str, Any]]
DRIVES: Drives = {
    "holonomic": {"speed": 1.0, "turn_rate": 1.5, "acceleration": 2.0, "turn_acceleration": 3.0},
    "differential": {"speed": 1.0, "turn_rate": 1.5, "acceleration": 1.0, "reverse": 0.5},
    "car": {
        "speed": 2.0,
        "reverse": 0.5,
        "wheelbase": 0.7,
        "min_turning_radius": 1.5,
        "steering_rate": 3.0,
    },
    "drone": {"speed": 2.0, "climb": 1.0, "turn_rate": 1.5, "acceleration": 3.0},
    "joint_velocity": {"acceleration": 4.0},
}
ARM = "package://fgenv/scenarios/library/arm.urdf"


def alone(kind: str, seed: int = 0, **fields: Any) -> Scenario:
    """A robot with the drive in free space; the seed gives its goal."""
    model: dict[str, Any] = {"drive": {"kind": kind, **DRIVES[kind]}}
    if kind == "joint_velocity":
        model["urdf"] = ARM
    else:
        model |= {"shape": "box", "base": "free" if kind == "drone" else "planar"}
    start, goal = ends(kind, np.random.default_rng(seed))
    document: dict[str, Any] = {
        "version": 1,
        "name": f"one {kind}",
        "seed": seed,
        "shapes": {"box": {"kind": "box", "size": (0.5, 0.4, 0.3)}},
        "models": {"m": model},
        "robots": [{"name": "robot", "model": "m", "start": start, "goal": goal}],
    }
    return Scenario.model_validate(document | fields)


def ends(kind: str, rng: np.random.Generator) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Start and goal."""
    yaw, far = rng.uniform(-math.pi, math.pi, 2), rng.uniform(-4.0, 4.0, 3)
    if kind == "joint_velocity":
        return (0.0, -1.0, 1.5, 0.0, 0.5, 0.0), tuple(
            rng.uniform(-0.6, 0.6, 6) + (0, -1, 1.5, 0, 0.5, 0)
        )
    if kind == "drone":
        return (0, 0, 0, *yaw_quaternion(yaw[0])), (*far.tolist(), *yaw_quaternion(yaw[1]))
    if kind == "car":  # ahead, as pure pursuit requires
        course = yaw[0] + rng.uniform(-0.6, 0.6)
        x, y = 8.0 * math.cos(course), 8.0 * math.sin(course)
        return (0, 0, yaw[0]), (x, y, course + rng.uniform(-0.6, 0.6))
    return (0, 0, yaw[0]), (far[0], far[1], yaw[1])

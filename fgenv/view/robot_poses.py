"""Poses of robots: of their parts at a configuration, and of their bases over a record."""

from __future__ import annotations

from fgenv.arrays import Floats
from fgenv.envs import Record
from fgenv.robots import Robot
from fgenv.scenarios import Built


def part_poses(robot: Robot, q: Floats) -> list[Floats]:
    """Return the poses (4, 4) of a robot's parts at a configuration, (nq,) or longer."""
    links = robot.forward(q[: robot.nq])
    return [links[part.link] @ part.origin for part in robot.parts]


def base_position(robot: Robot, q: Floats) -> Floats:
    """Return the positions (..., 3) of a robot's base at configurations, (..., nq) or longer."""
    return robot.forward(q[..., : robot.nq], robot.root)[..., :3, 3]


def base_paths(record: Record, built: Built) -> dict[int, Floats]:
    """Return the base's positions (steps + 1, 3) of each mobile robot of a record, by index."""
    return {
        i: base_position(robot, record["configurations"][:, i])
        for i, robot in enumerate(built.robots)
        if robot.base != "fixed"
    }

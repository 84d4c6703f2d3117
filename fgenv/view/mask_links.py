"""Collision masks as pictures show them: each robot's mask for the motion of its next second."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.envs import Record
from fgenv.envs.state_readers import GONE
from fgenv.robots import Robot
from fgenv.scenarios import Built

HORIZON = 1.0  # seconds of motion that a mask covers


def set_masks(
    world: World, robots: Sequence[Robot], present: Iterable[int], q: Floats, change: Floats
) -> None:
    """Set the path of each present robot from q to q + change, both (robots, nq)."""
    for i in present:
        robot = robots[i]
        start, step = q[i, : robot.nq], change[i, : robot.nq].copy()
        if robot.base == "free":
            step[3:7] = 0.0  # the quaternion stays
        world.set_path(robot.name, [start, start + step])


def present_robots(record: Record, step: int) -> list[int]:
    """Return the robots that are present after a step."""
    return np.flatnonzero(record["status"][step] != GONE).tolist()


def world_at(record: Record, built: Built, step: int, masks: bool = True) -> World:
    """Return the world after a step of a record, with all bodies and, by default, with masks."""
    q, present = record["configurations"], present_robots(record, step)
    rows = [q[step, i, : robot.nq] for i, robot in enumerate(built.robots)]
    world = built.world(rows)
    for i in set(range(len(built.robots))) - set(present):
        world.remove(built.robots[i].name)
    if masks:
        change = (q[step] - q[max(0, step - 1)]) * (HORIZON / record.dt)
        set_masks(world, built.robots, present, q[step], change)
    return world


def mask_links(world: World, robot: str) -> list[tuple[int, Floats]]:
    """Return the bodies in a robot's mask, each with a line (2, 3) from the robot to its box."""
    center = box_center(world, int(world.parts(robot)[0]))
    candidates = world.candidates(robot).tolist()
    return [(body, np.array([center, nearest_in_box(world, body, center)])) for body in candidates]


def box_center(world: World, body: int) -> Floats:
    """Return the center (3,) of a body's box."""
    record = world.record(body)
    local = record.shape.bounds.mean(axis=0)
    return np.asarray(record.pose[:3, :3] @ local + record.pose[:3, 3])


def nearest_in_box(world: World, body: int, point: Floats) -> Floats:
    """Return the point (3,) of a body's box nearest to a point; the center if it is inside."""
    record = world.record(body)
    low, high = record.shape.bounds
    local = record.pose[:3, :3].T @ (point - record.pose[:3, 3])
    if ((local > low) & (local < high)).all():
        return box_center(world, body)
    return np.asarray(record.pose[:3, :3] @ np.clip(local, low, high) + record.pose[:3, 3])

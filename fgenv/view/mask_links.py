"""Masks as pictures show them: set by the motion that each robot goes on with for a second."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.envs import Record
from fgenv.robots import Robot
from fgenv.scenarios import Built

GONE = 2  # of a record's status
AHEAD = 1.0  # seconds


def set_masks(
    world: World, robots: Sequence[Robot], here: Iterable[int], q: Floats, by: Floats
) -> None:
    """Give robots that are here paths from configurations q, (robots, nq), on by so much."""
    for i in here:
        robot = robots[i]
        at, on = q[i, : robot.nq], by[i, : robot.nq].copy()
        if robot.base == "free":
            on[3:7] = 0.0  # a quaternion stays
        world.set_path(robot.name, [at, at + on])


def present(record: Record, step: int) -> list[int]:
    """Robots that are there after a step."""
    return np.flatnonzero(record["status"][step] != GONE).tolist()


def world_at(record: Record, built: Built, step: int, masks: bool = True) -> World:
    """Everything where it was after a step of a record, with masks set if expected."""
    q, here = record["configurations"], present(record, step)
    rows = [q[step, i, : robot.nq] for i, robot in enumerate(built.robots)]
    world = built.world(rows)
    for i in set(range(len(built.robots))) - set(here):
        world.remove(built.robots[i].name)
    if masks:
        by = (q[step] - q[max(0, step - 1)]) * (AHEAD / record.dt)
        set_masks(world, built.robots, here, q[step], by)
    return world


def links(world: World, robot: str) -> list[tuple[int, Floats]]:
    """Who bears a robot's bit, and a line (2, 3) from the robot to each, where its box begins."""
    here = middle(world, int(world.parts(robot)[0]))
    found = world.candidates(robot).tolist()
    return [(body, np.array([here, nearby(world, body, here)])) for body in found]


def middle(world: World, body: int) -> Floats:
    """The middle (3,) of a body's box."""
    record = world.record(body)
    local = record.shape.bounds.mean(axis=0)
    return np.asarray(record.pose[:3, :3] @ local + record.pose[:3, 3])


def nearby(world: World, body: int, point: Floats) -> Floats:
    """The point (3,) of a body's box that is nearest to one; its middle where that is inside."""
    record = world.record(body)
    low, high = record.shape.bounds
    local = record.pose[:3, :3].T @ (point - record.pose[:3, 3])
    if ((local > low) & (local < high)).all():
        return middle(world, body)
    return np.asarray(record.pose[:3, :3] @ np.clip(local, low, high) + record.pose[:3, 3])

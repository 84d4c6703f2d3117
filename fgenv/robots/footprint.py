"""What robots on planar bases take of the plane."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats

from .limits import reaches

if TYPE_CHECKING:
    from .robot import Robot


LONG = 1.5  # times as long as wide: who is has to turn with its path


def footprint(robot: Robot) -> Floats:
    """Vertices (k, 2) of a robot's root link in its own frame, meters."""
    found = [p.shape.vertices @ p.origin[:2, :3].T + p.origin[:2, 3] for p in robot.links[0].shapes]
    return np.concatenate(found) if found else np.zeros((1, 2))


def sides_of(robot: Robot) -> Floats:
    """Length and width of a robot's root link in its own frame, meters, (2,)."""
    sides: Floats = np.ptp(footprint(robot), axis=0)
    return sides


def is_long(robot: Robot) -> bool:
    """Whether a robot has to look along its path to get through where it is narrow."""
    short, long = sorted(sides_of(robot))
    return bool(long > LONG * short)


def enclosing(robot: Robot) -> float:
    """Radius of the disc about a planar base's origin that encloses the robot, meters."""
    if any(link.shapes for link in robot.links[1:]):
        return float(reaches(robot)[robot.root])
    return math.sqrt(float((footprint(robot) ** 2).sum(axis=1).max()))


def discs_of(robot: Robot) -> tuple[Floats, float]:
    """Discs that hold a robot: where their centers are ahead of its base, and their radius, meters.

    A row of them for one link that is long ahead, else one about the base.
    """
    (back, right), (front, left) = footprint(robot).min(axis=0), footprint(robot).max(axis=0)
    length, width = front - back, 2.0 * max(left, -right)
    if any(link.shapes for link in robot.links[1:]) or not length > LONG * width > 0:
        return np.zeros(1), enclosing(robot)
    n = math.ceil(length / width)
    centers: Floats = back + length / n * (np.arange(n) + 0.5)
    return centers, 0.5 * math.hypot(length / n, width)

"""Footprints of robots on planar bases: vertices, sides, enclosing discs."""

from __future__ import annotations

import math

import numpy as np

from fgenv.arrays import Floats

from .kinematic_tree import KinematicTree

ELONGATED = 1.5  # length over width from which a robot has to align with its path


def footprint(robot: KinematicTree) -> Floats:
    """Vertices (k, 2) of a robot's root link in its own frame, meters."""
    vertices = [
        p.shape.vertices @ p.origin[:2, :3].T + p.origin[:2, 3] for p in robot.links[0].shapes
    ]
    return np.concatenate(vertices) if vertices else np.zeros((1, 2))


def footprint_size(robot: KinematicTree) -> Floats:
    """Length and width of a robot's root link in its own frame, meters, (2,)."""
    size: Floats = np.ptp(footprint(robot), axis=0)
    return size


def is_elongated(robot: KinematicTree) -> bool:
    """Whether a robot has to align with its path to pass a narrow passage."""
    short, long = sorted(footprint_size(robot))
    return bool(long > ELONGATED * short)


def enclosing_radius(robot: KinematicTree) -> float:
    """Radius of the disc around a planar base's origin that encloses the robot, meters."""
    if any(link.shapes for link in robot.links[1:]):
        return float(robot.reach[robot.root])
    return math.sqrt(float((footprint(robot) ** 2).sum(axis=1).max()))


def enclosing_discs(robot: KinematicTree) -> tuple[Floats, float]:
    """Centers of discs that enclose a robot, as distances along its x axis, and their radius (m).

    Several discs for a robot of one link that is elongated along x, else one around the base.
    """
    (back, right), (front, left) = footprint(robot).min(axis=0), footprint(robot).max(axis=0)
    length, width = front - back, 2.0 * max(left, -right)
    if any(link.shapes for link in robot.links[1:]) or not length > ELONGATED * width > 0:
        return np.zeros(1), enclosing_radius(robot)
    n = math.ceil(length / width)
    centers: Floats = back + length / n * (np.arange(n) + 0.5)
    return centers, 0.5 * math.hypot(length / n, width)

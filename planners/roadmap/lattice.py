"""Positions of a roadmap's vertices: an even lattice, and pairs of neighbors in it."""

from __future__ import annotations

import itertools
import math

import numpy as np

from fgenv.arrays import Floats, Ints
from fgenv.robots import Robot

MIN_GAP = 0.4  # of the pitch: lattice points nearer than this to a start or goal are left out
MARGIN = 3.0  # robot sizes around starts and goals, for robots without a workspace


def sampling_box(robot: Robot, ends: Floats, size: float) -> Floats:
    """Lowest and highest base position (2, d): the workspace, or a box around ends (n, d)."""
    if robot.workspace is not None:
        return np.asarray(robot.workspace)
    reach = MARGIN * size + np.ptp(ends, axis=0).max()
    return np.stack([ends.min(0) - reach, ends.max(0) + reach])


def lattice_pitch(box: Floats, size: float, max_points: int, fine: float = 1.0) -> float:
    """Meters between the points of a lattice in a box (2, d) with at most `max_points` points.

    Args:
        size: diameter of the robot, meters.
        fine: least pitch, relative to that at which two robots just fit at neighboring points.
    """
    sides = np.maximum(box[1] - box[0], size)
    even: float = float(np.prod(sides) / max_points) ** (1.0 / len(sides))
    return max(1.05 * fine * size, even)


def lattice(box: Floats, pitch: float, rng: np.random.Generator) -> Floats:
    """Points (n, d) of a lattice that fills a box (2, d) evenly, with a random offset."""
    sides = box[1] - box[0]
    counts = [max(1, math.floor(side / pitch)) for side in sides]
    offset = rng.uniform(0.25, 0.75, len(sides))  # of the rest of each side
    axes = [
        low + k * (side - (n - 1) * pitch) + pitch * np.arange(n)
        for low, side, n, k in zip(box[0], sides, counts, offset, strict=True)
    ]
    return np.array(list(itertools.product(*axes))).reshape(-1, len(sides))


def apart(points: Floats, ends: Floats, pitch: float) -> Floats:
    """Points (n, d) of a lattice without those that are too near to ends (m, d)."""
    if not len(ends) or not len(points):
        return points
    gaps = ((points[:, None] - ends) ** 2).sum(-1).min(1)
    kept: Floats = points[gaps > (MIN_GAP * pitch) ** 2]
    return kept


def neighbor_pairs(points: Floats, reach: float, k: int) -> Ints:
    """Sorted pairs (m, 2) of each point of (n, d) and its k nearest within reach (m)."""
    pairs: set[tuple[int, int]] = set()
    for i, point in enumerate(points):
        gaps = ((points - point) ** 2).sum(1)
        gaps[i] = np.inf
        near = np.argsort(gaps, kind="stable")[:k]
        pairs.update((min(i, j), max(i, j)) for j in near[gaps[near] <= reach * reach].tolist())
    return np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2)

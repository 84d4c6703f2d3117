"""Where a roadmap's places are: an even lattice of a workspace, or random configurations."""

from __future__ import annotations

import itertools
import math

import numpy as np

from fgenv.arrays import Floats, Ints
from fgenv.robots import Robot

NEARER = 0.4  # of a lattice's pitch: places nearer than this to one that is expected are left out
ROOM = 3.0  # robots' sizes that are left around starts and goals where there is no workspace


def box(robot: Robot, ends: Floats, size: float) -> Floats:
    """Lowest and highest position (2, d) of a base: its workspace, or around ends (n, d)."""
    if robot.workspace is not None:
        return np.asarray(robot.workspace)
    reach = ROOM * size + np.ptp(ends, axis=0).max()
    return np.stack([ends.min(0) - reach, ends.max(0) + reach])


def pitch(room: Floats, size: float, most: int, fine: float = 1.0) -> float:
    """Meters between places, for robots of a size (diameter, m), no more than `most` places.

    Two robots just fit at two places; `fine` times as much at least.
    """
    sides = np.maximum(room[1] - room[0], size)
    even: float = float(np.prod(sides) / most) ** (1.0 / len(sides))
    return max(1.05 * fine * size, even)


def lattice(room: Floats, step: float, rng: np.random.Generator) -> Floats:
    """Positions (n, d), `step` meters apart, filling a room evenly; which ones, chance decides."""
    sides = room[1] - room[0]
    counts = [max(1, math.floor(side / step)) for side in sides]
    shift = rng.uniform(0.25, 0.75, len(sides))  # of what is left of a pitch at either end
    lines = [
        low + k * (side - (n - 1) * step) + step * np.arange(n)
        for low, side, n, k in zip(room[0], sides, counts, shift, strict=True)
    ]
    return np.array(list(itertools.product(*lines))).reshape(-1, len(sides))


def apart(places: Floats, expected: Floats, step: float) -> Floats:
    """Those of places (n, d) that are not too near to the expected ones (m, d)."""
    if not len(expected) or not len(places):
        return places
    gaps = ((places[:, None] - expected) ** 2).sum(-1).min(1)
    kept: Floats = places[gaps > (NEARER * step) ** 2]
    return kept


def neighbors(places: Floats, reach: float, most: int) -> Ints:
    """Pairs (m, 2), rising, of places (n, d) within reach (m), each with its `most` nearest."""
    pairs: set[tuple[int, int]] = set()
    for i, place in enumerate(places):
        gaps = ((places - place) ** 2).sum(1)
        gaps[i] = np.inf
        near = np.argsort(gaps, kind="stable")[:most]
        pairs.update((min(i, j), max(i, j)) for j in near[gaps[near] <= reach * reach].tolist())
    return np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2)

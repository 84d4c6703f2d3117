"""Proof that a whole path is free, edge by edge, and how much room it leaves."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats
from fgenv.planners.planar import PlanarChecker
from fgenv.scenarios.se2 import as_path, reach, refine

ROOM = 1e-4  # meters that the clearance is found to
LOOK = 0.02  # meters between the places where it is looked for


@dataclass(frozen=True)
class Proof:
    """`proved`: the motion along each of the path's `edges` is free, all along.

    `least` (m) is then certified too: no body comes nearer on the way; the nearest place is about
    `where` (x, y, yaw). Not proved: `where` is how far it is free, `least` is 0.
    """

    proved: bool
    least: float
    where: tuple[float, float, float]
    edges: int


def prove_free(checker: PlanarChecker, path: ArrayLike) -> Proof:
    """Prove a path (n, 3) free between its configurations too, not only at them."""
    q = as_path(path)
    result = checker.motion(q)
    if not result:
        edge = int(np.flatnonzero(~result.free)[0])
        return _proof(False, 0.0, q[edge] + result.contact[edge] * (q[edge + 1] - q[edge]), q)
    places = refine(q, reach(checker.shape.vertices), LOOK)
    gaps = checker.clearance(places)
    nearest = int(gaps.argmin())
    least, most = 0.0, float(gaps[nearest])
    if not np.isfinite(most):
        return _proof(True, most, places[0], q)
    while most - least > ROOM:
        middle = (least + most) / 2
        least, most = (middle, most) if checker.motion(q, middle) else (least, middle)
    return _proof(True, least, places[nearest], q)


def _proof(proved: bool, least: float, where: Floats, q: Floats) -> Proof:
    x, y, yaw = where.tolist()
    return Proof(proved, least, (x, y, yaw), len(q) - 1)

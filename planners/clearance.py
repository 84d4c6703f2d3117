"""Proof that a whole path is free, by conservative advancement over the clearance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fgenv.collision import distance
from fgenv.planners.planar import PlanarChecker
from fgenv.scenarios.planar import Floats, as_path, as_poses, reach, travel


@dataclass(frozen=True)
class Clearance:
    """`proved` says that no point of the path collides; `least` is the smallest clearance (m)
    met on the way, at `where` (x, y, yaw), in so many `queries`."""

    proved: bool
    least: float
    where: tuple[float, float, float]
    queries: int


def prove_free(checker: PlanarChecker, path: ArrayLike, *, tolerance: float = 1e-5) -> Clearance:
    """Prove a path (n, 3) free between its configurations too, not only at them.

    With clearance d, the path is free until some point of the body may have moved d. Where the
    clearance falls below `tolerance` metres the proof stops: not proved.
    """
    q = as_path(path)
    done = np.concatenate([[0.0], np.cumsum(travel(q, reach(checker.shape.vertices)))])
    at, least, where, queries = 0.0, np.inf, q[0], 0
    while True:
        here = np.array([np.interp(at, done, q[:, k]) for k in range(3)])
        gap, queries = _gap(checker, here), queries + 1
        if gap < least:
            least, where = gap, here
        if least < tolerance or at >= done[-1]:
            x, y, yaw = where.tolist()
            return Clearance(least >= tolerance, float(least), (x, y, yaw), queries)
        at = min(at + gap, float(done[-1]))


def _gap(checker: PlanarChecker, q: Floats) -> float:
    """Metres to the nearest obstacle; infinite where there is none."""
    pose = as_poses(q, checker.height)
    gaps = (distance(checker.shape, pose, b.shape, b.pose) for b in checker.obstacles)
    return min(gaps, default=np.inf)

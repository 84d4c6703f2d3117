"""Conflicts: steps in which the paths of two robots collide."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fgenv.arrays import Ints
from fgenv.planners.roadmap.motion_table import ABSENT
from fgenv.planners.sipp.sipp import RoadmapPath

from .roadmap_set import RoadmapSet

Conflicts = dict[tuple[int, int], "Conflict"]  # by pair of robots


@dataclass(frozen=True)
class Conflict:
    """Robots i < j collide; `step` is the first step of the collision."""

    step: int
    i: int
    j: int


def conflicts_of(roadmaps: RoadmapSet, i: int, paths: Mapping[int, RoadmapPath]) -> Conflicts:
    """Conflicts of robot i with each of the other robots, by pair."""
    conflicts: Conflicts = {}
    for kind in sorted({roadmaps.kinds[j] for j in paths if j != i}):
        others = [j for j in paths if j != i and roadmaps.kinds[j] == kind]
        rows, steps = _collisions(roadmaps, i, others, kind, paths)
        for k, j in enumerate(others):
            met = steps[rows == k]
            if len(met):
                pair = min(i, j), max(i, j)
                conflicts[pair] = Conflict(int(met[0]), *pair)
    return conflicts


def _collisions(
    roadmaps: RoadmapSet, i: int, others: list[int], kind: int, paths: Mapping[int, RoadmapPath]
) -> tuple[Ints, Ints]:
    """Collisions of robot i with others of one kind: places in `others` and steps, (n,) each."""
    pairs, length = roadmaps.pairs, max(len(paths[j].motions) for j in (i, *others)) + 1
    own = np.broadcast_to(_padded(roadmaps, paths[i], length), (len(others), length))
    theirs = np.stack([_padded(roadmaps, paths[j], length) for j in others])
    rows, steps = np.nonzero((own != ABSENT) & (theirs != ABSENT))
    args = roadmaps.kinds[i], own[rows, steps], kind, theirs[rows, steps]
    hit = pairs.collide(*args)
    return rows[hit], steps[hit]


def _padded(roadmaps: RoadmapSet, path: RoadmapPath, length: int) -> Ints:
    """Motions of a path in `length` steps, the rest after its end included."""
    out = np.full(length, path.goal if roadmaps.stay else ABSENT, dtype=np.int64)
    out[: len(path.motions)] = path.motions
    return out

"""Splitting of a conflict into two constraints, the branching step of conflict-based search."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fgenv.planners.roadmap.roadmap import INF
from fgenv.planners.sipp.sipp import WAIT, Action, RoadmapPath

from .conflicts import Conflict
from .constraints import Constraint
from .roadmap_set import RoadmapSet


class ConflictSplitter:
    """Splits conflicts; collision results of two actions are cached."""

    def __init__(self, roadmaps: RoadmapSet) -> None:
        self.roadmaps = roadmaps
        self._offsets: dict[tuple[int, int, int, int], frozenset[int]] = {}

    def split(
        self, conflict: Conflict, paths: Mapping[int, RoadmapPath]
    ) -> tuple[Constraint, Constraint]:
        """Return a constraint on either robot; every solution satisfies at least one of the two.

        Each action that violates the first constraint collides with all actions that violate the
        second.
        """
        i, j, t = conflict.i, conflict.j, conflict.step
        a, b = _action_at(paths[i], t), _action_at(paths[j], t)
        if a.edge != WAIT and b.edge != WAIT:
            return self._two_edges(i, a, j, b)
        if a.edge == b.edge == WAIT:
            return _wait_constraint(i, a, b, t), _wait_constraint(j, b, a, t)
        if a.edge == WAIT:
            return self._wait_and_edge(i, a, j, b, t)
        wait, edge = self._wait_and_edge(j, b, i, a, t)
        return edge, wait

    def _two_edges(self, i: int, a: Action, j: int, b: Action) -> tuple[Constraint, Constraint]:
        offsets, now = self.offsets(i, a, j, b), b.start - a.start
        low = next(d for d in range(now, now - INF, -1) if d - 1 not in offsets)
        high = next(d for d in range(now, INF) if d + 1 not in offsets)
        return (
            Constraint(i, "edge", a.edge, (a.start, b.start - low)),
            Constraint(j, "edge", b.edge, (b.start, a.start + high)),
        )

    def _wait_and_edge(
        self, i: int, wait: Action, j: int, edge: Action, t: int
    ) -> tuple[Constraint, Constraint]:
        """Constraints for a run of the edge's motions that collide with the waiting robot."""
        hits = {-d for d in self.offsets(i, wait, j, edge)}  # places in the edge
        at = t - edge.start
        low = next(k for k in range(at, -1, -1) if k - 1 not in hits)
        high = next(k for k in range(at, INF) if k + 1 not in hits)
        last = min(edge.start + high, wait.start + wait.duration - 1)
        parked = wait.duration == INF
        return (
            Constraint(i, "goal" if parked else "vertex", wait.tail, (last, last)),
            Constraint(j, "edge", edge.edge, (max(0, last - high), INF if parked else last - low)),
        )

    def offsets(self, i: int, a: Action, j: int, b: Action) -> frozenset[int]:
        """Delays of the start of robot j's action, after that of robot i's, at which they collide.

        Of a wait only the first step counts.
        """
        kinds = self.roadmaps.kinds
        key = kinds[i], a.motion, kinds[j], b.motion
        if key not in self._offsets:
            one, two = (
                x.motion + np.arange(1 if x.edge == WAIT else x.duration, dtype=np.int64)
                for x in (a, b)
            )
            k, m = (grid.ravel() for grid in np.indices((len(one), len(two))))
            hit = self.roadmaps.pairs.collide(kinds[i], one[k], kinds[j], two[m])
            self._offsets[key] = frozenset((k - m)[hit].tolist())
        return self._offsets[key]


def _wait_constraint(robot: int, wait: Action, other: Action, t: int) -> Constraint:
    """Constraint on a robot that waits at step t while another robot waits."""
    if wait.duration == INF:
        return Constraint(robot, "goal", wait.tail, (t, t))
    return Constraint(robot, "vertex", wait.tail, (t, INF if other.duration == INF else t))


def _action_at(path: RoadmapPath, t: int) -> Action:
    """Action of a robot in step t; after its arrival a wait without end."""
    for action in path.actions:
        if action.start <= t < action.start + action.duration:
            return action
    return Action(WAIT, path.goal, path.goal, path.goal, path.arrival, INF)

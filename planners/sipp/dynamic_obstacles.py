"""Dynamic obstacles: timed paths of other robots, as obstacles on a robot's roadmap."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fgenv.arrays import Flags, Floats, Ints
from fgenv.planners.roadmap.motion_table import ABSENT
from fgenv.planners.roadmap.pair_cache import PairCache
from fgenv.planners.roadmap.roadmap import INF, Roadmap
from fgenv.planners.roadmap.spatial_hash import cells_near

from .intervals import Interval
from .unsafe_intervals import UnsafeStarts


@dataclass(frozen=True, eq=False)
class TimedPath:
    """Motions of a robot in each step, (k,), and its motion in all later steps (or ABSENT)."""

    kind: int
    motions: Ints
    rest: int
    obstacles: dict[int, DynamicObstacle] = field(default_factory=dict)  # by kind of the robot


class DynamicObstacle:
    """A timed path as an obstacle for one kind of robot; unsafe intervals are computed on demand.

    Entry n of the path: the obstacle makes motion `motions[n]` in the steps `first[n]` to
    `last[n]`.
    """

    def __init__(self, pairs: PairCache, kind: int, roadmap: Roadmap, path: TimedPath) -> None:
        self.pairs, self.kind, self.roadmap, self.path = pairs, kind, roadmap, path
        self.motions, self.first, self.last = _entries(path)
        table = pairs.tables[path.kind]
        self.still: Flags = (table.q0[self.motions] == table.q1[self.motions]).all(1)
        self.center, self.radius = table.center[self.motions], table.radius[self.motions]
        self._middle = self.center.mean(0)
        self._offset = self.center - self._middle
        self._squares = (self._offset**2).sum(1)
        rounding = 1e-6 * (1.0 + float(self.radius.max()))  # meters, of the squared distances
        self._reach = self.radius + pairs.margin + rounding
        self._cells: dict[tuple[float, float], frozenset[int]] = {}
        self._at_vertex: dict[int, list[Interval]] = {}
        self._on_edge: dict[int, UnsafeStarts | None] = {}

    def cells(self, side: float, reach: float) -> frozenset[int]:
        """Cells where a sphere of radius `reach` (m) can come near the obstacle at some time."""
        key = side, reach
        if key not in self._cells:
            wide = reach + self.pairs.margin
            self._cells[key] = cells_near(self.center, self.radius, side, wide)
        return self._cells[key]

    def unsafe_at_vertex(self, v: int) -> list[Interval]:
        """Intervals of steps in which waiting at vertex v is unsafe."""
        if v not in self._at_vertex:
            entries = self._near(np.array([v]))[1]
            waits = np.full(len(entries), v)
            hit = entries[self._collide(waits, entries)]
            intervals = zip(self.first[hit].tolist(), self.last[hit].tolist(), strict=True)
            self._at_vertex[v] = list(intervals)
        return self._at_vertex[v]

    def unsafe_starts(self, e: int) -> UnsafeStarts | None:
        """Instants at which starting edge e is unsafe; None if it is always safe."""
        if e not in self._on_edge:
            self._on_edge[e] = self._unsafe_starts(self.roadmap.edge_motions(e))
        return self._on_edge[e]

    def _unsafe_starts(self, edge: Ints) -> UnsafeStarts | None:
        places, entries, squares = self._near(edge)
        if not len(places):
            return None
        start, still = self.first[entries] - places, self.still[entries]
        blocked = self._blocked(edge, places[still], entries[still])
        moving = np.flatnonzero(~still)
        moving = moving[np.lexsort((squares[moving], start[moving]))]
        if not blocked and not len(moving):
            return None
        rows = start[moving], edge[places[moving]], self.motions[entries[moving]]
        return UnsafeStarts(self.pairs, (self.kind, self.path.kind), blocked, *rows)

    def _blocked(self, edge: Ints, places: Ints, entries: Ints) -> list[Interval]:
        """Start instants at which the edge collides with entries in which the obstacle rests."""
        if not len(entries):
            return []
        hit = self._collide(edge[places], entries)
        places, entries = places[hit], entries[hit]
        first = self.first[entries] - places
        last = np.where(self.last[entries] == INF, INF, self.last[entries] - places)
        intervals = zip(first.tolist(), last.tolist(), strict=True)
        return [interval for interval in intervals if interval[1] >= 0]

    def _collide(self, own: Ints, entries: Ints) -> Flags:
        return self.pairs.collide_near(self.kind, own, self.path.kind, self.motions[entries])

    def _near(self, own: Ints) -> tuple[Ints, Ints, Floats]:
        """Pairs of a robot's motion and an entry with overlapping bounding spheres.

        Returns:
            Places in `own`, entries, and squared distances of the centers (m^2); (n,) each.
        """
        table = self.roadmap.motions
        a, b = table.center[own] - self._middle, self._offset
        squares = (a * a).sum(1)[:, None] + self._squares
        squares -= 2.0 * (a @ b.T)
        reach = table.radius[own][:, None] + self._reach
        places, entries = np.nonzero(squares <= reach * reach)
        return places, entries, squares[places, entries]


def _entries(path: TimedPath) -> tuple[Ints, Ints, Ints]:
    """Runs of equal motions: the motion, its first step and its last step, (n,) each."""
    motions = path.motions if path.rest == ABSENT else np.append(path.motions, path.rest)
    first = np.flatnonzero(np.diff(motions, prepend=-1))
    last = np.append(first, len(motions))[1:] - 1
    if path.rest != ABSENT:
        last[-1] = INF
    return motions[first], first, last

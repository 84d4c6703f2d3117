"""Safe intervals of a robot on its roadmap among dynamic obstacles."""

from __future__ import annotations

from collections.abc import Sequence

from fgenv.planners.roadmap.roadmap import Roadmap
from fgenv.planners.roadmap.spatial_hash import Neighborhood

from .dynamic_obstacles import DynamicObstacle
from .intervals import ALWAYS, Interval, safe_intervals
from .unsafe_intervals import UnsafeStarts


class ObstacleIntervals:
    """Safe intervals among dynamic obstacles, computed on demand."""

    def __init__(self, roadmap: Roadmap, obstacles: Sequence[DynamicObstacle]) -> None:
        self.roadmap, self.obstacles = roadmap, obstacles
        self._near: dict[Neighborhood, list[DynamicObstacle]] = {}
        self._at_vertex: dict[int, list[Interval]] = {}
        self._on_edge: dict[int, list[UnsafeStarts]] = {}

    def at_vertex(self, v: int) -> list[Interval]:
        """See `SafeIntervals.at_vertex`.

        An instant between two unsafe steps is left out, although the robot could pass then.
        """
        if v not in self._at_vertex:
            near = self._obstacles_near(self.roadmap.cells.vertices[v])
            unsafe = [steps for obstacle in near for steps in obstacle.unsafe_at_vertex(v)]
            self._at_vertex[v] = safe_intervals(unsafe) if unsafe else ALWAYS
        return self._at_vertex[v]

    def first_start(self, e: int, low: int, high: int) -> int:
        """See `SafeIntervals.first_start`."""
        if e not in self._on_edge:
            near = self._obstacles_near(self.roadmap.cells.edges[e])
            found = (obstacle.unsafe_starts(e) for obstacle in near)
            self._on_edge[e] = [unsafe for unsafe in found if unsafe is not None]
        unsafe = self._on_edge[e]
        agreed = k = 0  # `agreed` of the obstacles in a row allow `low`
        while agreed < len(unsafe):
            start = unsafe[k].first_safe(low, high)
            if start < 0:
                return -1
            agreed = agreed + 1 if start == low else 1
            low, k = start, (k + 1) % len(unsafe)
        return low

    def _obstacles_near(self, neighborhood: Neighborhood) -> list[DynamicObstacle]:
        if neighborhood not in self._near:
            cell, reach = neighborhood
            side = self.roadmap.cells.side
            self._near[neighborhood] = [
                o for o in self.obstacles if cell in o.cells(side, side * reach)
            ]
        return self._near[neighborhood]

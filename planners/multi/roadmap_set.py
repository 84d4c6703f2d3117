"""Roadmaps of a problem with their collision cache, shared by the multi-robot methods."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from fgenv.arrays import Floats
from fgenv.planners.deadline import NEVER, Deadline
from fgenv.planners.errors import PlanningError
from fgenv.planners.problem import Problem
from fgenv.planners.roadmap.construction import build_roadmap
from fgenv.planners.roadmap.motion_table import ABSENT
from fgenv.planners.roadmap.pair_cache import PairCache
from fgenv.planners.roadmap.roadmap import UNREACHABLE, Roadmap
from fgenv.planners.sipp.dynamic_obstacles import DynamicObstacle, TimedPath
from fgenv.planners.sipp.safe_intervals import ObstacleIntervals
from fgenv.planners.sipp.sipp import RoadmapPath, SearchBudget, sipp

from .constraints import ConstrainedIntervals, Constraint
from .solution import SearchStats


class RoadmapSet:
    """A problem's roadmaps, one per kind of robot, built on demand and shared by searches.

    PlanningError is raised if the deadline passes before they are built.
    """

    def __init__(self, problem: Problem, deadline: Deadline = NEVER) -> None:
        self.problem, self.deadline = problem, deadline
        self._waiting: dict[tuple[int, int], TimedPath] = {}
        self._timed: WeakKeyDictionary[RoadmapPath, TimedPath] = WeakKeyDictionary()

    @cached_property
    def kinds(self) -> tuple[int, ...]:
        """Place of each robot's roadmap in `roadmaps`."""
        known = sorted(set(self.problem.kinds))
        return tuple(known.index(kind) for kind in self.problem.kinds)

    @cached_property
    def roadmaps(self) -> tuple[Roadmap, ...]:
        """Roadmap of each kind."""
        return tuple(
            build_roadmap(self.problem, k, self.deadline) for k in sorted(set(self.problem.kinds))
        )

    @cached_property
    def pairs(self) -> PairCache:
        """Collision results for pairs of motions."""
        ids = self.problem.robot_ids
        members = [
            [ids[i] for i, k in enumerate(self.kinds) if k == kind]
            for kind in range(len(self.roadmaps))
        ]
        tables = [roadmap.motions for roadmap in self.roadmaps]
        return PairCache(self.problem.world, tables, members, self.problem.margin)

    @cached_property
    def starts(self) -> tuple[int, ...]:
        """Start vertex of each robot."""
        return self._vertices(self.problem.starts)

    @cached_property
    def goals(self) -> tuple[int, ...]:
        """Goal vertex of each robot."""
        return self._vertices(self.problem.goals)

    def _vertices(self, ends: Iterable[Floats]) -> tuple[int, ...]:
        return tuple(self.roadmaps[k].vertex(q) for k, q in zip(self.kinds, ends, strict=True))

    @property
    def stay(self) -> bool:
        """Whether robots stay at their goals."""
        return not self.problem.vanish

    def roadmap(self, i: int) -> Roadmap:
        """Roadmap of robot i."""
        return self.roadmaps[self.kinds[i]]

    def shortest(self, i: int) -> int:
        """Least number of steps of robot i without other robots."""
        return self.roadmap(i).cost_to_go(self.goals[i])[self.starts[i]]

    def timed(self, i: int, path: RoadmapPath) -> TimedPath:
        """Path of robot i as a timed path, for the other robots."""
        if not self.stay and not len(path.motions):  # the robot vanishes after one step
            return self.add_path(i, np.repeat(self.problem.starts[i][None], 2, axis=0))
        if path not in self._timed:
            rest = self.goals[i] if self.stay else ABSENT
            self._timed[path] = TimedPath(self.kinds[i], path.motions, rest)
        return self._timed[path]

    def add_path(self, i: int, path: Floats) -> TimedPath:
        """Timed path (k + 1, nq) of robot i that is not on its roadmap."""
        first = self.roadmap(i).motions.add(path[:-1], path[1:])
        motions = first + np.arange(len(path) - 1, dtype=np.int64)
        return TimedPath(self.kinds[i], motions, self.goals[i] if self.stay else ABSENT)

    def waiting(self, i: int, steps: int) -> TimedPath:
        """Robot i at its start for some steps, and then absent."""
        key = i, steps
        if key not in self._waiting:
            motions = np.full(steps, self.starts[i], dtype=np.int64)
            self._waiting[key] = TimedPath(self.kinds[i], motions, ABSENT)
        return self._waiting[key]

    def intervals(self, i: int, paths: Iterable[TimedPath]) -> ObstacleIntervals:
        """Safe intervals of robot i among timed paths, which cache the results."""
        return ObstacleIntervals(self.roadmap(i), [self._obstacle(i, path) for path in paths])

    def plan(
        self,
        i: int,
        obstacles: ObstacleIntervals,
        constraints: Iterable[Constraint],
        budget: SearchBudget,
        **options: Any,
    ) -> RoadmapPath | None:
        """Earliest path of robot i under constraints; see `sipp` for the options."""
        intervals = ConstrainedIntervals(obstacles, constraints)
        ends = self.starts[i], self.goals[i]
        options |= {"stay": self.stay, "earliest": intervals.earliest}
        return sipp(self.roadmap(i), *ends, intervals, budget, **options)

    def _obstacle(self, i: int, path: TimedPath) -> DynamicObstacle:
        kind = self.kinds[i]
        if kind not in path.obstacles:
            path.obstacles[kind] = DynamicObstacle(self.pairs, kind, self.roadmaps[kind], path)
        return path.obstacles[kind]

    def configurations(self, i: int, path: TimedPath) -> Floats:
        """Configurations (k + 1, nq) of robot i at each step."""
        if not len(path.motions):
            return self.problem.starts[i][None].copy()
        return self.roadmap(i).motions.path(path.motions)

    def stats(self, budget: SearchBudget, **more: Any) -> SearchStats:
        """Statistics of the searches so far."""
        sizes = tuple((len(r.q), len(r.heads)) for r in self.roadmaps)
        return SearchStats(budget.expanded, budget.searches, self.pairs.checks, sizes, **more)

    def check(self) -> None:
        """Check starts, goals and connectivity.

        Raises:
            PlanningError: starts or goals collide, or a robot has no path even without others.
        """
        self.problem.check()
        for i, name in enumerate(self.problem.names):
            if self.shortest(i) >= UNREACHABLE:
                raise PlanningError(
                    f"{name}: no path from start to goal on a roadmap of {len(self.roadmap(i).q)}"
                    " vertices, even without other robots"
                )

"""What the many-robot methods share: a problem's roadmaps, and which of their steps meet."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from fgenv.arrays import Floats
from fgenv.planners.errors import PlanningError
from fgenv.planners.roadmap.construction import grow
from fgenv.planners.roadmap.motion_table import GONE
from fgenv.planners.roadmap.roadmap import FAR, Roadmap
from fgenv.planners.sipp.dynamic_obstacles import Other, Timed
from fgenv.planners.sipp.safe_intervals import Traffic
from fgenv.planners.sipp.sipp import Effort, Track

from .pair_cache import Meetings
from .timetable import Stats

if TYPE_CHECKING:
    from fgenv.planners.problem import Problem


class Tables:
    """A problem's roadmaps, and which of their steps meet; made on demand, shared by searches."""

    def __init__(self, problem: Problem, finer: int = 0) -> None:
        self.problem, self.finer = problem, finer
        self.waiting: dict[
            tuple[int, int], Timed
        ] = {}  # robots left at their starts, so many steps
        self._timed: WeakKeyDictionary[Track, Timed] = WeakKeyDictionary()

    @cached_property
    def kinds(self) -> tuple[int, ...]:
        """For each robot, the place of its kind's roadmap."""
        known = sorted(set(self.problem.kinds))
        return tuple(known.index(kind) for kind in self.problem.kinds)

    @cached_property
    def roadmaps(self) -> tuple[Roadmap, ...]:
        """One of each kind."""
        known = sorted(set(self.problem.kinds))
        return tuple(grow(self.problem, kind, first=self.finer) for kind in known)

    @cached_property
    def meetings(self) -> Meetings:
        """Which steps of them meet."""
        ids = self.problem.robots
        members = [
            [ids[i] for i, k in enumerate(self.kinds) if k == kind]
            for kind in range(len(self.roadmaps))
        ]
        steps = [roadmap.steps for roadmap in self.roadmaps]
        return Meetings(self.problem.world, steps, members, self.problem.margin)

    @cached_property
    def starts(self) -> tuple[int, ...]:
        """The vertex of each robot's start."""
        return tuple(
            self.roadmaps[k].vertex(q) for k, q in zip(self.kinds, self.problem.starts, strict=True)
        )

    @cached_property
    def goals(self) -> tuple[int, ...]:
        """The vertex of each robot's goal."""
        return tuple(
            self.roadmaps[k].vertex(q) for k, q in zip(self.kinds, self.problem.goals, strict=True)
        )

    @cached_property
    def park(self) -> bool:
        """Whether robots stay at their goals."""
        return not self.problem.vanish

    def roadmap(self, i: int) -> Roadmap:
        """Of robot i."""
        return self.roadmaps[self.kinds[i]]

    def least(self, i: int) -> int:
        """Steps that robot i needs at least, alone."""
        return self.roadmap(i).to(self.goals[i])[self.starts[i]]

    def timed(self, i: int, track: Track) -> Timed:
        """Robot i's track as others see it."""
        if not self.park and not len(track.steps):  # it is gone after one step at the earliest
            return self.given(i, np.repeat(self.problem.starts[i][None], 2, axis=0))
        if track not in self._timed:
            rest = self.goals[i] if self.park else GONE
            self._timed[track] = Timed(self.kinds[i], track.steps, rest)
        return self._timed[track]

    def given(self, i: int, path: Floats) -> Timed:
        """A timed path (k + 1, nq) of robot i that is not on its roadmap, as others see it."""
        table = self.roadmap(i).steps
        first = table.add(path[:-1], path[1:])
        steps = first + np.arange(len(path) - 1, dtype=np.int64)
        return Timed(self.kinds[i], steps, self.goals[i] if self.park else GONE)

    def traffic(self, i: int, others: Iterable[Timed]) -> Traffic:
        """Others' timed paths as robot i meets them; what is found out is kept with them."""
        return Traffic(self.roadmap(i), [self._seen(i, timed) for timed in others])

    def _seen(self, i: int, timed: Timed) -> Other:
        kind = self.kinds[i]
        if kind not in timed.seen:
            timed.seen[kind] = Other(self.meetings, kind, self.roadmaps[kind], timed)
        return timed.seen[kind]

    def path(self, i: int, timed: Timed) -> Floats:
        """Configurations (k + 1, nq) of robot i at each step."""
        if not len(timed.steps):
            return self.problem.starts[i][None].copy()
        return self.roadmap(i).steps.path(timed.steps)

    def stats(self, effort: Effort, **more: object) -> Stats:
        """Of what was done so far."""
        sizes = tuple((len(r.q), len(r.heads)) for r in self.roadmaps)
        done = {"expanded": effort.expanded, "searches": effort.searches}
        return Stats(**done, checks=self.meetings.checks, roadmaps=sizes, **more)  # type: ignore[arg-type]

    def check(self) -> None:
        """PlanningError where ends collide, or a robot has no way even alone."""
        self.problem.check()
        for i in range(len(self.kinds)):
            if self.least(i) >= FAR:
                size = len(self.roadmap(i).q)
                raise PlanningError(
                    f"{self.problem.names[i]}: no way from start to goal on a roadmap of {size}"
                    " vertices, even with no other robot there"
                )

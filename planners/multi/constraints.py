"""Constraints of conflict-based search, applied to safe intervals.

As in A. Andreychuk et al., "Multi-agent pathfinding with continuous time", IJCAI 2019: a robot must
not start an edge in an interval of instants, or must not wait at a vertex in an interval of steps.
A goal constraint bounds the arrival at the goal (J. Li et al., "Pairwise symmetry reasoning for
multi-agent path finding search", 2021).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from fgenv.planners.sipp.intervals import Interval, SafeIntervals, without_steps


@dataclass(frozen=True)
class Constraint:
    """Constraint on one robot.

    Attributes:
        kind: `edge`: the robot must not start edge `target` in the interval of instants;
            `vertex`: it must not wait at vertex `target` in the interval of steps;
            `goal`: it must arrive at its goal, to stay, after the interval's first step.
    """

    robot: int
    kind: str
    target: int
    interval: Interval


class ConstrainedIntervals:
    """Safe intervals of one robot, reduced by its constraints.

    Attributes:
        earliest: instant from which the robot may arrive at its goal for good.
    """

    def __init__(self, intervals: SafeIntervals, constraints: Iterable[Constraint]) -> None:
        self._intervals = intervals
        self._on_edge: dict[int, list[Interval]] = {}
        self._on_vertex: dict[int, list[Interval]] = {}
        self._at_vertex: dict[int, list[Interval]] = {}
        self.earliest = 0
        for constraint in constraints:
            if constraint.kind == "goal":
                self.earliest = max(self.earliest, constraint.interval[0] + 1)
            else:
                kept = self._on_edge if constraint.kind == "edge" else self._on_vertex
                kept.setdefault(constraint.target, []).append(constraint.interval)

    def at_vertex(self, v: int) -> list[Interval]:
        """See `SafeIntervals.at_vertex`."""
        if v not in self._on_vertex:
            return self._intervals.at_vertex(v)
        if v not in self._at_vertex:
            left = self._intervals.at_vertex(v)
            for steps in self._on_vertex[v]:
                left = [part for interval in left for part in without_steps(interval, steps)]
            self._at_vertex[v] = left
        return self._at_vertex[v]

    def first_start(self, e: int, low: int, high: int) -> int:
        """See `SafeIntervals.first_start`."""
        forbidden = self._on_edge.get(e, ())
        while low <= high:
            low = self._intervals.first_start(e, low, high)
            if low < 0:
                return -1
            after = max(
                (last + 1 for first, last in forbidden if first <= low <= last), default=low
            )
            if after == low:
                return low
            low = after
        return -1

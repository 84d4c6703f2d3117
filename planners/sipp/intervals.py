"""Intervals of time, in steps, as SIPP uses them.

Step t lasts from instant t to instant t + 1. A robot is at a vertex at instants, and it collides
in steps.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from fgenv.planners.roadmap.roadmap import INF

Interval = tuple[int, int]  # first and last, both included
ALWAYS: list[Interval] = [(0, INF)]


class SafeIntervals(Protocol):
    """When a robot can wait at a vertex, and when it can start an edge."""

    def at_vertex(self, v: int) -> list[Interval]:
        """Intervals of instants in which the robot can wait at vertex v, in ascending order."""
        ...

    def first_start(self, e: int, low: int, high: int) -> int:
        """First instant in [low, high] at which edge e can start; -1 if there is none."""
        ...


def safe_intervals(unsafe: Iterable[Interval], instants: Iterable[int] = ()) -> list[Interval]:
    """Intervals of instants in which a robot can wait at a vertex, in ascending order.

    Args:
        unsafe: intervals of steps in which waiting at the vertex is unsafe.
        instants: instants between two unsafe steps that are intervals of their own.
    """
    intervals, low = [(t, t) for t in instants], 0
    for first, last in sorted(unsafe):
        if first > low or first == low == 0:
            intervals.append((low, first))
        low = max(low, last + 1)
    if low < INF:
        intervals.append((low, INF))
    return sorted(intervals)


def without_steps(interval: Interval, steps: Interval) -> list[Interval]:
    """Parts of an interval of instants that remain if the robot must not wait in some steps.

    Each instant between two such steps remains as an interval of its own, unless the steps have no
    end.
    """
    (low, high), (first, last) = interval, steps
    if first >= high or last < low:
        return [interval]
    parts = [(low, first)] if first >= low else []
    if last < high:
        parts += [(t, t) for t in range(max(first + 1, low), last + 1)]
        parts.append((max(last + 1, low), high))
    return parts


def merged(intervals: Iterable[Interval]) -> list[Interval]:
    """Sorted intervals, with overlapping and adjacent ones joined."""
    out: list[Interval] = []
    for first, last in sorted(intervals):
        if out and first <= out[-1][1] + 1:
            out[-1] = out[-1][0], max(last, out[-1][1])
        else:
            out.append((first, last))
    return out

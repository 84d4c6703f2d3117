"""Safe interval path planning: the earliest timed path of one robot among dynamic obstacles.

M. Phillips and M. Likhachev, "SIPP: Safe interval path planning for dynamic environments", ICRA
2011. A search state is a vertex and one of its safe intervals. The earliest arrival dominates all
others, since the robot can wait within the interval.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass, field
from heapq import heappop, heappush
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from fgenv.arrays import Ints
from fgenv.planners.deadline import NEVER, Deadline
from fgenv.planners.roadmap.roadmap import INF, UNREACHABLE, Roadmap

from .intervals import Interval, SafeIntervals

CLOCK_PERIOD = 64  # states between two reads of the clock
WAIT = -1  # edge of an action that waits
ANY = -1  # interval of a queue entry that is not yet divided by the safe intervals of its vertex

# f, cost to go, parent node, edge, vertex, its interval, earliest and latest start of the edge
Entry = tuple[float, int, int, int, int, int, int, int]


@dataclass(frozen=True)
class Action:
    """An edge from vertex `tail` to `head`, or a wait.

    Attributes:
        edge: number of the edge, or WAIT.
        motion: number of its first motion.
        start: instant.
        duration: steps.
    """

    edge: int
    tail: int
    head: int
    motion: int
    start: int
    duration: int


@dataclass(frozen=True, eq=False)
class RoadmapPath:
    """Timed path of one robot: consecutive actions, and the numbers of their motions, (k,)."""

    actions: tuple[Action, ...]
    motions: Ints
    goal: int

    @property
    def arrival(self) -> int:
        """Instant at which the robot arrives at its goal for good."""
        return len(self.motions)


@dataclass
class SearchBudget:
    """Deadline of the searches, and counts of their work."""

    deadline: Deadline = NEVER
    expanded: int = 0
    searches: int = 0

    def expired(self) -> bool:
        """Whether the deadline has passed."""
        return self.deadline.left < 0


class SearchNode(NamedTuple):
    """A state that was reached at instant t by an edge that started at instant `start`."""

    parent: int
    vertex: int
    edge: int
    start: int
    t: int


def sipp(
    roadmap: Roadmap,
    start: int,
    goal: int,
    intervals: SafeIntervals,
    budget: SearchBudget,
    *,
    stay: bool = True,
    earliest: int = 0,
    latest: int = INF,
    max_states: int = INF,
    weight: float = 1.0,
) -> RoadmapPath | None:
    """Return the earliest path from start, at instant 0, to goal; None if the search finds none.

    Args:
        start, goal: vertices.
        stay: the robot stays at the goal for ever; else it vanishes there.
        earliest, latest: instants between which the robot may arrive for good.
        max_states: number of states after which the search gives up.
        weight: factor of the heuristic (weighted A*); over 1, the path may take that many times
            as long as the earliest.
    """
    budget.searches += 1
    cost_to_go, at_goal = roadmap.cost_to_go(goal)[start], intervals.at_vertex(goal)
    first = _interval_at(intervals.at_vertex(start), 0)
    if cost_to_go >= UNREACHABLE or first is None or not at_goal:
        return None
    if stay and at_goal[-1][1] != INF:
        return None
    earliest_end = max(earliest, at_goal[-1][0] if stay else 0)
    search = _Search(roadmap, goal, intervals, weight, earliest, latest, earliest_end)
    search.push(-1, WAIT, start, first, 0, 0)
    while search.queue:
        entry = heappop(search.queue)
        if entry[5] == ANY:
            search.divide(entry)
            continue
        node = search.reach(entry)
        if node is None:
            continue
        high = intervals.at_vertex(node.vertex)[entry[5]][1]
        if node.vertex == goal and node.t >= earliest and (not stay or high == INF):
            return _path(roadmap, search.nodes, goal)
        budget.expanded += 1
        number = len(search.nodes) - 1
        if number >= max_states or (number % CLOCK_PERIOD == 0 and budget.expired()):
            return None
        search.expand(number, high)
    return None


@dataclass(eq=False)
class _Search:
    """Open queue and closed states of one search.

    Attributes:
        earliest_end: lower bound on the instant of arrival.
        reached: earliest instant of each state.
    """

    roadmap: Roadmap
    goal: int
    intervals: SafeIntervals
    weight: float
    earliest: int
    latest: int
    earliest_end: int
    queue: list[Entry] = field(default_factory=list)
    nodes: list[SearchNode] = field(default_factory=list)
    reached: dict[tuple[int, int], int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.cost_to_go = self.roadmap.cost_to_go(self.goal)

    def push(
        self, parent: int, edge: int, vertex: int, interval: int, start: int, end: int
    ) -> None:
        """Add an entry with an edge that starts at instant `start` or later."""
        cost_to_go = self.cost_to_go[vertex]
        f = max(start + self.duration(edge) + self.weight * cost_to_go, self.earliest_end)
        heappush(self.queue, (f, cost_to_go, parent, edge, vertex, interval, start, end))

    def duration(self, edge: int) -> int:
        """Steps of an edge; 0 for WAIT."""
        return self.roadmap.durations[edge] if edge >= 0 else 0

    def divide(self, entry: Entry) -> None:
        """Push an entry for each safe interval of the vertex that the edge can reach."""
        _, _, parent, edge, vertex, _, start, end = entry
        duration, there = self.duration(edge), self.intervals.at_vertex(vertex)
        for i in range(bisect_left(there, start + duration, key=itemgetter(1)), len(there)):
            low, high = max(start, there[i][0] - duration), min(end, there[i][1] - duration)
            if low > end:
                break
            self.push(parent, edge, vertex, i, low, high)

    def reach(self, entry: Entry) -> SearchNode | None:
        """Close the state of an entry, if the edge can start at once; else push it again."""
        _, cost_to_go, parent, edge, vertex, interval, start, end = entry
        t = start + self.duration(edge)
        # At the goal, states before and after the earliest arrival are different.
        state = vertex, (interval if vertex != self.goal or t < self.earliest else -1 - interval)
        if self.reached.get(state, INF) <= t:
            return None
        safe = self.intervals.first_start(edge, start, end) if edge >= 0 else 0
        if safe != start:
            if safe > start and safe + self.duration(edge) + cost_to_go <= self.latest:
                self.push(parent, edge, vertex, interval, safe, end)
            return None
        self.reached[state] = t
        self.nodes.append(SearchNode(parent, vertex, edge, start, t))
        return self.nodes[-1]

    def expand(self, number: int, high: int) -> None:
        """Push the edges that leave a node, which can start until instant `high`."""
        node = self.nodes[number]
        for edge, head, duration in self.roadmap.successors[node.vertex]:
            if node.t + duration + self.cost_to_go[head] <= self.latest:
                self.push(number, edge, head, ANY, node.t, high)


def _interval_at(intervals: list[Interval], t: int) -> int | None:
    """Place of the interval that contains instant t."""
    return next((i for i, (low, high) in enumerate(intervals) if low <= t <= high), None)


def _path(roadmap: Roadmap, nodes: list[SearchNode], goal: int) -> RoadmapPath:
    """Path to the last node."""
    actions: list[Action] = []
    node = nodes[-1]
    while node.parent >= 0:
        before, duration = nodes[node.parent], node.t - node.start
        tail, motion = before.vertex, roadmap.first_motion(node.edge)
        actions.append(Action(node.edge, tail, node.vertex, motion, node.start, duration))
        if node.start > before.t:
            actions.append(Action(WAIT, tail, tail, tail, before.t, node.start - before.t))
        node = before
    actions.reverse()
    motions = [np.zeros(0, dtype=np.int64)]
    motions += [
        np.full(a.duration, a.motion)
        if a.edge == WAIT
        else np.arange(a.motion, a.motion + a.duration)
        for a in actions
    ]
    return RoadmapPath(tuple(actions), np.concatenate(motions), goal)

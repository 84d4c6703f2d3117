"""Conflict-based search on roadmaps: paths for each alone, and bans where two of them meet.

G. Sharon et al., "Conflict-based search for optimal multi-agent pathfinding", 2015, with the
constraints of A. Andreychuk et al., 2019, in whole steps; bounded suboptimality as in J. Li et al.,
"EECBS", 2021; bypasses as in E. Boyarski et al., "Don't split, try to work it out", 2015. No
maintained library of multi-agent path finding takes roadmaps with moving geometry: they want grids.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .bans import Ban, Banned
from .clashes import Clash, Clashes
from .errors import PlanningError
from .many import Tables, Timetable
from .moves import Floats
from .others import Timed
from .priorities import HOLDS, Priorities
from .sipp import Effort, Track, sipp

if TYPE_CHECKING:
    from .problem import Problem

Knot = Callable[[tuple[int, ...], float], Sequence[Floats]]
KNOT = 20  # so often do two robots meet in the search before they are solved jointly
EVERY = 8  # nodes: so often robots are also tried one after another
STATES = 500  # of a search for a track that meets nobody
SHARE = 0.3  # of the time that is left, for a knot


@dataclass(frozen=True)
class Node:
    """A node of the high level: bans, a track of each robot that keeps them, and their clashes.

    Attributes:
        least: steps that each robot needs at least, its bans kept.
    """

    bans: dict[int, tuple[Ban, ...]]
    tracks: dict[int, Track]
    least: dict[int, int]
    clashes: dict[tuple[int, int], Clash]

    @property
    def cost(self) -> int:
        """Sum of arrivals, steps."""
        return sum(track.arrival for track in self.tracks.values())

    @property
    def bound(self) -> int:
        """No solution under these bans costs less."""
        return sum(self.least.values())


def conflict_based(
    problem: Problem,
    time_limit: float = 10.0,
    *,
    suboptimality: float = 2.0,
    knot: Knot | None = None,
    tables: Tables | None = None,
) -> Timetable:
    """Timed paths for all robots; the sum of their arrival times is bounded.

    Same problem, same result, unless the time limit cuts the search short.

    Args:
        time_limit: seconds.
        suboptimality: how many times the best cost on the roadmaps the sum of arrivals may be; 1:
            optimal. Where a knot was solved jointly, that holds for the others alone. If time runs
            out, the best that there is may cost more.
        knot: joint timed paths (k + 1, nq) of some robots, given a time limit, for those that meet
            again and again; the others then go around them. It may raise PlanningError.
        tables: of this problem, of an earlier search.

    Raises:
        PlanningError: no way found in time: `best` is a Timetable of those robots that do not meet
            in the best node, for others to go on from. Or starts or goals are in collision.
    """
    if not suboptimality >= 1.0:
        raise ValueError(f"suboptimality: {suboptimality}, wanted 1 or more")
    effort = Effort(time.monotonic() + time_limit)
    tables = tables or Tables(problem)
    tables.check()
    tied = _Tied(tables, effort, suboptimality, knot)
    node = tied.run()
    found = tied.timetable(node)
    if not found.complete:
        raise PlanningError(_reason(problem, found, time_limit, effort.late()), found)
    return found


class _Tied:
    """Searches, and knots in between, until there are no more."""

    def __init__(
        self, tables: Tables, effort: Effort, suboptimality: float, knot: Knot | None
    ) -> None:
        self.tables, self.effort, self.knot = tables, effort, knot
        self.suboptimality = suboptimality
        self.paths: dict[int, Floats] = {}  # of robots in knots
        self.groups: list[tuple[int, ...]] = []
        self.nodes = 0

    def run(self) -> Node | None:
        """The best node."""
        given: dict[int, Timed] = {}
        while True:
            limit = KNOT if self.knot is not None else 0
            search = Search(self.tables, self.effort, self.suboptimality, given, limit)
            node = search.run()
            self.nodes += search.nodes
            if search.knotted is None or not self._joined(search.knotted):
                return node
            given = {i: self.tables.given(i, path) for i, path in self.paths.items()}

    def _joined(self, robots: tuple[int, ...]) -> bool:
        """Whether these, with all of the knots that they are in, have joint paths now."""
        assert self.knot is not None
        touched = [g for g in self.groups if set(g) & set(robots)]
        group = tuple(sorted(set(robots).union(*touched)))
        left = self.effort.deadline - time.monotonic()
        if left <= 0:
            return False
        try:
            paths = self.knot(
                group, left * (1.0 if len(group) == len(self.tables.kinds) else SHARE)
            )
        except PlanningError:
            return False
        self.paths.update(zip(group, paths, strict=True))
        self.groups = [g for g in self.groups if g not in touched] + [group]
        return True

    def timetable(self, node: Node | None) -> Timetable:
        """Paths of a node; of robots that meet others as few as can be are left out."""
        out: set[int] = set()
        if node is not None:
            for pair in node.clashes:
                if not out & set(pair):
                    out.add(max(pair, key=lambda i: sum(i in p for p in node.clashes)))
        tracks = {} if node is None else node.tracks
        paths = tuple(
            self.paths[i]
            if i in self.paths
            else self.tables.path(i, self.tables.timed(i, tracks[i]))
            if i in tracks and i not in out
            else None
            for i in range(len(self.tables.kinds))
        )
        stats = self.tables.stats(self.effort, nodes=self.nodes, knots=tuple(self.groups))
        return Timetable(paths, stats)


class Search:
    """The high level, among robots whose timed paths are given."""

    def __init__(
        self,
        tables: Tables,
        effort: Effort,
        suboptimality: float = 1.0,
        given: dict[int, Timed] | None = None,
        limit: int = 0,
    ) -> None:
        self.tables, self.effort, self.weight = tables, effort, suboptimality
        self.given, self.limit = given or {}, limit
        self.clashes = Clashes(tables)
        self.robots = [i for i in range(len(tables.kinds)) if i not in self.given]
        self.knotted: tuple[int, ...] | None = None  # those that should be solved jointly
        self.nodes = 0
        self._times: dict[tuple[int, int], int] = {}
        self._safe = {i: tables.traffic(i, self.given.values()) for i in self.robots}

    def run(self) -> Node | None:
        """The solution; else, of the nodes looked at, that with the fewest clashes."""
        root = self.root()
        if root is None:
            return None
        open_nodes, best = [root], root
        while open_nodes and not self.effort.late():
            bound = self.weight * min(node.bound for node in open_nodes)
            best = min(best, self._tried(open_nodes[-1]), key=lambda n: (len(n.clashes), n.cost))
            if not best.clashes and best.cost <= bound + 1e-9:
                return best
            node = self._popped(open_nodes, bound)
            if len(node.clashes) < len(best.clashes):
                best = node
            if not node.clashes or self._is_knot(node):
                return node
            self.nodes += 1
            open_nodes += self._children(node)
        return best

    def _tried(self, node: Node) -> Node:
        """The node, or one with the same bans that robots one after another gave."""
        if not node.clashes or self.weight == 1.0 or self.nodes % EVERY:
            return node
        search = Priorities(self.tables, self.effort, self.given, node.bans)
        order = search.order()
        for hold in HOLDS if self.nodes == 0 else HOLDS[:1]:
            tracks, failed = search.attempt(order, round(hold / self.tables.problem.dt))
            if failed is None:
                return replace(node, tracks=tracks, clashes={})
            order = [failed, *(i for i in order if i != failed)]
        return node

    def root(self) -> Node | None:
        """Each robot's best track, or one near it that meets nobody before it."""
        node = Node({}, {}, {}, {})
        least = {}
        for i in self.robots:
            track = self._alone(i, (), [], math.inf)
            if track is None:
                if not self.effort.late():
                    self._tie(i)
                return None
            node.tracks[i], least[i] = track, track.arrival
        best = dict(node.tracks)
        node = Node({}, {}, {}, {})
        for i in sorted(self.robots, key=lambda i: -least[i]):
            node.least[i] = least[i]
            node = self._with(node, i, best[i])
        return node

    def _tie(self, i: int) -> None:
        """One that finds no way around a knot is tied into it."""
        if self.limit and self.given:
            self.knotted = (i, *self.given)

    def _popped(self, nodes: list[Node], most: float) -> Node:
        """The node with the fewest clashes of those that cost no more."""
        good = [k for k, node in enumerate(nodes) if node.cost <= most + 1e-9]
        return nodes.pop(min(good, key=lambda k: (len(nodes[k].clashes), nodes[k].cost, -k)))

    def _is_knot(self, node: Node) -> bool:
        """Whether two of its robots have met too often."""
        if not self.limit:
            return False
        pair = max(node.clashes, key=lambda p: self._times.get(p, 0))
        if self._times.get(pair, 0) >= self.limit:
            self.knotted = pair
        return self.knotted is not None

    def _children(self, node: Node) -> list[Node]:
        """Two nodes, one with either ban; or one, where a robot's other track is all it takes."""
        clash = min(node.clashes.values(), key=lambda c: (c.t, c.i, c.j))
        pair = clash.i, clash.j
        self._times[pair] = self._times.get(pair, 0) + 1
        children = []
        for ban in self.clashes.parted(clash, node.tracks):
            child = self._child(node, ban)
            if child is None:
                continue
            around = replace(node, tracks=child.tracks, clashes=child.clashes)
            if len(child.clashes) < len(node.clashes) and around.cost <= self.weight * node.bound:
                return [around]
            children.append(child)
        return children

    def _child(self, node: Node, ban: Ban) -> Node | None:
        """The node with one more ban."""
        i = ban.robot
        bans = {**node.bans, i: (*node.bans.get(i, ()), ban)}
        track = self._alone(i, bans[i], [], math.inf)
        if track is None:
            return None
        least = {**node.least, i: max(node.least[i], track.arrival)}
        return self._with(replace(node, bans=bans, least=least), i, track)

    def _with(self, node: Node, i: int, best: Track) -> Node:
        """The node with robot i's best track, or one that meets nobody, if the bound allows it."""
        tracks = {**node.tracks, i: best}
        clashes = self.clashes.among(i, tracks)
        if clashes and self.weight > 1.0:
            room = self.weight * node.bound - sum(t.arrival for j, t in tracks.items() if j != i)
            others = [self.tables.timed(j, t) for j, t in tracks.items() if j != i]
            track = self._alone(i, node.bans.get(i, ()), others, room + 1e-9)
            if track is not None:
                tracks, clashes = {**tracks, i: track}, {}
        kept = {pair: clash for pair, clash in node.clashes.items() if i not in pair}
        return replace(node, tracks=tracks, clashes=kept | clashes)

    def _alone(
        self, i: int, bans: Iterable[Ban], others: Sequence[Timed], most: float
    ) -> Track | None:
        """Robot i's soonest track that keeps its bans, among others, by `most` steps."""
        tables, roadmap = self.tables, self.tables.roadmap(i)
        safe = self._safe[i]
        if others:
            safe = tables.traffic(i, [*self.given.values(), *others])
        banned = Banned(safe, bans)
        bound = {} if math.isinf(most) else {"most": int(most), "states": STATES}
        return sipp(
            roadmap,
            tables.starts[i],
            tables.goals[i],
            banned,
            self.effort,
            park=tables.park,
            release=banned.release,
            **bound,
        )


def _reason(problem: Problem, found: Timetable, time_limit: float, late: bool) -> str:
    missing = ", ".join(problem.names[i] for i in found.missing)
    why = f"within {time_limit:g} s" if late else "on these roadmaps"
    done = len(found.paths) - len(found.missing)
    return (
        f"conflict_based: no way for all {len(found.paths)} robots {why}"
        f" ({found.stats.nodes} nodes); without {missing} the others, {done}, do not meet; give more"
        " time, a greater suboptimality, or take composite"
    )

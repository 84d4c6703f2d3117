"""The tree of conflict-based search: nodes with bans, and a track of each robot that keeps them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from fgenv.planners.sipp.dynamic_obstacles import Timed
from fgenv.planners.sipp.sipp import Effort, Track, sipp

from .conflicts import Clash, Clashes
from .constraints import Ban, Banned
from .priorities import HOLDS, Priorities
from .roadmap_set import Tables

EVERY = 8  # nodes: so often robots are also tried one after another
STATES = 500  # of a search for a track that meets nobody


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

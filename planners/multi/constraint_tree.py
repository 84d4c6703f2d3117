"""Constraint tree of conflict-based search: the high-level search.

G. Sharon et al., "Conflict-based search for optimal multi-agent pathfinding", Artificial
Intelligence 2015; bounded suboptimality as in J. Li et al., "EECBS", AAAI 2021; bypasses as in
E. Boyarski et al., "Don't split, try to work it out", ICAPS 2015.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from fgenv.planners.roadmap.roadmap import INF
from fgenv.planners.sipp.dynamic_obstacles import TimedPath
from fgenv.planners.sipp.sipp import RoadmapPath, SearchBudget

from .conflict_splitting import ConflictSplitter
from .conflicts import Conflicts, conflicts_of
from .constraints import Constraint
from .priorities import HOLD_TIMES, PriorityPlanner
from .roadmap_set import RoadmapSet

PRIORITIZED_PERIOD = 8  # nodes between two attempts to plan the robots in a priority order
MAX_STATES = 500  # of a search for a path without conflicts
ROUNDING = 1e-9  # of a cost


@dataclass(frozen=True)
class Node:
    """Node of the constraint tree.

    Attributes:
        constraints: of each robot.
        paths: of each robot; they satisfy the constraints.
        lower_bounds: least number of steps of each robot under its constraints.
        conflicts: of the paths.
    """

    constraints: dict[int, tuple[Constraint, ...]]
    paths: dict[int, RoadmapPath]
    lower_bounds: dict[int, int]
    conflicts: Conflicts

    @property
    def cost(self) -> int:
        """Sum of costs: the robots' arrivals, in steps."""
        return sum(path.arrival for path in self.paths.values())

    @property
    def lower_bound(self) -> int:
        """Lower bound on the cost of all solutions under the constraints."""
        return sum(self.lower_bounds.values())


@dataclass(eq=False)
class ConstraintTree:
    """High-level search for robots without a fixed path.

    Args:
        suboptimality: bound on the cost of the solution, relative to the optimum.
        fixed: timed paths of robots that keep them.
        merge_threshold: conflicts between two robots after which they are merged into a meta-agent;
            0: never.

    Attributes:
        to_merge: robots to merge, if the search ended for that reason.
        nodes: number of nodes that were expanded.
    """

    roadmaps: RoadmapSet
    budget: SearchBudget
    suboptimality: float = 1.0
    fixed: Mapping[int, TimedPath] = field(default_factory=dict)
    merge_threshold: int = 0
    to_merge: tuple[int, ...] | None = None
    nodes: int = 0
    _conflict_counts: dict[tuple[int, int], int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.splitter = ConflictSplitter(self.roadmaps)
        self.robots = [i for i in range(len(self.roadmaps.kinds)) if i not in self.fixed]
        fixed = self.fixed.values()
        self._intervals = {i: self.roadmaps.intervals(i, fixed) for i in self.robots}

    def search(self) -> Node | None:
        """Return a node without conflicts; else the node with the fewest of those seen."""
        root = self.root()
        if root is None:
            return None
        open_nodes, best = [root], root
        while open_nodes and not self.budget.expired():
            bound = self.suboptimality * min(node.lower_bound for node in open_nodes) + ROUNDING
            node = self._prioritized(open_nodes[-1])
            best = min(best, node, key=lambda n: (len(n.conflicts), n.cost))
            if not best.conflicts and best.cost <= bound:
                return best
            node = _pop(open_nodes, bound)
            if len(node.conflicts) < len(best.conflicts):
                best = node
            if not node.conflicts or self._should_merge(node):
                return node
            self.nodes += 1
            open_nodes += self._children(node)
        return best

    def root(self) -> Node | None:
        """Node with each robot's earliest path, or one near it that avoids the robots before it."""
        earliest: dict[int, RoadmapPath] = {}
        for i in self.robots:
            path = self._plan(i, ())
            if path is None:
                if self.merge_threshold and self.fixed and not self.budget.expired():
                    self.to_merge = (i, *self.fixed)  # the meta-agents block the robot
                return None
            earliest[i] = path
        node = Node({}, {}, {}, {})
        for i in sorted(self.robots, key=lambda i: -earliest[i].arrival):
            node.lower_bounds[i] = earliest[i].arrival
            node = self._with_path(node, i, earliest[i])
        return node

    def _prioritized(self, node: Node) -> Node:
        """Node with the same constraints, planned in a priority order; or the node itself."""
        if not node.conflicts or self.suboptimality == 1.0 or self.nodes % PRIORITIZED_PERIOD:
            return node
        planner = PriorityPlanner(self.roadmaps, self.budget, self.fixed, node.constraints)
        order = planner.initial_order()
        for hold in HOLD_TIMES if self.nodes == 0 else HOLD_TIMES[:1]:
            paths, failed = planner.plan(order, hold)
            if failed is None:
                return replace(node, paths=paths, conflicts={})
            order = [failed, *(i for i in order if i != failed)]
        return node

    def _should_merge(self, node: Node) -> bool:
        """Whether two of its robots have reached the merge threshold (MA-CBS)."""
        if not self.merge_threshold:
            return False
        pair = max(node.conflicts, key=lambda p: self._conflict_counts.get(p, 0))
        if self._conflict_counts.get(pair, 0) >= self.merge_threshold:
            self.to_merge = pair
        return self.to_merge is not None

    def _children(self, node: Node) -> list[Node]:
        """Two nodes with one constraint more each; or the node itself with a bypass."""
        conflict = min(node.conflicts.values(), key=lambda c: (c.step, c.i, c.j))
        pair = conflict.i, conflict.j
        self._conflict_counts[pair] = self._conflict_counts.get(pair, 0) + 1
        children = []
        for constraint in self.splitter.split(conflict, node.paths):
            child = self._child(node, constraint)
            if child is None:
                continue
            bypass = replace(node, paths=child.paths, conflicts=child.conflicts)
            fewer = len(child.conflicts) < len(node.conflicts)
            if fewer and bypass.cost <= self.suboptimality * node.lower_bound:
                return [bypass]
            children.append(child)
        return children

    def _child(self, node: Node, constraint: Constraint) -> Node | None:
        """Node with one more constraint; None if the robot has no path that satisfies it."""
        i = constraint.robot
        constraints = {**node.constraints, i: (*node.constraints.get(i, ()), constraint)}
        path = self._plan(i, constraints[i])
        if path is None:
            return None
        bounds = {**node.lower_bounds, i: max(node.lower_bounds[i], path.arrival)}
        return self._with_path(replace(node, constraints=constraints, lower_bounds=bounds), i, path)

    def _with_path(self, node: Node, i: int, earliest: RoadmapPath) -> Node:
        """Node with robot i's earliest path, or with one without conflicts within the bound."""
        others = {j: path for j, path in node.paths.items() if j != i}
        path, conflicts = earliest, conflicts_of(self.roadmaps, i, {**others, i: earliest})
        if conflicts and self.suboptimality > 1.0:
            spent = sum(path.arrival for path in others.values())
            latest = int(self.suboptimality * node.lower_bound - spent + ROUNDING)
            timed = [self.roadmaps.timed(j, path) for j, path in others.items()]
            free = self._plan(i, node.constraints.get(i, ()), timed, latest)
            if free is not None:
                path, conflicts = free, {}
        kept = {pair: conflict for pair, conflict in node.conflicts.items() if i not in pair}
        return replace(node, paths={**node.paths, i: path}, conflicts=kept | conflicts)

    def _plan(
        self,
        i: int,
        constraints: Iterable[Constraint],
        others: Sequence[TimedPath] = (),
        latest: int = INF,
    ) -> RoadmapPath | None:
        """Earliest path of robot i under constraints, among others, that arrives until `latest`."""
        obstacles = self._intervals[i]
        if others:
            obstacles = self.roadmaps.intervals(i, [*self.fixed.values(), *others])
        options = {} if latest == INF else {"latest": latest, "max_states": MAX_STATES}
        return self.roadmaps.plan(i, obstacles, constraints, self.budget, **options)


def _pop(nodes: list[Node], bound: float) -> Node:
    """Remove the node with the fewest conflicts of those with a cost within the bound (focal)."""
    focal = [k for k, node in enumerate(nodes) if node.cost <= bound]
    return nodes.pop(min(focal, key=lambda k: (len(nodes[k].conflicts), nodes[k].cost, -k)))

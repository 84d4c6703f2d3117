"""Meta-agents: robots with many conflicts are merged and planned jointly (MA-CBS).

G. Sharon et al., "Meta-agent conflict-based search for optimal multi-agent path finding", SoCS
2012. The joint path of a meta-agent is fixed, and the search restarts for the other robots.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from fgenv.arrays import Floats
from fgenv.planners.errors import PlanningError
from fgenv.planners.sipp.dynamic_obstacles import TimedPath
from fgenv.planners.sipp.sipp import SearchBudget

from .constraint_tree import ConstraintTree, Node
from .roadmap_set import RoadmapSet
from .solution import Solution

JointPlanner = Callable[[tuple[int, ...], float], Sequence[Floats]]
MERGE_THRESHOLD = 20  # conflicts between two robots (B in MA-CBS)
TIME_SHARE = 0.3  # of the time left, for a meta-agent


@dataclass(eq=False)
class MetaAgentSearch:
    """Conflict-based searches with merges in between.

    Args:
        joint_planner: see `plan_conflict_based`.

    Attributes:
        paths: of the robots in meta-agents.
        nodes: nodes of all constraint trees.
    """

    roadmaps: RoadmapSet
    budget: SearchBudget
    suboptimality: float
    joint_planner: JointPlanner | None
    paths: dict[int, Floats] = field(default_factory=dict)
    meta_agents: list[tuple[int, ...]] = field(default_factory=list)
    nodes: int = 0

    def run(self) -> Solution:
        """Search until no more robots have to be merged; the solution may be incomplete."""
        threshold = 0 if self.joint_planner is None else MERGE_THRESHOLD
        fixed: dict[int, TimedPath] = {}
        while True:
            tree = ConstraintTree(self.roadmaps, self.budget, self.suboptimality, fixed, threshold)
            node = tree.search()
            self.nodes += tree.nodes
            if tree.to_merge is None or not self._merge(tree.to_merge):
                return self._solution(node)
            fixed = {i: self.roadmaps.add_path(i, path) for i, path in self.paths.items()}

    def _merge(self, robots: tuple[int, ...]) -> bool:
        """Plan robots, and the meta-agents that contain them, jointly; False without a path."""
        assert self.joint_planner is not None
        merged = [group for group in self.meta_agents if set(group) & set(robots)]
        group = tuple(sorted(set(robots).union(*merged)))
        left = self.budget.deadline.left
        if left <= 0:
            return False
        share = 1.0 if len(group) == len(self.roadmaps.kinds) else TIME_SHARE
        try:
            paths = self.joint_planner(group, share * left)
        except PlanningError:
            return False
        self.paths.update(zip(group, paths, strict=True))
        self.meta_agents = [g for g in self.meta_agents if g not in merged] + [group]
        return True

    def _solution(self, node: Node | None) -> Solution:
        """Paths of a node and of the meta-agents, without robots that conflict."""
        paths: dict[int, Floats] = {}
        if node is not None:
            dropped = _cover(list(node.conflicts))
            for i, path in node.paths.items():
                if i not in dropped:
                    paths[i] = self.roadmaps.configurations(i, self.roadmaps.timed(i, path))
        paths |= self.paths
        stats = self.roadmaps.stats(
            self.budget, nodes=self.nodes, meta_agents=tuple(self.meta_agents)
        )
        return Solution(tuple(paths.get(i) for i in range(len(self.roadmaps.kinds))), stats)


def _cover(pairs: list[tuple[int, int]]) -> set[int]:
    """Robots without which no conflict remains: a small vertex cover, found greedily."""
    cover: set[int] = set()
    for pair in pairs:
        if not cover & set(pair):
            cover.add(max(pair, key=lambda i: sum(i in p for p in pairs)))
    return cover

"""Solutions of multi-robot searches: timed paths and statistics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from fgenv.arrays import Floats
from fgenv.planners.errors import PlanningError


@dataclass(frozen=True)
class SearchStats:
    """Statistics of a search.

    Attributes:
        expanded: states that the single-robot searches expanded.
        searches: single-robot searches.
        checks: pairs of motions that the world has checked.
        roadmaps: numbers of vertices and edges of each kind's roadmap.
        restarts: priority orders after the first (`prioritized`).
        nodes: nodes of the constraint tree (`conflict_based`).
        meta_agents: groups of robots that were planned jointly (`conflict_based`).
    """

    expanded: int = 0
    searches: int = 0
    checks: int = 0
    roadmaps: tuple[tuple[int, int], ...] = ()
    restarts: int = 0
    nodes: int = 0
    meta_agents: tuple[tuple[int, ...], ...] = ()


@dataclass(frozen=True)
class Solution:
    """Timed path of each robot: configurations (k + 1, nq) at each step; None if it has none."""

    paths: tuple[Floats | None, ...]
    stats: SearchStats = field(default_factory=SearchStats)

    @property
    def missing(self) -> tuple[int, ...]:
        """Robots without a path."""
        return tuple(i for i, path in enumerate(self.paths) if path is None)

    @property
    def complete(self) -> bool:
        """Whether every robot has a path."""
        return not self.missing

    def error(self, names: Sequence[str], method: str, effort: str, remedy: str) -> PlanningError:
        """Error for an incomplete solution; `names` are of all robots."""
        missing, total = ", ".join(names[i] for i in self.missing), len(names)
        return PlanningError(
            f"{method}: no paths for all {total} robots {effort}; {total - len(self.missing)} have"
            f" one, but not {missing}; allow more time, or use {remedy}",
            self,
        )

"""Timed paths of many robots, and what it took to find them."""

from __future__ import annotations

from dataclasses import dataclass, field

from fgenv.arrays import Floats


@dataclass(frozen=True)
class Stats:
    """What a method took.

    Attributes:
        expanded: states of single robots' searches.
        searches: of single robots.
        checks: pairs of steps that the world was asked.
        roadmaps: vertices and moves of each kind's.
        restarts: orders tried beside the first, of `prioritized`.
        nodes: of the high level, of `conflict_based`.
        knots: groups that were solved jointly.
    """

    expanded: int = 0
    searches: int = 0
    checks: int = 0
    roadmaps: tuple[tuple[int, int], ...] = ()
    restarts: int = 0
    nodes: int = 0
    knots: tuple[tuple[int, ...], ...] = ()


@dataclass(frozen=True)
class Timetable:
    """Timed paths: configurations (k + 1, nq) at each step, of each robot; None: it has none."""

    paths: tuple[Floats | None, ...]
    stats: Stats = field(default_factory=Stats)

    @property
    def missing(self) -> tuple[int, ...]:
        """Robots without a path."""
        return tuple(i for i, path in enumerate(self.paths) if path is None)

    @property
    def complete(self) -> bool:
        """Whether every robot has a path."""
        return not self.missing

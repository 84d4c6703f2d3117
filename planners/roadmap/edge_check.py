"""Batched checks of a roadmap's vertices and edges against the static bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fgenv.arrays import Flags, Floats, Ints
from fgenv.collision import World


@dataclass(frozen=True)
class EdgeCheck:
    """Checks one robot in a world with a margin (m)."""

    world: World
    name: str
    margin: float

    def valid(self, q: Floats) -> Floats:
        """Those of the configurations (n, nq) that do not collide."""
        hit = np.asarray(self.world.collides(self.name, q, margin=self.margin), dtype=bool)
        kept: Floats = q[~hit]
        return kept

    def free(self, q0: Floats, q1: Floats) -> Flags:
        """Whether the motions from q0 to q1 (..., nq) are certified free."""
        result = self.world.check_motion(self.name, q0, q1, margin=self.margin, first_contact=False)
        return np.asarray(result.free, dtype=bool)

    def free_edges(self, q: Floats, edges: Ints) -> Ints:
        """Those of the edges (m, 2) between vertices q (n, nq) that are certified free."""
        if not len(edges):
            return edges
        kept: Ints = edges[self.free(q[edges[:, 0]], q[edges[:, 1]])]
        return kept

    def free_paths(self, paths: list[Floats]) -> Ints:
        """Places of the paths (k + 1, nq) that are certified free."""
        if not paths:
            return np.zeros(0, dtype=np.int64)
        q0, q1 = np.concatenate([p[:-1] for p in paths]), np.concatenate([p[1:] for p in paths])
        ends = np.cumsum([len(path) - 1 for path in paths])
        parts = np.split(self.free(q0, q1), ends[:-1])
        return np.flatnonzero([part.all() for part in parts])

"""Batched checks of a roadmap's vertices and edges against the static bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fgenv.arrays import Flags, Floats, Ints
from fgenv.collision import World
from fgenv.planners.deadline import NEVER, Deadline

CHUNK = 1024  # motions between two reads of the clock


@dataclass(frozen=True)
class EdgeCheck:
    """Checks one robot in a world with a margin (m), until a deadline."""

    world: World
    name: str
    margin: float
    deadline: Deadline = NEVER

    def valid(self, q: Floats) -> Floats:
        """Those of the configurations (n, nq) that do not collide."""
        hit = np.asarray(self.world.collides(self.name, q, margin=self.margin), dtype=bool)
        kept: Floats = q[~hit]
        return kept

    def free(self, q0: Floats, q1: Floats) -> Flags:
        """Whether the motions from q0 to q1 (..., nq) are certified free."""
        q0, q1 = np.broadcast_arrays(q0, q1)
        rows = q0.reshape(-1, q0.shape[-1]), q1.reshape(-1, q1.shape[-1])
        free = np.empty(len(rows[0]), dtype=bool)
        for k in range(0, len(free), CHUNK):
            self.deadline.check("the check of a roadmap's edges")
            part = slice(k, k + CHUNK)
            free[part] = self.world.check_motion(
                self.name, rows[0][part], rows[1][part], margin=self.margin, first_contact=False
            ).free
        return free.reshape(q0.shape[:-1])

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

"""Cache of which motions of two robots collide: exact results, computed in batches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from fgenv.arrays import Flags, Floats, Ints
from fgenv.collision import World

from .motion_table import MotionTable

BITS = 32  # of a motion's number


@dataclass(eq=False)
class PairCache:
    """Whether simultaneous motions of robots of two kinds are not certified collision-free.

    Args:
        world: computes the results by `meet`.
        tables: motion table of each kind.
        members: ids in the world of each kind's robots; any two represent their kinds.
        margin: meters; motions that come nearer count as a collision.

    Attributes:
        checks: pairs of motions that the world has checked.
    """

    world: World
    tables: Sequence[MotionTable]
    members: Sequence[Sequence[int]]
    margin: float = 0.0
    checks: int = 0
    _results: dict[tuple[int, int], dict[int, bool]] = field(default_factory=dict)

    def collide(self, a: int, motions_a: Ints, b: int, motions_b: Ints) -> Flags:
        """True for each pair of motions (n,) of kinds a and b that is not certified free."""
        out = np.zeros(len(motions_a), dtype=bool)
        near = np.flatnonzero(self.spheres_overlap(a, motions_a, b, motions_b))
        if len(near):
            out[near] = self.collide_near(a, motions_a[near], b, motions_b[near])
        return out

    def spheres_overlap(self, a: int, motions_a: Ints, b: int, motions_b: Ints) -> Flags:
        """Whether the bounding spheres of two motions overlap, (n,)."""
        one, two = self.tables[a], self.tables[b]
        reach = one.radius[motions_a] + two.radius[motions_b] + self.margin
        offset = one.center[motions_a] - two.center[motions_b]
        return np.asarray((offset * offset).sum(-1) <= reach * reach)

    def collide_near(self, a: int, motions_a: Ints, b: int, motions_b: Ints) -> Flags:
        """`collide` for pairs with overlapping bounding spheres."""
        if a > b:
            a, b, motions_a, motions_b = b, a, motions_b, motions_a
        elif a == b:
            motions_a, motions_b = (
                np.minimum(motions_a, motions_b),
                np.maximum(motions_a, motions_b),
            )
        results = self._results.setdefault((a, b), {})
        keys = ((motions_a << BITS) | motions_b).tolist()
        new = [key for key in dict.fromkeys(keys) if key not in results]
        if new:
            collisions = self._check(a, b, np.array(new, dtype=np.int64))
            results.update(zip(new, collisions.tolist(), strict=True))
        return np.fromiter(map(results.__getitem__, keys), bool, len(keys))

    def _check(self, a: int, b: int, keys: Ints) -> Flags:
        self.checks += len(keys)
        robot, other = self.members[a][0], self.members[b][-1]
        if robot == other:  # the only robot of its kind never collides with itself
            return np.zeros(len(keys), dtype=bool)
        ends_a = self._ends(a, keys >> BITS)
        ends_b = self._ends(b, keys & ((1 << BITS) - 1))
        return np.asarray(
            self.world.motions_collide(
                robot, *ends_a, other, *ends_b, margin=self.margin, threads=1
            )
        )

    def _ends(self, kind: int, motions: Ints) -> tuple[Floats, Floats]:
        return self.tables[kind].q0[motions], self.tables[kind].q1[motions]

"""Which steps of two robots meet: exact, asked for in batches, kept under their numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fgenv.arrays import Flags, Floats, Ints
from fgenv.collision import World
from fgenv.planners.roadmap.motion_table import Steps

BITS = 32  # of a step's number


class Meetings:
    """Whether steps of robots of two kinds, made at once, are not proved apart.

    Args:
        world: where `World.meet` is asked.
        steps: the table of each kind.
        members: ids in the world of each kind's robots; two of a kind stand for any two.
        margin: meters: nearer than this is a meeting.
    """

    def __init__(
        self,
        world: World,
        steps: Sequence[Steps],
        members: Sequence[Sequence[int]],
        margin: float = 0.0,
    ) -> None:
        self.world, self.steps, self.members, self.margin = world, steps, members, margin
        self.checks = 0  # pairs of steps that the world was asked
        self._known: dict[tuple[int, int], dict[int, bool]] = {}

    def meet(self, a: int, steps_a: Ints, b: int, steps_b: Ints) -> Flags:
        """For pairs of steps (n,) of kinds a and b: True where they are not proved apart."""
        out = np.zeros(len(steps_a), dtype=bool)
        near = np.flatnonzero(self.near(a, steps_a, b, steps_b))
        if len(near):
            out[near] = self.meet_near(a, steps_a[near], b, steps_b[near])
        return out

    def near(self, a: int, steps_a: Ints, b: int, steps_b: Ints) -> Flags:
        """Where the balls around two steps overlap."""
        one, other = self.steps[a], self.steps[b]
        reach = one.radius[steps_a] + other.radius[steps_b] + self.margin
        apart = one.center[steps_a] - other.center[steps_b]
        return np.asarray((apart * apart).sum(-1) <= reach * reach)

    def meet_near(self, a: int, steps_a: Ints, b: int, steps_b: Ints) -> Flags:
        """As `meet`, of pairs that are near each other."""
        if a > b:
            a, b, steps_a, steps_b = b, a, steps_b, steps_a
        elif a == b:
            steps_a, steps_b = np.minimum(steps_a, steps_b), np.maximum(steps_a, steps_b)
        known = self._known.setdefault((a, b), {})
        keys = ((steps_a << BITS) | steps_b).tolist()
        new = [key for key in dict.fromkeys(keys) if key not in known]
        if new:
            self._ask(a, b, np.array(new, dtype=np.int64), known)
        return np.fromiter(map(known.__getitem__, keys), bool, len(keys))

    def _ask(self, a: int, b: int, keys: Ints, known: dict[int, bool]) -> None:
        mine, other = keys >> BITS, keys & ((1 << BITS) - 1)
        one, two = self.steps[a], self.steps[b]
        found = self.ask(a, one.q0[mine], one.q1[mine], b, two.q0[other], two.q1[other])
        self.checks += len(keys)
        known.update(zip(keys.tolist(), found.tolist(), strict=True))

    def ask(self, a: int, A0: Floats, A1: Floats, b: int, B0: Floats, B1: Floats) -> Flags:
        """The world's answer for motions (n, nq) of kinds a and b; nothing is kept."""
        robot, other = self.members[a][0], self.members[b][-1]
        if robot == other:  # one of its kind never meets itself
            return np.zeros(len(A0), dtype=bool)
        return np.asarray(
            self.world.meet(robot, A0, A1, other, B0, B1, margin=self.margin, threads=1)
        )

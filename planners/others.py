"""Other robots' timed paths as entries: steps made once, at a time, and steps stood through."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .conflicts import Bools, Meetings
from .moves import GONE, Floats, Ints
from .roadmap import INF


@dataclass(frozen=True)
class Timed:
    """What a robot does in each step, (k,), and then for ever (GONE: it is not there)."""

    kind: int
    steps: Ints
    rest: int


@dataclass(frozen=True)
class Entries:
    """Entry e: somebody of a kind makes step `steps[e]` at each time of `first[e]` to `last[e]`."""

    kind: int
    steps: Ints
    first: Ints
    last: Ints  # INF: for ever
    centre: Floats
    radius: Floats

    def near(self, centre: Floats, reach: float) -> Ints:
        """Entries whose balls overlap a ball (3,), metres."""
        away = self.centre - centre
        far = self.radius + reach
        return np.flatnonzero(np.einsum("ij,ij->i", away, away) <= far * far)

    def pairs(
        self, entries: Ints, centre: Floats, radius: Floats, margin: float
    ) -> tuple[Ints, Ints]:
        """Places of balls (n, 3), (n,) and entries that overlap, two arrays (m,)."""
        at = self.centre[entries]
        middle = at.mean(0)  # near zero, squares lose nothing
        a, b = centre - middle, at - middle
        squares = (a * a).sum(1)[:, None] + (b * b).sum(1) - 2.0 * (a @ b.T)
        reach = radius[:, None] + (self.radius[entries] + (margin + 1e-6))
        one, two = np.nonzero(squares <= reach * reach)
        return one, entries[two]


def entries(
    meetings: Meetings, kind: int, others: Sequence[Timed]
) -> tuple[Entries, Entries]:
    """Those of one kind: who moves, a step each, and who stands, as long as they do."""
    moving: list[tuple[Ints, Ints, Ints]] = []
    standing: list[tuple[Ints, Ints, Ints]] = []
    table = meetings.steps[kind]
    for other in others:
        steps = other.steps if other.rest == GONE else np.append(other.steps, other.rest)
        if not len(steps):
            continue
        begin = np.flatnonzero(np.diff(steps, prepend=-1))
        end = np.append(begin[1:], len(steps)) - 1
        if other.rest != GONE:
            end[-1] = INF
        made = steps[begin]
        still: Bools = (table.q0[made] == table.q1[made]).all(1)
        for rows, which in ((moving, ~still), (standing, still)):
            rows.append((made[which], begin[which], end[which]))
    return _joined(meetings, kind, moving), _joined(meetings, kind, standing)


def _joined(meetings: Meetings, kind: int, rows: list[tuple[Ints, Ints, Ints]]) -> Entries:
    none = np.zeros(0, dtype=np.int64)
    steps, first, last = (
        np.concatenate([none, *column]) for column in (zip(*rows, strict=True) if rows else [()] * 3)
    )
    table = meetings.steps[kind]
    return Entries(kind, steps, first, last, table.centre[steps], table.radius[steps])

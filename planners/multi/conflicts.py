"""Where two robots' tracks meet, and what must be banned of one or the other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fgenv.arrays import Ints
from fgenv.planners.roadmap.motion_table import GONE
from fgenv.planners.roadmap.roadmap import INF
from fgenv.planners.sipp.sipp import Action, Track

from .constraints import Ban
from .roadmap_set import Tables


@dataclass(frozen=True)
class Clash:
    """Robots i < j meet in step t first; in how many steps they meet in all."""

    t: int
    i: int
    j: int
    steps: int


class Clashes:
    """Finds clashes, and parts them; what is found out about two moves is kept."""

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self._offsets: dict[tuple[int, int, int, int], frozenset[int]] = {}

    def among(self, i: int, tracks: Mapping[int, Track]) -> dict[tuple[int, int], Clash]:
        """Clashes of robot i with each of the others."""
        kinds, meetings = self.tables.kinds, self.tables.meetings
        found: dict[tuple[int, int], Clash] = {}
        for kind in sorted({kinds[j] for j in tracks if j != i}):
            others = [j for j in tracks if j != i and kinds[j] == kind]
            last = max(len(tracks[j].steps) for j in (i, *others)) + 1
            mine = np.broadcast_to(self._padded(i, tracks[i], last), (len(others), last))
            theirs = np.stack([self._padded(j, tracks[j], last) for j in others])
            here, when = np.nonzero((mine != GONE) & (theirs != GONE))
            at = mine[here, when], theirs[here, when]
            near = np.flatnonzero(meetings.near(kinds[i], at[0], kind, at[1]))
            met = meetings.meet_near(kinds[i], at[0][near], kind, at[1][near])
            for k, j in enumerate(others):
                steps = when[near[met & (here[near] == k)]]
                if len(steps):
                    pair = min(i, j), max(i, j)
                    found[pair] = Clash(int(steps[0]), *pair, len(steps))
        return found

    def _padded(self, i: int, track: Track, length: int) -> Ints:
        rest = track.goal if self.tables.park else GONE
        out = np.full(length, rest, dtype=np.int64)
        out[: len(track.steps)] = track.steps
        return out

    def parted(self, clash: Clash, tracks: Mapping[int, Track]) -> tuple[Ban, Ban]:
        """What to ban of either robot. Every solution keeps one of the two bans.

        Whatever the first robot does that its ban forbids meets all that the other's forbids.
        """
        i, j, t = clash.i, clash.j, clash.t
        a, b = _action(tracks[i], t), _action(tracks[j], t)
        if a.move >= 0 and b.move >= 0:
            return self._two_moves(i, a, j, b)
        if a.move < 0 and b.move < 0:
            return self._two_waits(i, a, j, b, t)
        if a.move < 0:
            wait, move = self._wait_and_move(i, a, j, b, t)
            return wait, move
        wait, move = self._wait_and_move(j, b, i, a, t)
        return move, wait

    def _two_moves(self, i: int, a: Action, j: int, b: Action) -> tuple[Ban, Ban]:
        meet, now = self.offsets(i, a, j, b), b.start - a.start
        low = next(d for d in range(now, now - INF, -1) if d - 1 not in meet)
        high = next(d for d in range(now, INF) if d + 1 not in meet)
        return (
            Ban(i, "move", a.move, (a.start, b.start - low)),
            Ban(j, "move", b.move, (b.start, a.start + high)),
        )

    def _wait_and_move(self, i: int, a: Action, j: int, b: Action, t: int) -> tuple[Ban, Ban]:
        """Of one who waits and one who moves: steps of the move that meet the place, in a run."""
        hits = {-d for d in self.offsets(i, a, j, b)}  # places in the move
        at = t - b.start
        low = next(k for k in range(at, -1, -1) if k - 1 not in hits)
        high = next(k for k in range(at, INF) if k + 1 not in hits)
        last = min(b.start + high, a.start + a.length - 1)
        if a.length == INF:  # parked
            return (
                Ban(i, "stay", a.tail, (last, last)),
                Ban(j, "move", b.move, (max(0, last - high), INF)),
            )
        return (
            Ban(i, "wait", a.tail, (last, last)),
            Ban(j, "move", b.move, (max(0, last - high), last - low)),
        )

    def _two_waits(self, i: int, a: Action, j: int, b: Action, t: int) -> tuple[Ban, Ban]:
        def ban(k: int, mine: Action, other: Action) -> Ban:
            if mine.length == INF:
                return Ban(k, "stay", mine.tail, (t, t))
            return Ban(k, "wait", mine.tail, (t, INF if other.length == INF else t))

        return ban(i, a, b), ban(j, b, a)

    def offsets(self, i: int, a: Action, j: int, b: Action) -> frozenset[int]:
        """By how many steps later robot j's action may begin than robot i's for them to meet.

        Of a wait one step is taken, its first.
        """
        kinds = self.tables.kinds
        key = kinds[i], a.step, kinds[j], b.step
        if key not in self._offsets:
            one, two = (
                x.step + np.arange(x.length if x.move >= 0 else 1, dtype=np.int64) for x in (a, b)
            )
            k, m = (grid.ravel() for grid in np.indices((len(one), len(two))))
            met = self.tables.meetings.meet(kinds[i], one[k], kinds[j], two[m])
            self._offsets[key] = frozenset((k - m)[met].tolist())
        return self._offsets[key]


def _action(track: Track, t: int) -> Action:
    """What a robot does in step t; parked: a wait without end."""
    for action in track.actions:
        if action.start <= t < action.start + action.length:
            return action
    return Action(-1, track.goal, track.goal, track.goal, track.arrival, INF)

"""Roadmap of a differential drive: it drives straight between places, and turns on the spot.

At each place it may head along any way to a neighbor, forwards or backwards, so that a vertex is a
place with a heading, and a move either drives or turns.
"""

from __future__ import annotations

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats, Ints
from fgenv.collision import World

SAME = 1e-6  # radians: headings nearer than this are one
CHAIN = 4  # drives in a line that may be one move
CHAIN = 4  # drives in a line that may be one move


class Headings:
    """Vertices (place, heading) by number, as they come."""

    def __init__(self, ends: Floats) -> None:
        self.q: list[tuple[float, float, float]] = []
        self.place: list[int] = []
        self._number: dict[tuple[int, int], int] = {}
        self.ends = ends

    def at(self, place: int, q: tuple[float, float, float]) -> int:
        """The vertex at a place with the heading of q, which is added if it is not there."""
        turns = round(2 * np.pi / SAME)
        key = place, round(q[2] / SAME) % turns
        for near in (key, (place, (key[1] + 1) % turns), (place, (key[1] - 1) % turns)):
            if near in self._number:
                return self._number[near]
        self._number[key] = len(self.q)
        self.q.append(q)
        self.place.append(place)
        return self._number[key]


def expanded(
    world: World,
    name: str,
    ends: Floats,
    places: Floats,
    pairs: Ints,
    margin: float,
    chains: bool = False,
) -> tuple[Floats, Ints]:
    """Vertices (n, 3), the ends (k, 3) first, and proved moves (m, 2) between them.

    Args:
        world: with the robot of that name, and all that stands.
        ends: starts and goals, all different.
        places: (p, 2); those of the ends are among them.
        pairs: (m, 2), places that it may drive between.
        chains: drives in a line are also one move each, without a stop.
    """
    known = {tuple(place): i for i, place in enumerate(places.tolist())}
    vertices = Headings(ends)
    for q in ends.tolist():
        vertices.at(known[q[0], q[1]], (q[0], q[1], q[2]))
    drives = []
    for a, b in pairs.tolist():
        (ax, ay), (bx, by) = places[a].tolist(), places[b].tolist()
        ahead = _core.arc_tangent(by - ay, bx - ax)
        for yaw in (ahead, ahead - np.pi if ahead > 0 else ahead + np.pi):
            drives.append((vertices.at(a, (ax, ay, yaw)), vertices.at(b, (bx, by, yaw))))
    q = np.array(vertices.q)
    driven = _proved(world, name, q, np.array(drives, dtype=np.int64).reshape(-1, 2), margin)
    turns = _turns(world, name, q, vertices, margin, driven)
    long = _chained(driven.tolist()) if chains else driven
    return q, np.concatenate([long, long[:, ::-1], turns])


def _chained(driven: list[list[int]]) -> Ints:
    """Drives, and drives on along the same line: at one vertex heading and heading on are one."""
    on: dict[int, list[int]] = {}
    for a, b in driven:
        on.setdefault(a, []).append(b)
    found = {(a, b) for a, b in driven}
    last = found
    for _ in range(CHAIN - 1):
        last = {(a, c) for a, b in last for c in on.get(b, ())} - found
        found |= last
    return np.array(sorted(found), dtype=np.int64).reshape(-1, 2)


def _turns(
    world: World, name: str, q: Floats, vertices: Headings, margin: float, driven: Ints
) -> Ints:
    """Proved turns between the headings of each place; (m, 2)."""
    used = np.unique(np.concatenate([driven.ravel(), np.arange(len(vertices.ends))]))
    place = np.array(vertices.place)[used]
    order = np.argsort(place, kind="stable")
    used, place = used[order], place[order]
    groups = np.split(used, np.flatnonzero(np.diff(place)) + 1)
    spins = _spins(world, name, q[[g[0] for g in groups]], margin)
    sure: list[Ints] = []
    doubtful: list[Ints] = []
    for group, spin in zip(groups, spins.tolist(), strict=True):
        a, b = np.meshgrid(group, group, indexing="ij")
        both = np.stack([a.ravel(), b.ravel()], axis=1)
        (sure if spin else doubtful).append(both[both[:, 0] != both[:, 1]])
    none = np.zeros((0, 2), dtype=np.int64)
    return np.concatenate(
        [none, *sure, _proved(world, name, q, np.concatenate([none, *doubtful]), margin)]
    )


def _spins(world: World, name: str, q: Floats, margin: float) -> Flags:
    """Whether a whole turn is free at each of q (n, 3)."""
    third = np.array([0.0, 0.0, 2 * np.pi / 3])
    ends = q + third * np.arange(4)[:, None, None]  # (4, n, 3)
    found = world.check_motion(name, ends[:-1], ends[1:], margin=margin, first=False)
    return np.asarray(np.asarray(found.free, dtype=bool).all(0))


def _proved(world: World, name: str, q: Floats, moves: Ints, margin: float) -> Ints:
    if not len(moves):
        return moves
    found = world.check_motion(name, q[moves[:, 0]], q[moves[:, 1]], margin=margin, first=False)
    kept: Ints = moves[np.asarray(found.free, dtype=bool)]
    return kept

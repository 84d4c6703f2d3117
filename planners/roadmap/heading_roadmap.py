"""Roadmap of a differential drive: edges drive straight between positions, or turn in place.

At each position the robot can face along any line to a neighbor, forwards or backwards. A vertex is
a position with a heading.
"""

from __future__ import annotations

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats, Ints

from .edge_check import EdgeCheck

SAME_HEADING = 1e-6  # radians
CHAIN_LENGTH = 4  # collinear drives that one edge can join


class HeadingVertices:
    """Numbered vertices (position, heading); headings within 1e-6 rad are the same."""

    def __init__(self) -> None:
        self.q: list[tuple[float, float, float]] = []
        self.position: list[int] = []
        self._number: dict[tuple[int, int], int] = {}

    def add(self, position: int, q: tuple[float, float, float]) -> int:
        """Number of the vertex with q's heading at a position; a new vertex if there is none."""
        turn = round(2 * np.pi / SAME_HEADING)
        key = position, round(q[2] / SAME_HEADING) % turn
        for near in (key, (position, (key[1] + 1) % turn), (position, (key[1] - 1) % turn)):
            if near in self._number:
                return self._number[near]
        self._number[key] = len(self.q)
        self.q.append(q)
        self.position.append(position)
        return self._number[key]


def heading_roadmap(
    check: EdgeCheck, ends: Floats, positions: Floats, pairs: Ints, chains: bool = False
) -> tuple[Floats, Ints]:
    """Vertices (n, 3), the ends (k, 3) first, and certified edges (m, 2) between them.

    Args:
        ends: starts and goals, all different.
        positions: (p, 2); they include the positions of the ends.
        pairs: (m, 2), positions between which the robot may drive.
        chains: add edges for collinear drives, without a stop in between.
    """
    vertices = HeadingVertices()
    numbers = {tuple(position): i for i, position in enumerate(positions.tolist())}
    for x, y, yaw in ends.tolist():
        vertices.add(numbers[x, y], (x, y, yaw))
    edges = _drives(vertices, positions, pairs)
    q = np.array(vertices.q)
    drives = check.free_edges(q, edges)
    turns = _turns(check, q, np.array(vertices.position), drives, len(ends))
    if chains:
        drives = _chained(drives.tolist())
    return q, np.concatenate([drives, drives[:, ::-1], turns])


def _drives(vertices: HeadingVertices, positions: Floats, pairs: Ints) -> Ints:
    """Edges (m, 2) that drive between pairs of positions, forwards and backwards."""
    drives = []
    for a, b in pairs.tolist():
        (ax, ay), (bx, by) = positions[a].tolist(), positions[b].tolist()
        ahead = _core.arc_tangent(by - ay, bx - ax)
        for yaw in (ahead, ahead - np.pi if ahead > 0 else ahead + np.pi):
            drives.append((vertices.add(a, (ax, ay, yaw)), vertices.add(b, (bx, by, yaw))))
    return np.array(drives, dtype=np.int64).reshape(-1, 2)


def _chained(drives: list[list[int]]) -> Ints:
    """Drives, and their compositions along one line; the heading is the same at each vertex."""
    successors: dict[int, list[int]] = {}
    for a, b in drives:
        successors.setdefault(a, []).append(b)
    chains = {(a, b) for a, b in drives}
    longest = chains
    for _ in range(CHAIN_LENGTH - 1):
        longest = {(a, c) for a, b in longest for c in successors.get(b, ())} - chains
        chains |= longest
    return np.array(sorted(chains), dtype=np.int64).reshape(-1, 2)


def _turns(check: EdgeCheck, q: Floats, positions: Ints, drives: Ints, ends: int) -> Ints:
    """Certified turns (m, 2) between the headings of each position.

    Args:
        positions: (n,), of each vertex.
        ends: number of the first vertices that keep their turns without drives.
    """
    used = np.unique(np.concatenate([drives.ravel(), np.arange(ends)]))
    used = used[np.argsort(positions[used], kind="stable")]
    groups = np.split(used, np.flatnonzero(np.diff(positions[used])) + 1)
    spins = _full_turns(check, q[[group[0] for group in groups]])
    none = np.zeros((0, 2), dtype=np.int64)
    free, unsure = [none], [none]
    for group, spin in zip(groups, spins.tolist(), strict=True):
        a, b = np.meshgrid(group, group, indexing="ij")
        both = np.stack([a.ravel(), b.ravel()], axis=1)
        (free if spin else unsure).append(both[both[:, 0] != both[:, 1]])
    return np.concatenate([*free, check.free_edges(q, np.concatenate(unsure))])


def _full_turns(check: EdgeCheck, q: Floats) -> Flags:
    """Whether a full turn in place is certified free at each of q (n, 3)."""
    third = np.array([0.0, 0.0, 2 * np.pi / 3])
    ends = q + third * np.arange(4)[:, None, None]  # (4, n, 3)
    return np.asarray(check.free(ends[:-1], ends[1:]).all(0))

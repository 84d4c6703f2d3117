"""Which links of a robot may touch each other, and which do."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fgenv.collision import collide

if TYPE_CHECKING:
    from .robot import Robot

Pairs = tuple[tuple[str, str], ...]


def allowed(robot: Robot, given: Iterable[Sequence[str]]) -> Pairs:
    """Given pairs of links, joined ones, and those that never move against each other; sorted."""
    known = {link.name: link for link in robot.links}
    found: set[tuple[str, str]] = set()
    for names in given:
        if isinstance(names, str) or len(names) != 2:
            raise ValueError(f"allowed: got {names!r}, expected pairs of names of links")
        for name in names:
            if name not in known:
                raise ValueError(f"allowed: {robot.name!r} has no link {name!r}")
        found.add(pair(*names))
    body = {robot.root: robot.root}  # the first of the links that fixed joints make one with it
    for link in robot.links[1:]:
        joint = robot.carriers[link.name]
        body[link.name] = link.name if joint.moves else body[joint.parent]
        parent = joint.parent  # or, where that has no shape, what carries it
        while not known[parent].shapes and parent != robot.root:
            parent = robot.carriers[parent].parent
        found.add(pair(parent, link.name))
    for a, b in itertools.combinations(body, 2):
        if body[a] == body[b]:
            found.add(pair(a, b))
    return tuple(sorted(found))


def allowed_parts(robot: Robot) -> tuple[tuple[int, int], ...]:
    """See `Robot.allowed_parts`."""
    names = [robot.links[part.link].name for part in robot.parts]
    known = set(robot.allowed)
    return tuple(
        (i, j)
        for i, j in itertools.combinations(range(len(names)), 2)
        if names[i] == names[j] or pair(names[i], names[j]) in known
    )


def contacts(robot: Robot, q: ArrayLike) -> Pairs:
    """See `Robot.contacts`."""
    poses = robot.forward(q)
    if poses.ndim != 3:
        raise ValueError(f"q: {poses.shape[:-3]} configurations, expected one, ({robot.nq},)")
    at = [poses[part.link] @ part.origin for part in robot.parts]
    skipped = set(robot.allowed_parts)
    found: dict[tuple[str, str], None] = {}
    for i, j in itertools.combinations(range(len(at)), 2):
        a, b = robot.parts[i], robot.parts[j]
        names = pair(robot.links[a.link].name, robot.links[b.link].name)
        if (i, j) in skipped or names in found:
            continue
        if np.any(collide(a.shape, at[i], b.shape, at[j])):
            found[names] = None
    return tuple(found)


def pair(a: str, b: str) -> tuple[str, str]:
    """Two names in order."""
    return (a, b) if a <= b else (b, a)

"""Allowed collisions between links of one robot, and its self-collisions."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from fgenv.collision import collide

from .kinematic_tree import KinematicTree

LinkPairs = tuple[tuple[str, str], ...]


def allowed_links(tree: KinematicTree, given: Iterable[Sequence[str]]) -> LinkPairs:
    """Given pairs of links, adjacent links, and links without relative motion; sorted."""
    known = {link.name: link for link in tree.links}
    pairs = {_checked(tree, known, names) for names in given}
    rigid = {tree.root: tree.root}  # first link of the group that fixed joints hold together
    for link in tree.links[1:]:
        joint = tree.parent_joints[link.name]
        rigid[link.name] = link.name if joint.moves else rigid[joint.parent]
        parent = joint.parent  # the nearest ancestor with a shape, if there is one
        while not known[parent].shapes and parent != tree.root:
            parent = tree.parent_joints[parent].parent
        pairs.add(sorted_pair(parent, link.name))
    for a, b in itertools.combinations(rigid, 2):
        if rigid[a] == rigid[b]:
            pairs.add(sorted_pair(a, b))
    return tuple(sorted(pairs))


def _checked(tree: KinematicTree, known: Iterable[str], names: Sequence[str]) -> tuple[str, str]:
    if isinstance(names, str) or len(names) != 2:
        raise ValueError(f"allowed: got {names!r}, expected pairs of names of links")
    for name in names:
        if name not in known:
            raise ValueError(f"allowed: got {name!r}, expected a link of {tree.name!r}")
    return sorted_pair(*names)


def allowed_parts(tree: KinematicTree, allowed: LinkPairs) -> tuple[tuple[int, int], ...]:
    """Pairs of indices in `parts` on one link or on an allowed pair of links, in rising order."""
    names = [tree.links[part.link].name for part in tree.parts]
    known = set(allowed)
    return tuple(
        (i, j)
        for i, j in itertools.combinations(range(len(names)), 2)
        if names[i] == names[j] or sorted_pair(names[i], names[j]) in known
    )


def self_collisions(
    tree: KinematicTree, skipped: Iterable[tuple[int, int]], q: ArrayLike
) -> LinkPairs:
    """Pairs of links with colliding shapes at a configuration (nq,); some parts are skipped.

    Raises:
        ValueError: more than one configuration.
    """
    poses = tree.forward(q)
    if poses.ndim != 3:
        raise ValueError(f"q: got {poses.shape[:-3]} configurations, expected one, ({tree.nq},)")
    at = [poses[part.link] @ part.origin for part in tree.parts]
    skip = set(skipped)
    hits: dict[tuple[str, str], None] = {}
    for i, j in itertools.combinations(range(len(at)), 2):
        a, b = tree.parts[i], tree.parts[j]
        names = sorted_pair(tree.links[a.link].name, tree.links[b.link].name)
        if (i, j) in skip or names in hits:
            continue
        if np.any(collide(a.shape, at[i], b.shape, at[j])):
            hits[names] = None
    return tuple(hits)


def sorted_pair(a: str, b: str) -> tuple[str, str]:
    """Two names in alphabetical order."""
    return (a, b) if a <= b else (b, a)

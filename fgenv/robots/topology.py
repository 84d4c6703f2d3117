"""Topology of a kinematic tree: links ordered with parents first, and mimic joints resolved."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from .links_joints import Joint, Link


def check_unique(names: Iterable[str], what: str) -> None:
    """Raise ValueError for a repeated name."""
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise ValueError(f"{what} {name!r}: got two of this name, expected unique names")
        seen.add(name)


def in_order(links: Sequence[Link], joints: Sequence[Joint]) -> tuple[Link, ...]:
    """Links in depth-first order: the root first, parents before children.

    Raises:
        ValueError: the joints do not form a tree: unknown or repeated names, a link with two
            parent joints, a loop, or two roots.
    """
    if not links:
        raise ValueError("links: got none, expected at least one")
    check_unique((link.name for link in links), "link")
    check_unique((joint.name for joint in joints), "joint")
    by_name = {link.name: link for link in links}
    children = _children(by_name, joints)
    with_parent = {name for group in children.values() for name in group}
    roots = [name for name in by_name if name not in with_parent]
    if len(roots) > 1:
        names = ", ".join(map(repr, roots))
        raise ValueError(f"links {names}: got no joint to a parent, expected one root")
    order: list[str] = []
    stack = roots[:]
    while stack:
        name = stack.pop()
        order.append(name)
        stack += reversed(children[name])
    if len(order) < len(by_name):
        rest = next(name for name in by_name if name not in order)
        raise ValueError(f"link {rest!r}: got a loop of joints, expected a tree")
    return tuple(by_name[name] for name in order)


def _children(links: dict[str, Link], joints: Sequence[Joint]) -> dict[str, list[str]]:
    """Names of each link's children, in the order of the joints."""
    parent_joint: dict[str, Joint] = {}
    children: dict[str, list[str]] = {name: [] for name in links}
    for joint in joints:
        for end in (joint.parent, joint.child):
            if end not in links:
                raise ValueError(f"joint {joint.name!r}: got {end!r}, expected the name of a link")
        if joint.child in parent_joint:
            raise ValueError(
                f"link {joint.child!r}: got two parent joints,"
                f" {parent_joint[joint.child].name!r} and {joint.name!r}; expected a tree"
            )
        parent_joint[joint.child] = joint
        children[joint.parent].append(joint.child)
    return children


def mimic_source(joint: Joint, joints: dict[str, Joint]) -> tuple[Joint, float, float]:
    """The independent joint that drives `joint`, with multiplier and offset.

    Raises:
        ValueError: the mimicked joint is missing or fixed, a joint mimics itself, or a fraction of
            a continuous joint is mimicked.
    """
    multiplier, offset, seen, source = 1.0, 0.0, [joint.name], joint
    while source.mimic is not None:
        followed = joints.get(source.mimic.joint)
        if followed is None or not followed.moves:
            fault = "no such joint" if followed is None else "a fixed joint"
            raise ValueError(
                f"joint {source.name!r}: mimic: got {source.mimic.joint!r}, {fault};"
                " expected a joint that moves"
            )
        offset += multiplier * source.mimic.offset
        multiplier *= source.mimic.multiplier
        if followed.name in seen:
            raise ValueError(f"joint {joint.name!r} mimics itself: {' -> '.join(seen)}")
        seen.append(followed.name)
        source = followed
    if source.kind == "continuous" and (not multiplier.is_integer() or joint.kind == "prismatic"):
        raise ValueError(
            f"joint {joint.name!r}: got {multiplier:g} times {source.name!r}, a continuous joint,"
            f" which gives no unique pose; remedy: make {source.name!r} revolute, with limits"
        )
    return source, multiplier, offset

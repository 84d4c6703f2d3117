"""From links and joints in any order to a tree with parents first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from .links_joints import Joint, Link


def unique(names: Iterable[str], what: str) -> None:
    """No name twice."""
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise ValueError(f"{what} {name!r}: there are two of this name, expected unique names")
        seen.add(name)


def in_order(links: Sequence[Link], joints: Sequence[Joint]) -> tuple[Link, ...]:
    """Links with the root first and parents before children.

    Raises:
        ValueError: no tree: unknown or repeated names, a link with two joints, a loop, two roots.
    """
    if not links:
        raise ValueError("links: none, expected at least one")
    unique((link.name for link in links), "link")
    unique((joint.name for joint in joints), "joint")
    by_name = {link.name: link for link in links}
    carrier: dict[str, Joint] = {}
    children: dict[str, list[str]] = {name: [] for name in by_name}
    for joint in joints:
        for end in (joint.parent, joint.child):
            if end not in by_name:
                raise ValueError(f"joint {joint.name!r}: no link is named {end!r}")
        if joint.child in carrier:
            raise ValueError(
                f"link {joint.child!r} hangs on two joints, {carrier[joint.child].name!r} and"
                f" {joint.name!r}; expected a tree"
            )
        carrier[joint.child] = joint
        children[joint.parent].append(joint.child)
    roots = [name for name in by_name if name not in carrier]
    if len(roots) > 1:
        raise ValueError(f"links {', '.join(map(repr, roots))} hang on no joint, expected one root")
    order: list[str] = []
    waiting = roots[:]
    while waiting:
        name = waiting.pop()
        order.append(name)
        waiting += reversed(children[name])
    if len(order) < len(by_name):
        lost = next(name for name in by_name if name not in order)
        raise ValueError(f"link {lost!r} is part of a loop of joints, expected a tree")
    return tuple(by_name[name] for name in order)


def leader(joint: Joint, joints: dict[str, Joint]) -> tuple[Joint, float, float]:
    """The joint with a value of its own that `joint` follows, the multiplier and the offset.

    Raises:
        ValueError: it follows nothing that moves, itself, or turns a part of what goes round.
    """
    multiplier, offset, seen, end = 1.0, 0.0, [joint.name], joint
    while end.mimic is not None:
        followed = joints.get(end.mimic.joint)
        if followed is None or not followed.moves:
            what = "there is no such joint" if followed is None else "it is fixed"
            raise ValueError(f"joint {end.name!r} mimics {end.mimic.joint!r}: {what}")
        offset += multiplier * end.mimic.offset
        multiplier *= end.mimic.multiplier
        if followed.name in seen:
            raise ValueError(f"joint {joint.name!r} mimics itself: {' -> '.join(seen)}")
        seen.append(followed.name)
        end = followed
    if end.kind == "continuous" and (not multiplier.is_integer() or joint.kind == "prismatic"):
        raise ValueError(
            f"joint {joint.name!r} mimics {end.name!r}, which turns without end, {multiplier:g}"
            f" times: it has no one pose then; make {end.name!r} revolute, with limits"
        )
    return end, multiplier, offset

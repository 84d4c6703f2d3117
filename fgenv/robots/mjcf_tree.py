"""Bodies of a compiled MJCF model: names, trees, and the tree that is the robot."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

FREE = 0  # mjJNT_FREE
MAX_LISTED = 8  # names in a message


class Names:
    """Unique names of bodies and joints; those without a name get one with their number.

    Attributes:
        bodies, joints: names by number.
    """

    def __init__(self, model: Any) -> None:
        self.bodies = _named("body", (model.body(i).name for i in range(model.nbody)))
        self.joints = _named("joint", (model.joint(i).name for i in range(model.njnt)))
        self._bodies, self._joints = set(self.bodies[1:]), set(self.joints)

    def unused_body(self, name: str) -> str:
        """The name, or with underscores if it is in use; it is in use from now on."""
        return _unused(name, self._bodies)

    def unused_joint(self, name: str) -> str:
        """As `unused_body`, for a joint."""
        return _unused(name, self._joints)


def _named(what: str, names: Iterable[str]) -> list[str]:
    given = list(names)
    used = set(given)
    return [name or _unused(f"{what}{i}", used) for i, name in enumerate(given)]


def _unused(name: str, used: set[str]) -> str:
    while name in used:
        name += "_"
    used.add(name)
    return name


def body_subtree(model: Any, first: int) -> list[int]:
    """A body and all below, parents first, in the order of the file."""
    inside = {first}
    for body in range(first + 1, model.nbody):
        if int(model.body_parentid[body]) in inside:
            inside.add(body)
    return sorted(inside)


def robot_root(model: Any, root: str | None, notes: list[str]) -> int:
    """The first body of the robot; a note names the rest.

    Args:
        root: its name; None: the only tree that may be the robot.

    Raises:
        ValueError: no such body, or several trees that may be the robot.
    """
    names = Names(model).bodies
    trees = [body for body in range(1, model.nbody) if model.body_parentid[body] == 0]
    if root is not None:
        first = next((body for body in trees if names[body] == root), None)
        if first is None:
            known = listed(repr(names[body]) for body in trees)
            raise ValueError(f"root: got {root!r}, expected a body of the world: {known}")
    else:
        likely = _likely(model, trees)
        if not likely:
            raise ValueError("worldbody: got no body, expected a robot; the file is a scene")
        if len(likely) > 1:
            raise ValueError(
                f"worldbody: got {len(likely)} trees with joints"
                f" ({listed(repr(names[body]) for body in likely)}), expected one robot;"
                " remove the other bodies, or give root=, the name of the robot's first body"
            )
        first = likely[0]
    _note_scene(model, [names[body] for body in trees if body != first], notes)
    return first


def _likely(model: Any, trees: list[int]) -> list[int]:
    """Trees that may be the robot: those with joints, without objects that are only free."""
    joints = {
        tree: [
            int(model.jnt_type[j])
            for j in range(model.njnt)
            if model.body_rootid[model.jnt_bodyid[j]] == tree
        ]
        for tree in trees
    }
    moving = [tree for tree in trees if joints[tree]]
    articulated = [tree for tree in moving if joints[tree] != [FREE]]
    return articulated or moving or trees


def _note_scene(model: Any, bodies: list[str], notes: list[str]) -> None:
    geoms = int(np.count_nonzero(np.asarray(model.geom_bodyid) == 0))
    parts = [f"geoms of the world ({geoms})"] if geoms else []
    parts += [f"bodies {listed(map(repr, bodies))}"] if bodies else []
    if parts:
        notes.append(f"Left out as scene: {' and '.join(parts)}.")


def listed(names: Iterable[str]) -> str:
    """Names with commas; only the first of many."""
    given = list(names)
    rest = f" and {len(given) - MAX_LISTED} more" if len(given) > MAX_LISTED else ""
    return ", ".join(given[:MAX_LISTED]) + rest

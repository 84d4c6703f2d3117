"""Robots as files specify them, before a base, a drive and a mount are chosen."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fgenv.arrays import Floats

from .links_joints import Joint, Link


@dataclass(frozen=True, eq=False)
class RobotFile:
    """The robot that a file specifies.

    Attributes:
        name: in the file, or the file's own name.
        links, joints: a tree with one root.
        base: joint between the world and the root, as the file has it: `fixed`, `planar` or `free`.
        mount: (4, 4), the base's frame in the world, meters. Of a `free` base it is the identity:
            its coordinates are the root's pose in the world.
        placement: (4, 4), the root's pose in the world where the file puts it, meters: the mount of
            a base other than the file's.
        allowed: pairs of links that may touch, as the file says.
        notes: sentences on what the file has and the robot does not, or has otherwise.
        other_geometry: whether the file has geometry of the kind, collision or visual, that was not
            asked for.
    """

    name: str
    links: list[Link]
    joints: list[Joint]
    base: str = "fixed"
    mount: Floats = field(default_factory=lambda: np.eye(4))
    placement: Floats = field(default_factory=lambda: np.eye(4))
    allowed: list[tuple[str, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    other_geometry: bool = False

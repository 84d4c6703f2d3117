"""Kinematic tree: links, joints and a base; forward kinematics in native code."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape

from .links_joints import JOINT_KINDS, Joint, Link, LinkShape, as_pose, name_of
from .topology import in_order, mimic_source

BASES: dict[str, tuple[str, ...]] = {
    "fixed": (),
    "planar": ("x", "y", "yaw"),
    "free": ("x", "y", "z", "qx", "qy", "qz", "qw"),
}
BASE_DOF = {"fixed": 0, "planar": 3, "free": 6}
KIND_CODES = {kind: code for code, kind in enumerate((*JOINT_KINDS, "planar", "free"))}


class Part(NamedTuple):
    """A shape of a robot, in the form that a world accepts."""

    link: int
    shape: Shape
    origin: Floats  # (4, 4), in the link's frame


class LinkMotion(NamedTuple):
    """Motion of a link between two configurations; see `KinematicTree.link_motion`."""

    pose: Floats  # (..., 4, 4)
    velocity: Floats  # (..., 3), of the link's origin, meters per unit of t
    angular_velocity: Floats  # (..., 3), radians per unit of t
    acceleration_at_origin: Floats  # (...), upper bound
    acceleration_by_radius: Floats  # (...), upper bound per meter of distance from the origin
    turn: Floats  # (...), radians over the whole motion, upper bound


@dataclass(frozen=True, eq=False, repr=False)
class KinematicTree:
    """Links, joints between them, and a base joint. Immutable; see `Robot` for the arguments."""

    name: str
    links: Sequence[Link]
    joints: Sequence[Joint] = ()
    base: str = "fixed"
    mount: Floats = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        put = object.__setattr__
        name_of(self.name, "name")
        if self.base not in BASES:
            raise ValueError(f"base: got {self.base!r}, expected one of {', '.join(BASES)}")
        put(self, "joints", tuple(self.joints))
        put(self, "links", in_order(tuple(self.links), self.joints))
        put(self, "mount", as_pose(self.mount, "mount"))
        _ = self._core  # raises errors of the joints

    # Structure

    @cached_property
    def moving_joints(self) -> tuple[Joint, ...]:
        """Joints with a coordinate of their own, in the order of the configuration."""
        return tuple(j for j in self.joints if j.moves and j.mimic is None)

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """Names of a configuration's coordinates: the base's, then the joints'."""
        return BASES[self.base] + tuple(joint.name for joint in self.moving_joints)

    @property
    def nq(self) -> int:
        """Length of a configuration."""
        return len(self.coordinates)

    @property
    def dof(self) -> int:
        """Degrees of freedom; an orientation has three, and four coordinates."""
        return BASE_DOF[self.base] + len(self.moving_joints)

    @property
    def root(self) -> str:
        """Name of the link at the base."""
        return self.links[0].name

    @cached_property
    def parent_joints(self) -> dict[str, Joint]:
        """The joint from its parent to each link but the root, by the link's name."""
        return {joint.child: joint for joint in self.joints}

    @cached_property
    def mimic_sources(self) -> dict[str, tuple[Joint, float, float]]:
        """Independent joint, multiplier and offset of each moving joint, by its name."""
        by_name = {joint.name: joint for joint in self.joints}
        return {joint.name: mimic_source(joint, by_name) for joint in self.joints if joint.moves}

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """All shapes with their links."""
        return tuple(
            Part(i, placed.shape, placed.origin)
            for i, link in enumerate(self.links)
            for placed in link.shapes
        )

    @cached_property
    def reach(self) -> dict[str, float]:
        """Upper bound of the distance from a link's origin to any point that the link carries.

        Meters, by the link's name; descendants are included, in any configuration.
        """
        far = {link.name: max(map(_radius, link.shapes), default=0.0) for link in self.links}
        for link in reversed(self.links[1:]):
            joint = self.parent_joints[link.name]
            x, y, z = joint.origin[:3, 3].tolist()
            reach = far[link.name] + math.sqrt(x * x + y * y + z * z)
            if joint.kind == "prismatic":
                source, multiplier, offset = self.mimic_sources[joint.name]
                ends = (source.lower, source.upper)
                reach += max(abs(multiplier * end + offset) for end in ends)
            far[joint.parent] = max(far[joint.parent], reach)
        return far

    def link_index(self, link: str | int) -> int:
        """Index of a link in `links`, from its name."""
        if isinstance(link, (int, np.integer)):
            if not 0 <= link < len(self.links):
                raise ValueError(
                    f"link: got {link}, expected an index below {len(self.links)} of {self.name!r}"
                )
            return int(link)
        if link not in self._index:
            raise ValueError(
                f"link: got {link!r}, expected one of {self.name!r}: {', '.join(self._index)}"
            )
        return self._index[link]

    # Poses

    def forward(
        self, q: ArrayLike, link: str | int | None = None, *, threads: int | None = None
    ) -> Floats:
        """Poses in the world of all links, (..., links, 4, 4), or of one, (..., 4, 4).

        Args:
            q: (..., nq).
            link: its name or its index in `links`.
            threads: None: FGENV_THREADS, else all cores. The result does not depend on it.
        """
        poses = self._core.forward(q, threads)
        return poses if link is None else poses[..., self.link_index(link), :, :]

    def link_motion(
        self,
        link: str | int,
        q0: ArrayLike,
        q1: ArrayLike,
        t: ArrayLike = 0.0,
        *,
        offset: ArrayLike | None = None,
        threads: int | None = None,
    ) -> LinkMotion:
        """Pose and velocity of a link at fractions t of the motion from q0 to q1, with bounds.

        A point at distance d from the link's origin never accelerates by more than
        at_origin + d * by_radius; the link never turns by more than `turn`.

        Args:
            link: its name or its index in `links`.
            q0, q1: (..., nq); t: (...); they broadcast.
            offset: (4, 4), of a body on the link: the result then describes the body.
        """
        i = self.link_index(link)
        found = self._core.link_motion(
            i, q0, q1, t=t, offset=offset, begin=0.0, rate=1.0, threads=threads
        )
        return LinkMotion(*found)

    @cached_property
    def _index(self) -> dict[str, int]:
        return {link.name: i for i, link in enumerate(self.links)}

    @cached_property
    def _core(self) -> _core.Robot:
        """The native robot: one row per link, the base's first."""
        first = {name: i for i, name in enumerate(self.coordinates)}
        if len(first) < self.nq:
            raise ValueError(
                f"joints: got a name of a coordinate of a {self.base} base, expected other names"
            )
        rows = [(KIND_CODES[self.base], -1, self.mount, (0.0, 0.0, 1.0), 0, 1.0, 0.0)]
        for link in self.links[1:]:
            joint = self.parent_joints[link.name]
            which, multiplier, offset = 0, 1.0, 0.0
            if joint.moves:
                source, multiplier, offset = self.mimic_sources[joint.name]
                which = first[source.name]
            kind = joint.kind
            if joint.mimic is not None and kind == "continuous":
                kind = "revolute"  # only the coordinate of the mimicked joint wraps
            axis, parent = tuple(joint.axis.tolist()), self._index[joint.parent]
            rows.append((KIND_CODES[kind], parent, joint.origin, axis, which, multiplier, offset))
        kinds, parents, origins, axes, firsts, multipliers, offsets = map(
            list, zip(*rows, strict=True)
        )
        return _core.Robot(
            kinds,
            parents,
            origins,
            axes=axes,
            firsts=firsts,
            multipliers=multipliers,
            offsets=offsets,
            names=list(self.coordinates),
        )


def _radius(placed: LinkShape) -> float:
    """Distance from the link's origin to the farthest vertex of a shape, meters."""
    p, m = placed.shape.vertices, placed.origin
    x, y, z = (
        m[i, 0] * p[:, 0] + m[i, 1] * p[:, 1] + m[i, 2] * p[:, 2] + m[i, 3] for i in range(3)
    )
    return float(np.sqrt(np.max(x * x + y * y + z * z)))

"""A robot: a kinematic tree with shapes on its links. Moved, and interpolated, in native code."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape

from . import allowed_collisions, limits
from .drives import Action, Drive
from .kinematic_tree import in_order, leader
from .links_joints import JOINT_KINDS, Joint, Link, LinkShape, as_pose, locked, name_of, number_of
from .primitives import ERROR

KINDS = {kind: code for code, kind in enumerate((*JOINT_KINDS, "planar", "free"))}


class Part(NamedTuple):
    """A shape of a robot, as a world takes it."""

    link: int
    shape: Shape
    origin: Floats  # in the link's frame


class LinkMotion(NamedTuple):
    """How a link moves on the way between two configurations; see `Robot.link_motion`."""

    pose: Floats  # (..., 4, 4)
    velocity: Floats  # (..., 3), of the link's origin, meters per unit of t
    angular_velocity: Floats  # (..., 3), radians per unit of t
    acceleration_at_origin: Floats  # (...), at most
    acceleration_by_radius: Floats  # (...), more for each meter from the origin, at most
    turn: Floats  # (...), radians over the whole motion, at most


@dataclass(frozen=True, eq=False, repr=False)
class Robot:
    """A kinematic tree: a base joint, then joints from link to link. Immutable.

    A configuration is a vector (nq,): the base's coordinates (`planar`: x, y, yaw; `free`: x, y, z,
    qx, qy, qz, qw, as OMPL's SE2 and SE3), then one for each joint that has a value of its own, in
    the order of `joints`. Meters, radians. All methods take arrays of them, (..., nq).

    Args:
        name: for messages.
        links: in any order; kept with parents first, the root first of all.
        joints: each from a link to another; one link hangs on none.
        base: how the root is placed in the world: `fixed`, `planar` or `free`.
        mount: (4, 4), the base's frame in the world: where the root is with the base at 0.
        drive: what an action means; None: it is moved by configurations alone.
        workspace: bounds of the base's position: (low, high), (2, 2) for `planar`, (2, 3) for
            `free`, meters; infinite if left out.
        allowed: pairs of links whose contact is no collision. Pairs that are joined, and pairs
            that never move against each other, are added.

    Raises:
        ValueError, TypeError: naming what is wrong and what is expected.
    """

    name: str
    links: Sequence[Link]
    joints: Sequence[Joint] = ()
    base: str = "fixed"
    mount: Floats = field(default_factory=lambda: np.eye(4))
    drive: Drive | None = None
    workspace: Floats | None = None
    allowed: Sequence[tuple[str, str]] = ()

    def __post_init__(self) -> None:
        put = object.__setattr__
        name_of(self.name, "name")
        if self.base not in limits.BASES:
            raise ValueError(f"base: got {self.base!r}, expected one of {', '.join(limits.BASES)}")
        put(self, "joints", tuple(self.joints))
        put(self, "links", in_order(tuple(self.links), self.joints))
        put(self, "mount", as_pose(self.mount, "mount"))
        put(self, "workspace", limits.checked_workspace(self.workspace, self.base))
        put(self, "allowed", allowed_collisions.allowed(self, self.allowed))
        _ = self._core  # what is wrong with the joints is told here
        if self.drive is not None:
            if not isinstance(self.drive, Drive):
                raise TypeError(f"drive: got {type(self.drive).__name__}, expected a Drive")
            self.drive.check(self)

    @classmethod
    def from_mesh(
        cls,
        mesh: str | Path | Shape,
        base: str = "planar",
        *,
        drive: Drive | None = None,
        name: str | None = None,
        scale: float = 1.0,
        origin: ArrayLike | None = None,
        mount: ArrayLike | None = None,
        workspace: ArrayLike | None = None,
    ) -> Robot:
        """A robot of one link from a mesh file or a shape.

        Args:
            mesh: a file that `Shape.load` reads, or a Shape.
            scale: factor to meters, for a file.
            origin: (4, 4), from the mesh's frame to the robot's.
            name: that of the mesh if left out.
            base, drive, mount, workspace: see `Robot`.
        """
        shape = mesh if isinstance(mesh, Shape) else Shape.load(mesh, scale=scale)
        body = Link("body", LinkShape(shape, as_pose(origin, "origin")))
        label = name or shape.name or "robot"
        place = as_pose(mount, "mount")
        return cls(label, (body,), (), base, place, drive, workspace)  # type: ignore[arg-type]

    @classmethod
    def from_urdf(
        cls,
        path: str | Path,
        base: str = "fixed",
        *,
        collision: bool = True,
        package_dirs: str | Path | Iterable[str | Path] = (),
        srdf: str | Path | None = None,
        scale: float = 1.0,
        error: float = ERROR,
        method: str = "exact",
        tolerance: float | None = None,
        drive: Drive | None = None,
        name: str | None = None,
        mount: ArrayLike | None = None,
        workspace: ArrayLike | None = None,
    ) -> Robot:
        """A robot from a URDF file, which yourdfpy reads: `pip install 'fgenv[urdf]'`.

        Every shape of a link stays one of its own. A negative mesh scale mirrors. The unit
        of a COLLADA file counts, its up axis does not, as in RViz. A revolute or prismatic joint
        without lower or upper has none; a speed limit of 0 is none.

        Args:
            path: the file.
            collision: shapes are the links' collision geometry; False: their visual geometry.
            package_dirs: where `package://NAME/...` is looked for first: folders of packages, or
                packages; then ROS_PACKAGE_PATH and the folders above the file.
            srdf: a file with pairs of links whose collisions are disabled.
            scale: factor of all lengths.
            error: meters that the mesh of a cylinder or sphere, which encloses it, may stick out.
            method, tolerance: of the shapes, see `Shape`.
            name: the file's if left out.
            base, drive, mount, workspace: see `Robot`.

        Raises:
            FileNotFoundError: the file, or a mesh that it names: says where it was looked for.
            ModuleNotFoundError: yourdfpy is not installed.
            ValueError: naming file, line or link, what came and what is expected.
        """
        from .urdf import Reader, allowed_in

        if number_of(scale, "scale", 0.0, finite=True) == 0:
            raise ValueError("scale: got 0, expected a factor over 0")
        folders = [package_dirs] if isinstance(package_dirs, (str, Path)) else package_dirs
        options = {"method": method, "tolerance": tolerance}
        reader = Reader(Path(path), [Path(f) for f in folders], collision, scale, error, options)
        label, links, joints = reader.read()
        allowed = () if srdf is None else tuple(allowed_in(srdf, links))
        return cls(
            name or label,
            tuple(links),
            tuple(joints),
            base,
            as_pose(mount, "mount"),
            drive,
            workspace,  # type: ignore[arg-type]
            allowed,
        )

    def replace(self, **changes: Any) -> Robot:
        """The same robot but for some of the arguments of `Robot`."""
        return replace(self, **changes)

    # Configurations

    @cached_property
    def moving_joints(self) -> tuple[Joint, ...]:
        """Joints with a value of their own, in the order of the configuration."""
        return tuple(j for j in self.joints if j.moves and j.mimic is None)

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the numbers of a configuration: the base's, then the joints'."""
        return limits.BASES[self.base] + tuple(joint.name for joint in self.moving_joints)

    @property
    def nq(self) -> int:
        """Numbers in a configuration."""
        return len(self.coordinates)

    @property
    def dof(self) -> int:
        """Degrees of freedom: an orientation is three, and four numbers."""
        return limits.BASE_DOF[self.base] + len(self.moving_joints)

    @cached_property
    def lower(self) -> Floats:
        """Lowest configuration, (nq,); angles -pi, quaternions -1."""
        return limits.bounds(self, 0)

    @cached_property
    def upper(self) -> Floats:
        """Highest configuration, (nq,); angles pi, quaternions 1."""
        return limits.bounds(self, 1)

    @cached_property
    def endless(self) -> NDArray[np.bool_]:
        """Which coordinates are angles that go round, (nq,): yaw, continuous joints."""
        return limits.endless(self)

    @cached_property
    def velocity(self) -> Floats:
        """Speed limits, (dof,), per second; infinite for the base, whose drive knows them."""
        return limits.rates(self, "velocity")

    @cached_property
    def acceleration(self) -> Floats:
        """Limits of acceleration, (dof,), per second squared; infinite for the base."""
        return limits.rates(self, "acceleration")

    @cached_property
    def rest(self) -> Floats:
        """The configuration with all at 0, or as near as limits let it."""
        q = np.clip(np.zeros(self.nq), self.lower, self.upper)
        if self.base == "free":
            q[6] = 1.0
        return locked(q)

    @cached_property
    def weights(self) -> Floats:
        """How far a change moves the robot, (nq,), at most: meters for each radian or meter.

        1 for positions; for an angle, the distance of the farthest point that it can move. All four
        of a quaternion are that of its angle.
        """
        return limits.weights(self)

    def random(self, rng: np.random.Generator, size: int | tuple[int, ...] | None = None) -> Floats:
        """Configurations (*size, nq), uniform between the limits; orientations uniform.

        Raises:
            ValueError: a coordinate has no limits.
        """
        return limits.random(self, rng, size)

    def valid(self, q: ArrayLike) -> Any:
        """Whether configurations (..., nq) keep the limits: bool, or a bool array.

        An angle without limits may have any value; a quaternion has length 1, to 1e-6.
        """
        return limits.valid(self, q)

    def clip(self, q: ArrayLike) -> Floats:
        """The nearest configurations within the limits; angles come to [-pi, pi]."""
        held = limits.clip(self, q)
        return self._core.interpolate(held, held, 0.0, None)

    def interpolate(
        self, q0: ArrayLike, q1: ArrayLike, t: ArrayLike, *, threads: int | None = None
    ) -> Floats:
        """Configurations at fractions t in [0, 1] of the way from q0 to q1, (..., nq).

        As OMPL's spaces: positions and bounded joints straight, yaw and joints without end by the
        shorter way around, orientations by the shortest arc. q0 and q1 (..., nq) and t (...)
        broadcast.
        """
        return self._core.interpolate(q0, q1, t, threads)

    def distance(self, q0: ArrayLike, q1: ArrayLike) -> Any:
        """Meters that no point of the robot exceeds on the way from q0 to q1: `weights` used."""
        return self._core.distance(q0, q1, self.weights)

    @property
    def actions(self) -> tuple[Action, ...]:
        """What the numbers of an action are, as the drive says; none without a drive."""
        return () if self.drive is None else self.drive.actions(self)

    # Poses

    @property
    def root(self) -> str:
        """Name of the link at the base."""
        return self.links[0].name

    def link_index(self, link: str | int) -> int:
        """Place of a link in `links`, by its name."""
        if isinstance(link, (int, np.integer)):
            if not 0 <= link < len(self.links):
                raise ValueError(f"link: {link}, {self.name!r} has {len(self.links)} links")
            return int(link)
        if link not in self._places:
            raise ValueError(f"link: {link!r}, {self.name!r} has {', '.join(self._places)}")
        return self._places[link]

    def forward(
        self, q: ArrayLike, link: str | int | None = None, *, threads: int | None = None
    ) -> Floats:
        """Poses in the world of all links, (..., links, 4, 4), or of one, (..., 4, 4).

        Args:
            q: (..., nq).
            link: its name or its place in `links`.
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
        """Pose and velocity of a link at fractions t of the way from q0 to q1, and bounds on it.

        At no time on the way does a point at distance d from the link's origin accelerate by more
        than at_origin + d * by_radius; the link turns by no more than `turn`.

        Args:
            link: name, or place in `links`.
            q0, q1: (..., nq); t: (...); they broadcast.
            offset: (4, 4), of a body on the link: all is then said of the body.
        """
        i = self.link_index(link)
        return LinkMotion(*self._core.link_motion(i, q0, q1, t, offset, 0.0, 1.0, threads))

    # Shapes

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """All shapes with their links."""
        return tuple(
            Part(i, placed.shape, placed.origin)
            for i, link in enumerate(self.links)
            for placed in link.shapes
        )

    @cached_property
    def allowed_parts(self) -> tuple[tuple[int, int], ...]:
        """Pairs of places in `parts` whose contact is no collision, each pair rising."""
        return allowed_collisions.allowed_parts(self)

    def contacts(self, q: ArrayLike | None = None) -> tuple[tuple[str, str], ...]:
        """Pairs of links, allowed ones apart, whose shapes touch at a configuration (nq,).

        At rest if left out. What always touches by design is told to the robot by
        `robot.allowing(robot.contacts())`.
        """
        return allowed_collisions.contacts(self, self.rest if q is None else q)

    def allowing(self, pairs: Iterable[tuple[str, str]]) -> Robot:
        """The same robot, with more pairs of links whose contact is no collision."""
        return self.replace(allowed=(*self.allowed, *pairs))

    def __repr__(self) -> str:
        shapes = sum(len(link.shapes) for link in self.links)
        return (
            f"Robot({self.name!r}: {self.base} base, {self.dof} dof, {len(self.links)} links,"
            f" {shapes} shapes)"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), tuple(getattr(self, item.name) for item in fields(self))

    def __copy__(self) -> Robot:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Robot:
        return self

    # Inside

    @cached_property
    def _places(self) -> dict[str, int]:
        return {link.name: i for i, link in enumerate(self.links)}

    @cached_property
    def carriers(self) -> dict[str, Joint]:
        """The joint that each link but the root hangs on."""
        return {joint.child: joint for joint in self.joints}

    @cached_property
    def leaders(self) -> dict[str, tuple[Joint, float, float]]:
        """For each joint that moves: whose value it takes, times what, plus what."""
        by_name = {joint.name: joint for joint in self.joints}
        return {joint.name: leader(joint, by_name) for joint in self.joints if joint.moves}

    @cached_property
    def _core(self) -> _core.Robot:
        first = {name: i for i, name in enumerate(self.coordinates)}
        if len(first) < self.nq:
            raise ValueError(f"joints: one bears the name of a coordinate of a {self.base} base")
        rows = [(KINDS[self.base], -1, self.mount, (0.0, 0.0, 1.0), 0, 1.0, 0.0)]
        for link in self.links[1:]:
            joint = self.carriers[link.name]
            which, multiplier, offset = 0, 1.0, 0.0
            if joint.moves:
                followed, multiplier, offset = self.leaders[joint.name]
                which = first[followed.name]
            code = KINDS[joint.kind]
            if joint.mimic is not None and joint.kind == "continuous":
                code = KINDS["revolute"]  # what goes round is the joint that it follows
            axis = tuple(joint.axis.tolist())
            rows.append(
                (code, self._places[joint.parent], joint.origin, axis, which, multiplier, offset)
            )
        kinds, parents, origins, axes, firsts, multipliers, offsets = map(
            list, zip(*rows, strict=True)
        )
        return _core.Robot(
            kinds, parents, origins, axes, firsts, multipliers, offsets, list(self.coordinates)
        )

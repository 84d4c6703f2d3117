"""Robot: a kinematic tree with a configuration space, a drive and allowed collisions."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape

from . import allowed_collisions
from .configuration_space import ConfigurationSpace
from .drives.base import Action, Drive
from .drives.steering import Steering
from .links_joints import Link, LinkShape, as_pose, number_of
from .mesh_location import PackagePaths
from .primitives import ERROR
from .robot_formats import ReadOptions, read_robot
from .srdf import NO_SEMANTICS, Semantics, read_srdf


@dataclass(frozen=True, eq=False, repr=False)
class Robot(ConfigurationSpace):
    """A kinematic tree: a base joint, then joints from link to link. Immutable.

    A configuration is a vector (nq,): the base's coordinates (`planar`: x, y, yaw; `free`: x, y, z,
    qx, qy, qz, qw, as OMPL's SE2 and SE3), then one for each joint with a coordinate of its own, in
    the order of `joints`. Meters, radians. All methods accept arrays of configurations, (..., nq).

    Args:
        name: name in messages.
        links: in any order; stored with parents first, the root at index 0.
        joints: each from a link to another; exactly one link, the root, has no parent joint.
        base: joint between the world and the root: `fixed`, `planar` or `free`.
        mount: (4, 4), the base's frame in the world: the root's pose with the base at 0.
        workspace: bounds of the base's position: (low, high), (2, 2) for `planar`, (2, 3) for
            `free`, meters; None: infinite.
        drive: meaning and limits of an action; None: only configurations move the robot.
        allowed: pairs of links that may touch. Adjacent links, and links that do not move relative
            to each other, are added.
        notes: sentences on what the robot's file has and the robot does not, or has otherwise.
        semantics: planning groups, named states and more, of an SRDF file.

    Raises:
        ValueError, TypeError: an invalid argument, with the value received and the one expected.
    """

    drive: Drive | None = None
    allowed: Sequence[tuple[str, str]] = ()
    notes: tuple[str, ...] = ()
    semantics: Semantics = NO_SEMANTICS

    def __post_init__(self) -> None:
        super().__post_init__()
        allowed = allowed_collisions.allowed_links(self, self.allowed)
        object.__setattr__(self, "allowed", allowed)
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
        """Create a robot of one link from a mesh file or a shape.

        Args:
            mesh: a file that `Shape.load` reads, or a Shape.
            scale: factor to meters, for a file.
            origin: (4, 4), from the mesh's frame to the robot's.
            name: None: the mesh's name.
            base, drive, mount, workspace: see `Robot`.
        """
        shape = mesh if isinstance(mesh, Shape) else Shape.load(mesh, scale=scale)
        body = Link("body", LinkShape(shape, as_pose(origin, "origin")))
        label = name or shape.name or "robot"
        place = as_pose(mount, "mount")
        return cls(label, (body,), (), base, place, workspace, drive)  # type: ignore[arg-type]

    @classmethod
    def load(
        cls,
        path: str | Path,
        base: str | None = None,
        *,
        collision: bool = True,
        package_dirs: str | Path | Iterable[str | Path] | Mapping[str, str | Path] = (),
        srdf: str | Path | None = None,
        scale: float = 1.0,
        error: float = ERROR,
        method: str = "exact",
        tolerance: float | None = None,
        soft_limits: bool = False,
        xacro_args: Mapping[str, str] | None = None,
        root: str | None = None,
        drive: Drive | None = None,
        name: str | None = None,
        mount: ArrayLike | None = None,
        workspace: ArrayLike | None = None,
    ) -> Robot:
        """Create a robot from a URDF, xacro, MJCF or SDF file.

        URDF and xacro need the extra `pip install 'fgenv[urdf]'`, MJCF `'fgenv[mjcf]'`. The format
        is that of the ending (.urdf, .xacro, .sdf), or of the root element.

        Each shape of a link stays a separate shape. A negative mesh scale mirrors. The unit of a
        COLLADA file is applied, its up axis is ignored, as in RViz. Limits over 1e5 are none. In
        URDF, a lower or upper limit that is missing is 0, the format's default, a joint without
        both is unbounded, and a speed limit of 0 means none. Faults in geometry of the other kind
        do not matter. `Robot.notes` lists what was left out.

        Args:
            path: the file.
            base: None: the file's; `fixed` for URDF.
            collision: True: use the links' collision geometry; False: their visual geometry.
            package_dirs: folders in which `package://NAME/...` is searched first: folders of
                packages, or packages, also by the name in package.xml; or a mapping of names to
                folders. Then ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and the folders above the file.
            srdf: an SRDF file: pairs of links that may touch, planning groups, named states and end
                effectors; `Robot.semantics`. What it has for links or joints that the robot does
                not have is noted.
            scale: factor of all lengths.
            error: meters by which the mesh of a round shape, which encloses it, may exceed it.
            method, tolerance: of the shapes, see `Shape`.
            soft_limits: keep to the soft limits of URDF's safety controllers as well.
            xacro_args: values of `<xacro:arg>` by name. A xacro file has expressions that are
                evaluated, and includes other files: expand those that you trust.
            root: name of the first body of the robot, in an MJCF file with several.
            name: None: the name in the file.
            mount: None: the file's, or the identity; see `Robot`.
            drive, workspace: see `Robot`.

        Raises:
            FileNotFoundError: the file, or a mesh in it, with the places searched.
            ModuleNotFoundError: the extra is not installed.
            ValueError: invalid content, with file, line or link; what is not supported; an option
                that the format does not have.
        """
        if number_of(scale, "scale", 0.0, finite=True) == 0:
            raise ValueError("scale: got 0, expected a factor over 0")
        options = ReadOptions(
            PackagePaths.of(package_dirs),
            collision,
            scale,
            error,
            {"method": method, "tolerance": tolerance},
            soft_limits,
            xacro_args or {},
            root,
        )
        file = read_robot(Path(path), options)
        if file.other_geometry and not any(link.shapes for link in file.links):
            other = "visual" if collision else "collision"
            warnings.warn(
                f"{path}: got no geometry but {other}, so that nothing collides; give"
                f" collision={not collision} to use it",
                UserWarning,
                stacklevel=2,
            )
        base, semantics = base or file.base, NO_SEMANTICS
        placed = file.mount if base == file.base else file.placement
        if srdf is not None:
            semantics = read_srdf(srdf, file.name, file.links, file.joints, base)
        return cls(
            name or file.name,
            tuple(file.links),
            tuple(file.joints),
            base,
            placed if mount is None else as_pose(mount, "mount"),
            workspace,  # type: ignore[arg-type]
            drive,
            (*file.allowed, *semantics.allowed),
            (*file.notes, *semantics.notes),
            semantics,
        )

    def replace(self, **changes: Any) -> Robot:
        """A copy with some of the arguments of `Robot` replaced."""
        return replace(self, **changes)

    @property
    def actions(self) -> tuple[Action, ...]:
        """Components of an action, as the drive defines them; () without a drive."""
        return () if self.drive is None else self.drive.actions(self)

    @property
    def required_drive(self) -> Drive:
        """The drive; ValueError without one."""
        if self.drive is None:
            raise ValueError(f"robot: got {self.name!r} without a drive, expected one; give it one")
        return self.drive

    def steering(self, method: str | None = None) -> Steering:
        """The steering function: the drive's default, or another that the drive can follow.

        Raises:
            ValueError: the drive cannot follow the method.
        """
        if self.drive is not None:
            return self.drive.steering(method)
        steering = Steering(method or "straight")
        if steering.car_like:
            raise ValueError(f"steering: got {method!r} without a drive, expected a Car")
        return steering

    def steer(self, q0: ArrayLike, q1: ArrayLike, method: str | None = None) -> Floats:
        """Waypoints (m, nq) of the steering function from q0 to q1 (nq,), with straight legs.

        Legs are chords of a car's arcs, each of at most a tenth of a radian.
        """
        s = self.steering(method)
        return _core.legs(self._core, q0, q1, way=s.code, radius=s.radius, reverse=s.reverse)

    @cached_property
    def allowed_parts(self) -> tuple[tuple[int, int], ...]:
        """Pairs of indices in `parts` that may touch, each in rising order."""
        return allowed_collisions.allowed_parts(self, tuple(self.allowed))

    def named_state(self, name: str, group: str | None = None) -> Floats:
        """The configuration (nq,) of a named state of the SRDF; other coordinates are at rest.

        Args:
            group: the planning group; None: the only one that has a state of this name.

        Raises:
            ValueError: no such state, or several groups have it.
        """
        states = self.semantics.states
        keys = [key for key in states if key[1] == name and group in (None, key[0])]
        if len(keys) != 1:
            known = ", ".join(f"{state!r} of {own!r}" for own, state in states) or "none"
            what = f"{name!r}" + ("" if group is None else f" of {group!r}")
            raise ValueError(f"state: got {what}, expected one of {self.name!r}: {known}")
        q = self.rest.copy()
        for joint, value in states[keys[0]].items():
            if joint in self.coordinates:  # others mimic a joint
                q[self.coordinates.index(joint)] = value
        return q

    def self_collisions(self, q: ArrayLike | None = None) -> tuple[tuple[str, str], ...]:
        """Pairs of links, except allowed ones, that collide at a configuration (nq,).

        Args:
            q: None: `rest`. Links that touch by design are allowed by
                `robot.with_allowed_collisions(robot.self_collisions())`.
        """
        at = self.rest if q is None else q
        return allowed_collisions.self_collisions(self, self.allowed_parts, at)

    def with_allowed_collisions(self, pairs: Iterable[tuple[str, str]]) -> Robot:
        """A copy with more pairs of links that may touch."""
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

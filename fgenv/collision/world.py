"""A world: bodies that move among each other, and who may meet whom.

Path-driven masks as in Ma Li, Wang Qiang et al. (sections 2.3 and 2.4), made sound and per mover;
motions certified by conservative advancement. README, "How it works", says why they hold.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv import _core

from .feature_graph import FeatureGraph
from .shape import Shape

Body = int | str  # a body's id or name
Bodies = Body | Sequence[Body] | NDArray[np.integer[Any]]

TOLERANCE = 1e-6  # meters


class Model(Protocol):
    """What a world asks of a robot; `fgenv.robots.Robot` is one."""

    @property
    def name(self) -> str: ...
    @property
    def links(self) -> Sequence[Any]: ...  # each with a `name`
    @property
    def parts(self) -> Sequence[Any]: ...  # each with `link` (place in `links`), `shape`, `origin`
    @property
    def allowed_parts(self) -> Sequence[tuple[int, int]]: ...  # places in `parts`
    @property
    def rest(self) -> NDArray[np.float64]: ...  # (nq,)
    @property
    def _core(self) -> _core.Robot: ...


class MotionResult(NamedTuple):
    """Of one motion, or arrays of the shape that the poses broadcast to.

    Three outcomes: proved free (`free`); contact shown (`contact_by` is finite); neither, where the
    search gave up (`unresolved`: not free, `contact_by` is NaN).
    """

    free: Any  # bool
    contact: Any  # fraction of the motion that is proved free; 1 where all of it is
    contact_by: Any  # fraction at which contact is shown; inf where free, NaN where unresolved
    other: Any  # id of the body met; -1 where free
    part: Any  # id of the robot's body that meets it; -1 where free
    checks: Any  # pairs of bodies looked at

    @property
    def unresolved(self) -> Any:
        """Not proved free, and no contact shown either."""
        return np.isnan(self.contact_by)

    def __bool__(self) -> bool:
        """Whether the motion is free, or all of them are."""
        return bool(np.all(self.free))


class RayHits(NamedTuple):
    """First hits of rays."""

    distance: NDArray[np.float64]  # (...), meters; inf: no hit
    body: NDArray[np.int32]  # (...), id; -1: no hit


class Clearances(NamedTuple):
    """Distances to the nearest body."""

    distance: NDArray[np.float64]  # (...), meters; 0 in collision, inf with nobody to meet
    body: NDArray[np.int32]  # (...), its id; -1: nobody


@dataclass(frozen=True)
class Record:
    """The published record of a body (section 2.5), and what else a world knows of it."""

    id: int
    name: str
    position: NDArray[np.float64]  # (3,), meters
    mask: int  # one bit a mover
    feature_points: NDArray[np.float64]  # (n, 3), the shape's frame, meters
    graph: FeatureGraph
    pose: NDArray[np.float64]  # (4, 4)
    shape: Shape
    groups: tuple[str, ...]
    carrier: int | None
    robot: Model | None  # of a robot's first body, with its
    configuration: NDArray[np.float64] | None  # (nq,)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner of the body's axis-aligned box in the world, (2, 3), meters."""
        points = self.shape.vertices @ self.pose[:3, :3].T + self.pose[:3, 3]
        return np.stack([points.min(axis=0), points.max(axis=0)])


class World:
    """Bodies with poses; masks, collision, clearance, motion and rays among them.

    Poses are (..., 4, 4) rigid motions from a shape's frame to the world, in meters. Wherever a
    body is asked for, its id or its name will do. A robot is a body with all that is attached to
    it, moved by poses; or a kinematic tree that `add_robot` has brought, moved by configurations:
    wherever a robot's poses are asked for, such a one takes configurations (..., nq), and its way
    between two of them is that of `Robot.interpolate`. Its parts are also tested against each
    other, allowed pairs apart. Queries may run in several threads at once; changes wait for them.

    Args:
        masks: `path` (default): only what the masks leave is tested, which hides no collision.
            `published`: the paper's masks (a body's position in the box of the path's way points,
            one bit for all), unsound, for comparison. `off`: every body is tested, for comparison.
    """

    def __init__(self, *, masks: str = "path") -> None:
        self._core = _core.World(masks)
        self._models: dict[int, Model] = {}  # of the robots, by id

    def add(
        self,
        shape: Shape,
        pose: ArrayLike | None = None,
        *,
        name: str = "",
        groups: str | Iterable[str] = (),
    ) -> int:
        """Add a body and return its id; ids are never used again.

        Args:
            shape: many bodies may share one.
            pose: (4, 4); the origin's if left out.
            name: unique in this world; `body <id>` if left out.
            groups: for `allow_groups`.
        """
        here = np.eye(4) if pose is None else pose
        return self._core.add_body(shape, here, name, groups, -1)

    def add_robot(
        self,
        model: Model,
        q: ArrayLike | None = None,
        *,
        name: str = "",
        groups: str | Iterable[str] = (),
    ) -> int:
        """Add a kinematic robot, one body for each of its shapes; return the first one's id.

        That id, or the name, stands for the robot; `parts` tells the others, which are named
        `<robot>/<link>` and can be attached to.

        Args:
            model: a `fgenv.robots.Robot`; many robots may share one.
            q: (nq,), its configuration; at rest if left out.
            name: unique in this world; the model's, with a number if that is taken, if left out.
            groups: of all its bodies.
        """
        labels = [link.name for link in model.links]
        parts = [(labels[part.link], part.link, part.shape, part.origin) for part in model.parts]
        here = model.rest if q is None else q
        robot = self._core.add_robot(
            model._core, here, parts, model.allowed_parts, name, model.name, groups
        )
        self._models[robot] = model
        return robot

    def remove(self, body: Body) -> None:
        """Remove a body, or a robot; what it carries stays where it is, for itself."""
        self._models.pop(self._core.remove(body), None)

    def __len__(self) -> int:
        return len(self._core)

    @property
    def ids(self) -> NDArray[np.int32]:
        """Ids of all bodies, rising."""
        return self._core.ids()

    @property
    def names(self) -> list[str]:
        """Names of all bodies, by rising id."""
        return self._core.names()

    def set_pose(self, ids: Bodies, poses: ArrayLike) -> None:
        """Put bodies at poses (..., 4, 4), one for all or one each; what they carry comes along."""
        self._core.set_pose(ids, poses)

    def poses(self, ids: Bodies) -> NDArray[np.float64]:
        """Poses (4, 4) of one body, (n, 4, 4) of a sequence."""
        return self._core.poses(ids)

    def set_configuration(self, robot: Body, q: ArrayLike) -> None:
        """Put a robot of `add_robot` at a configuration (nq,); what it carries comes along."""
        self._core.set_configuration(robot, q)

    def configuration(self, robot: Body) -> NDArray[np.float64]:
        """Configuration (nq,) of a robot of `add_robot`."""
        return self._core.configuration(robot)

    def parts(self, robot: Body) -> NDArray[np.int32]:
        """Ids of all that moves as one with this: itself, then links, then what they carry."""
        return self._core.parts(robot)

    def attach(self, body: Body, carrier: Body) -> None:
        """Let `carrier` carry `body` from where both are now, as a gripper does or as links do.

        They then move as one robot, and are never tested against each other; but what a link of a
        robot carries is tested against its other links: `allow` what may touch. The body's own path
        and trajectory are forgotten.
        """
        self._core.attach(body, carrier)

    def detach(self, body: Body) -> None:
        """Let a carried body stand for itself, where it is, with all that it carries."""
        self._core.detach(body)

    def allow(self, a: Body, b: Body, allowed: bool = True) -> None:
        """Contact between two bodies is no collision (or is one again)."""
        self._core.allow(a, b, allowed)

    def allow_groups(self, a: str, b: str, allowed: bool = True) -> None:
        """Contact between any body of one group and any of another is no collision."""
        self._core.allow_groups(a, b, allowed)

    def set_trajectory(self, body: Body, times: ArrayLike | None, poses: ArrayLike | None) -> None:
        """Let a body move as known ahead, for queries that are given a time.

        Args:
            times: (k,) seconds, rising; None forgets the trajectory.
            poses: (k, 4, 4) at those times; between them position linear and orientation by the
                shortest arc, outside them at rest. Of a robot configurations, (k, nq).
        """
        self._core.set_trajectory(body, times, poses)

    def set_path(self, robot: Body, poses: ArrayLike) -> NDArray[np.int32]:
        """Project a path on its motion boxes, set the masks, and return the candidates' ids.

        Each leg's box bounds the whole robot all along the leg, rotation included. The robot owns
        one bit; every body that meets a box, where it stands or along its own path or trajectory,
        bears it. Bodies that come, move or go, and other robots' paths, change the masks at once.

        Args:
            poses: (K, 4, 4) way points; between them position linear, orientation by the shortest
                arc. Of a robot configurations, (K, nq). A path set before is projected anew.
        """
        return self._core.set_path(robot, poses)

    def clear_path(self, robot: Body) -> None:
        """The motion is over: the robot's bit is taken from all masks."""
        self._core.clear_path(robot)

    def candidates(self, robot: Body) -> NDArray[np.int32]:
        """Ids of the bodies that the path's mask leaves to be tested, rising."""
        return self._core.candidates(robot)

    def motion_boxes(self, robot: Body) -> NDArray[np.float64]:
        """Motion boxes of the robot's path, (legs, 2, 3): lowest and highest corner, meters."""
        return self._core.motion_boxes(robot)

    def mask(self, body: Body) -> int:
        """The body's mask: one bit for each robot whose motion box it meets, and its own."""
        return self._core.mask(body)

    def own_bit(self, robot: Body) -> int:
        """The robot's bit, as a mask (a power of two); 0 where it has no path."""
        bit = self._core.own_bit(robot)
        return 1 << bit if bit >= 0 else 0

    def collides(
        self,
        robot: Body,
        poses: ArrayLike,
        *,
        times: ArrayLike | None = None,
        margin: float = 0.0,
        threads: int | None = None,
    ) -> Any:
        """Whether it would collide at poses (..., 4, 4) or configurations (..., nq): bool or array.

        Touching counts, containment too. Sound whatever path is set.

        Args:
            times: seconds, broadcast with the poses: where bodies are on their trajectories.
            margin: meters: nearer than this collides.
        """
        return self._core.collides(robot, poses, times, margin, threads)

    def clearance(
        self,
        robot: Body,
        poses: ArrayLike,
        *,
        times: ArrayLike | None = None,
        threads: int | None = None,
    ) -> Clearances:
        """Distance at poses (..., 4, 4) or configurations (..., nq) to the nearest other body.

        A robot's parts do not count among themselves.
        """
        return Clearances(*self._core.clearance(robot, poses, times, threads))

    def check_motion(
        self,
        robot: Body,
        T0: ArrayLike,
        T1: ArrayLike,
        *,
        margin: float = 0.0,
        tolerance: float = TOLERANCE,
        mode: str = "continuous",
        resolution: float | None = None,
        first: bool = True,
        t0: float | None = None,
        t1: float | None = None,
        threads: int | None = None,
    ) -> MotionResult:
        """Move from T0 to T1, (..., 4, 4) or (..., nq): proved free, or where it first meets one.

        Position is linear, orientation takes the shortest arc from T0's, about the robot's origin;
        a kinematic robot goes as `Robot.interpolate` says, all of its tree at once, and may meet
        itself. Nothing is tunnelled through, however thin or fast.

        Args:
            margin: meters: nearer than this is contact.
            tolerance: meters: no point of the robot moves farther from `contact` to `contact_by`.
            mode: `continuous`, or `discrete`: looked at in steps, as OMPL does; it can tunnel.
            resolution: meters: no point moves farther in a step of `discrete`.
            first: False: any contact will do, which is found sooner.
            t0, t1: seconds at T0 and T1: bodies are met where their trajectories put them. Without,
                they stand where they are.
        """
        found = self._core.check_motion(
            robot, T0, T1, margin, tolerance, mode, resolution, first, t0, t1, threads
        )
        return MotionResult(*found)

    def check_motions(
        self,
        robots: Sequence[Body] | NDArray[np.integer[Any]],
        T0: ArrayLike,
        T1: ArrayLike,
        *,
        margin: float = 0.0,
        tolerance: float = TOLERANCE,
        t0: float | None = None,
        t1: float | None = None,
    ) -> MotionResult:
        """Move robots (n,) from T0 to T1 at once, each against the others' motions too.

        T0 and T1 are (n, 4, 4), or (n, nq) for robots that all have the same coordinates.

        Every robot's result is its first contact as if all went on: nobody stops for a contact.
        """
        return MotionResult(*self._core.check_motions(robots, T0, T1, margin, tolerance, t0, t1))

    def meet(
        self,
        a: Body,
        A0: ArrayLike,
        A1: ArrayLike,
        b: Body,
        B0: ArrayLike,
        B1: ArrayLike,
        *,
        margin: float = 0.0,
        tolerance: float = TOLERANCE,
        threads: int | None = None,
    ) -> Any:
        """Whether two robots that move at once, A0 to A1 and B0 to B1, are not proved apart.

        Of these two alone, wherever they and all others are in the world: bool or array.

        Args:
            A0, A1, B0, B1: poses (..., 4, 4) or configurations (..., nq); they broadcast.
            margin, tolerance: as for `check_motion`.
        """
        return self._core.meet(a, A0, A1, b, B0, B1, margin, tolerance, threads)

    def advance(
        self,
        robots: Sequence[Body] | NDArray[np.integer[Any]],
        to: ArrayLike,
        *,
        margin: float = 0.0,
        tolerance: float = TOLERANCE,
        t0: float | None = None,
        t1: float | None = None,
    ) -> MotionResult:
        """Move robots (n,) at once from where they are, each up to where it first meets something.

        Both that meet stop there, in the order of time, and who comes later meets them where they
        stand; `contact` is the fraction of its way that each has gone. Where nobody overlapped
        before, nobody does afterwards.

        Args:
            to: (n, 4, 4), or (n, nq) for robots that all have the same coordinates.
            margin, tolerance, t0, t1: as for `check_motion`.
        """
        return MotionResult(*self._core.advance(robots, to, margin, tolerance, t0, t1))

    def contacts(self, *, margin: float = 0.0, threads: int | None = None) -> NDArray[np.int32]:
        """All pairs of bodies that collide where they are, (n, 2) ids, each pair rising."""
        return self._core.contacts(margin, threads)

    def raycast(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        max_distance: float = np.inf,
        *,
        ignore: Body | Sequence[Body] | None = None,
        threads: int | None = None,
    ) -> RayHits:
        """First hits of rays, (..., 3) each, on all bodies but those to ignore."""
        return RayHits(*self._core.raycast(origins, directions, max_distance, ignore, threads))

    def record(self, body: Body) -> Record:
        """The published record of a body."""
        found = self._core.record(body)
        shape = cast(Shape, found["shape"])
        graph = shape.graph
        return Record(
            id=found["id"],
            name=found["name"],
            position=found["pose"][:3, 3],
            mask=found["mask"],
            feature_points=graph.points,
            graph=graph,
            pose=found["pose"],
            shape=shape,
            groups=tuple(found["groups"]),
            carrier=None if found["carrier"] < 0 else found["carrier"],
            robot=self._models.get(found["id"]),
            configuration=found["configuration"],
        )

    @property
    def masks(self) -> str:
        """path, published or off."""
        return self._core.masks()

    @property
    def tests(self) -> int:
        """Pairs of bodies tested since the world was made."""
        return self._core.tests()

    @property
    def nbytes(self) -> int:
        """Bytes of the bodies and their index, without the shapes."""
        return self._core.nbytes()

    def copy(self) -> World:
        """A world of its own with the same bodies, paths and masks; shapes are shared."""
        other = World(masks=self.masks)
        other._core.copy_from(self._core)
        other._models = dict(self._models)
        return other

    def __copy__(self) -> World:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> World:
        return self.copy()

    def __getstate__(self) -> dict[str, Any]:
        state = self._core.state()
        there = {body["id"] for body in state["bodies"]}
        return state | {"models": {i: m for i, m in self._models.items() if i in there}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._core = _core.World(state["masks"])
        self._models = state["models"]
        self._core.restore(state, {i: model._core for i, model in self._models.items()})

    def __repr__(self) -> str:
        return f"World({len(self)} bodies)"

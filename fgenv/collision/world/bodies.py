"""Bodies of a world: adding, placing, carrying and filtering them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats, Ints32, Poses
from fgenv.collision.shape import Shape

from .base import Bodies, Body, Model, WorldBase
from .results import BodyRecord


class BodyMethods(WorldBase):
    """Methods of `World` that change or list its bodies."""

    def add(
        self,
        shape: Shape,
        pose: ArrayLike | None = None,
        *,
        name: str = "",
        groups: str | Iterable[str] = (),
    ) -> int:
        """Add a body and return its id. Ids are never reused.

        Args:
            shape: several bodies may share one shape.
            pose: (4, 4); default: identity.
            name: unique in this world; default: `body <id>`.
            groups: group names for `allow_groups`.
        """
        if not isinstance(shape, Shape):
            raise TypeError(f"shape: got {type(shape).__name__}, expected a Shape")
        here = np.eye(4) if pose is None else pose
        return self._core.add_body(shape, here, name, groups=groups, id=-1)

    def add_robot(
        self,
        model: Model,
        q: ArrayLike | None = None,
        *,
        name: str = "",
        groups: str | Iterable[str] = (),
    ) -> int:
        """Add a kinematic robot, one body per shape, and return the id of its first body.

        That id, or the name, refers to the robot. `parts` lists the ids of all its bodies; the
        others are named `<robot>/<link>` and can carry further bodies.

        Args:
            model: a `fgenv.robots.Robot`; several robots may share one.
            q: (nq,), configuration; default: `model.rest`.
            name: unique in this world; default: the model's name, with a number if that is taken.
            groups: group names of all its bodies.
        """
        labels = [link.name for link in model.links]
        parts = [(labels[part.link], part.link, part.shape, part.origin) for part in model.parts]
        here = model.rest if q is None else q
        robot = self._core.add_robot(
            model._core,
            here,
            parts,
            allowed=model.allowed_parts,
            name=name,
            default_name=model.name,
            groups=groups,
        )
        self._models[robot] = model
        return robot

    def remove(self, body: Body) -> None:
        """Remove a body or a robot. Bodies that it carries stay in place, detached."""
        self._models.pop(self._core.remove(body), None)

    def __len__(self) -> int:
        return len(self._core)

    @property
    def ids(self) -> Ints32:
        """Ids of all bodies, ascending."""
        return self._core.ids()

    @property
    def names(self) -> list[str]:
        """Names of all bodies, by ascending id."""
        return self._core.names()

    def body_names(self, ids: ArrayLike) -> Any:
        """Names of the bodies with these ids: str, or an object array of the shape of `ids`.

        None for -1 and for ids that are not in this world.
        """
        return self._labels(ids, 0)

    def link_names(self, ids: ArrayLike) -> Any:
        """Names of the robot links that these bodies belong to, as `body_names`.

        A carried body belongs to the link that carries it. None for bodies outside robots.
        """
        return self._labels(ids, 1)

    def _labels(self, ids: ArrayLike, column: int) -> Any:
        numbers = np.asarray(ids)
        labels = np.empty(numbers.shape, dtype=object)
        for index, (name, root, link) in zip(
            np.ndindex(numbers.shape), self._core.labels(numbers.ravel().tolist()), strict=True
        ):
            model = self._models.get(root)
            labels[index] = (name, model and model.links[link].name)[column]
        return labels[()]

    def set_pose(self, ids: Bodies, poses: ArrayLike) -> None:
        """Place bodies at poses (..., 4, 4), one for all or one each, with all that they carry."""
        self._core.set_pose(ids, poses)

    def poses(self, ids: Bodies) -> Poses:
        """Poses (4, 4) of one body, (n, 4, 4) of a sequence."""
        return self._core.poses(ids)

    def set_configuration(self, robot: Body, q: ArrayLike) -> None:
        """Set the configuration (nq,) of a kinematic robot; carried bodies move along."""
        self._core.set_configuration(robot, q)

    def configuration(self, robot: Body) -> Floats:
        """Configuration (nq,) of a kinematic robot."""
        return self._core.configuration(robot)

    def parts(self, robot: Body) -> Ints32:
        """Ids of all bodies that move with a robot: itself, its links, then carried bodies."""
        return self._core.parts(robot)

    def attach(self, body: Body, carrier: Body) -> None:
        """Attach `body` to `carrier` at their current poses, as a gripper or a link does.

        They then move as one robot and are not tested against each other. A body that a link of a
        kinematic robot carries is tested against the robot's other links, except pairs excluded by
        `allow`. The body's own path and trajectory are deleted.
        """
        self._core.attach(body, carrier)

    def detach(self, body: Body) -> None:
        """Detach a carried body at its current pose, with all that it carries."""
        self._core.detach(body)

    def allow(self, a: Body, b: Body, allowed: bool = True) -> None:
        """Exclude a pair of bodies from collision checks (or include it again)."""
        self._core.allow(a, b, allowed)

    def allow_groups(self, a: str, b: str, allowed: bool = True) -> None:
        """Exclude all pairs of a body in group `a` and one in group `b` (or include them again)."""
        self._core.allow_groups(a, b, allowed)

    def record(self, body: Body) -> BodyRecord:
        """The published record of a body."""
        found = self._core.record(body)
        shape = cast(Shape, found["shape"])
        graph = shape.graph
        return BodyRecord(
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

"""Results of queries on a world, with bodies by id and by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.arrays import Floats, Ints32
from fgenv.collision.feature_graph import FeatureGraph
from fgenv.collision.shape import Shape

from .base import Model


class NamedBodies(Protocol):
    """Protocol of a world for results: names of ids, in an array of the same shape."""

    def body_names(self, ids: ArrayLike) -> Any: ...
    def link_names(self, ids: ArrayLike) -> Any: ...


class _MotionFields(NamedTuple):
    free: Any  # bool
    free_until: Any  # fraction of the motion that is proved free; 1 if all of it is
    contact_by: Any  # fraction at which a contact is shown; inf if free, NaN if unresolved
    other: Any  # id of the body in contact; -1 if free
    part: Any  # id of the robot's body in contact; -1 if free
    checks: Any  # number of pairs of bodies tested


class MotionResult(_MotionFields):
    """Result of one motion, or arrays of the shape that the poses broadcast to.

    Three outcomes: proved free (`free`); in contact (`contact_by` is finite); undecided, if the
    search reached its bound (`unresolved`: not free, `contact_by` is NaN).
    """

    _world: NamedBodies

    @classmethod
    def of(cls, fields: tuple[Any, ...], world: NamedBodies) -> Self:
        result = cls(*fields)
        result._world = world
        return result

    @property
    def other_name(self) -> Any:
        """Name of `other`; None if free or if the body was removed since."""
        return self._world.body_names(self.other)

    @property
    def other_link(self) -> Any:
        """Link that `other` belongs to; None unless it is part of a kinematic robot."""
        return self._world.link_names(self.other)

    @property
    def part_name(self) -> Any:
        """Name of `part`; None if free or if the body was removed since."""
        return self._world.body_names(self.part)

    @property
    def part_link(self) -> Any:
        """Link that `part` belongs to; None unless it is part of a kinematic robot."""
        return self._world.link_names(self.part)

    @property
    def unresolved(self) -> Any:
        """Neither proved free nor shown to be in contact."""
        return np.isnan(self.contact_by)

    def __bool__(self) -> bool:
        """Whether the motion is free, or all of them are."""
        return bool(np.all(self.free))


class _BodyDistance(NamedTuple):
    distance: Floats  # (...), meters
    body: Ints32  # (...), id


class _NamedDistance(_BodyDistance):
    _world: NamedBodies

    @classmethod
    def of(cls, fields: tuple[Floats, Ints32], world: NamedBodies) -> Self:
        result = cls(*fields)
        result._world = world
        return result

    @property
    def body_name(self) -> Any:
        """Names of `body`; None for -1 and for bodies that were removed since."""
        return self._world.body_names(self.body)


class RayHits(_NamedDistance):
    """First hits of rays: `distance` is inf and `body` -1 without a hit."""


class Clearances(_NamedDistance):
    """Distances to the nearest body: 0 in collision; inf and `body` -1 without any other body."""


@dataclass(frozen=True)
class BodyRecord:
    """The published record of a body (section 2.5), with the rest of its state."""

    id: int
    name: str
    position: Floats  # (3,), meters
    mask: int  # one bit per robot with a path
    feature_points: Floats  # (n, 3), the shape's frame, meters
    graph: FeatureGraph
    pose: Floats  # (4, 4)
    shape: Shape
    groups: tuple[str, ...]
    carrier: int | None
    robot: Model | None  # of a robot's first body, with its
    configuration: NDArray[np.float64] | None  # (nq,)

    @property
    def bounds(self) -> Floats:
        """Lowest and highest corner of the body's axis-aligned box in the world, (2, 3), meters."""
        points = self.shape.vertices @ self.pose[:3, :3].T + self.pose[:3, 3]
        return np.stack([points.min(axis=0), points.max(axis=0)])

"""Links with shapes, and joints between them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.collision.feature_graph import is_number

JOINT_KINDS = ("fixed", "revolute", "continuous", "prismatic")
MAX_VALUE = 1e5  # radians or meters: bound of the magnitude of a joint's coordinate


def as_pose(value: ArrayLike | None, name: str) -> Floats:
    """A rigid transform (4, 4), read-only; the identity for None.

    Raises:
        ValueError: the value is no rigid transform.
    """
    pose = np.array(np.eye(4) if value is None else value, dtype=np.float64)
    if pose.shape != (4, 4):
        raise ValueError(f"{name}: got shape {pose.shape}, expected a pose (4, 4)")
    if not np.isfinite(pose).all():
        raise ValueError(f"{name}: got numbers that are not finite, expected a pose")
    turn = pose[:3, :3]
    rigid = (pose[3] == (0, 0, 0, 1)).all() and np.linalg.det(turn) > 0
    if not rigid or np.abs(turn.T @ turn - np.eye(3)).max() > 1e-5:
        raise ValueError(f"{name}: got no rigid transform, expected a rotation and a translation")
    return locked(pose)


def locked(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """Make an array read-only, and return it."""
    array.setflags(write=False)
    return array


def name_of(value: object, what: str) -> str:
    """Check that a value is a string that is not empty."""
    if not isinstance(value, str) or not value:
        raise ValueError(f"{what}: got {value!r}, expected a name")
    return value


def number_of(value: Any, name: str, low: float = -math.inf, finite: bool = False) -> float:
    """Check that a value is a number, not NaN and not below `low`."""
    if not is_number(value) or math.isnan(value) or value < low or (finite and math.isinf(value)):
        least = "" if low == -math.inf else f", {low:g} or more"
        raise ValueError(
            f"{name}: got {value!r}, expected a {'finite ' if finite else ''}number{least}"
        )
    return float(value)


@dataclass(frozen=True, eq=False)
class LinkShape:
    """A shape on a link.

    Attributes:
        shape: the mesh.
        origin: (4, 4), from the shape's frame to the link's, meters.
        excess: upper bound of the distance from a cylinder or sphere to its enclosing mesh, meters;
            0 for other shapes.
    """

    shape: Shape
    origin: Floats = field(default_factory=lambda: np.eye(4))
    excess: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.shape, Shape):
            raise TypeError(f"shape: got {type(self.shape).__name__}, expected a Shape")
        object.__setattr__(self, "origin", as_pose(self.origin, "origin"))


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid part of a robot.

    Attributes:
        name: unique in the robot.
        shapes: any number; each stays a separate shape. A lone Shape is placed at the link's frame.
    """

    name: str
    shapes: tuple[LinkShape, ...] = ()

    def __init__(
        self, name: str, shapes: Shape | LinkShape | Iterable[Shape | LinkShape] = ()
    ) -> None:
        object.__setattr__(self, "name", name_of(name, "link"))
        given = (shapes,) if isinstance(shapes, (Shape, LinkShape)) else tuple(shapes)
        placed = tuple(s if isinstance(s, LinkShape) else LinkShape(s) for s in given)
        object.__setattr__(self, "shapes", placed)

    def __repr__(self) -> str:
        return f"Link({self.name!r}, {len(self.shapes)} shapes)"


@dataclass(frozen=True)
class Mimic:
    """Coordinate of a joint as a function of another: multiplier * coordinate of `joint` + offset.

    The limits of both joints hold. A joint that mimics a continuous one has none of its own.
    """

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0

    def __post_init__(self) -> None:
        name_of(self.joint, "mimic")
        for what in ("multiplier", "offset"):
            value = number_of(getattr(self, what), f"mimic of {self.joint!r}: {what}", finite=True)
            if abs(value) > MAX_VALUE:
                raise ValueError(
                    f"mimic of {self.joint!r}: {what}: got {value:g}, expected at most"
                    f" {MAX_VALUE:g}"
                )


@dataclass(frozen=True, eq=False)
class Joint:
    """Connection of a link to its parent.

    Attributes:
        name: unique in the robot.
        kind: `fixed`, `revolute` (with limits), `continuous` (unbounded angle) or `prismatic`.
        parent, child: names of links.
        origin: (4, 4), the joint's frame in the parent's, meters: the child's frame at 0.
        axis: (3,), of any length but 0, in the joint's frame.
        lower, upper: limits of the coordinate, radians or meters; infinite: none. A `continuous`
            joint has none.
        velocity, acceleration: limits of speed and acceleration, per second and per second squared.
        mimic: the joint follows another one and has no coordinate of its own.
    """

    name: str
    kind: str
    parent: str
    child: str
    origin: Floats = field(default_factory=lambda: np.eye(4))
    axis: NDArray[np.float64] = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    lower: float = -math.inf
    upper: float = math.inf
    velocity: float = math.inf
    acceleration: float = math.inf
    mimic: Mimic | None = None

    def __post_init__(self) -> None:
        label = f"joint {name_of(self.name, 'joint')!r}"
        if self.kind not in JOINT_KINDS:
            raise ValueError(
                f"{label}: kind: got {self.kind!r}, expected one of {', '.join(JOINT_KINDS)}"
            )
        name_of(self.parent, f"{label}: parent")
        name_of(self.child, f"{label}: child")
        object.__setattr__(self, "origin", as_pose(self.origin, f"{label}: origin"))
        axis = np.array(self.axis, dtype=np.float64)
        if axis.shape != (3,) or not np.isfinite(axis).all() or (self.moves and not axis.any()):
            raise ValueError(f"{label}: axis: got {self.axis}, expected three numbers, not all 0")
        object.__setattr__(self, "axis", locked(axis))
        for what in ("lower", "upper"):
            number_of(getattr(self, what), f"{label}: {what}")
        for what in ("velocity", "acceleration"):
            number_of(getattr(self, what), f"{label}: {what}", 0.0)
        if self.lower > self.upper:
            raise ValueError(
                f"{label}: got lower {self.lower:g} over upper {self.upper:g}, expected no more"
            )
        if self.mimic is not None and not self.moves:
            raise ValueError(
                f"{label}: got mimic of {self.mimic.joint!r} for a fixed joint, expected None"
            )

    @property
    def moves(self) -> bool:
        """Whether the joint is not fixed."""
        return self.kind != "fixed"

    def __repr__(self) -> str:
        return f"Joint({self.name!r}, {self.kind}, {self.parent!r} -> {self.child!r})"

"""Drive: the meaning of a robot's actions, its limits, and its forward and inverse models."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import fields
from typing import ClassVar, NamedTuple

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats

from ..configuration_space import ConfigurationSpace
from ..links_joints import number_of
from .steering import Steering

INF = math.inf
ZERO = 1e-12  # meters or radians: smaller changes count as none
LIMIT_SLACK = 1e-6  # of a limit, for rounding
DIRECTION_TOLERANCE = 1e-6  # of velocities before and after a waypoint that is passed


class Quantity(NamedTuple):
    """Annotation of a drive's field: unit and description, for the schema of scenario files."""

    unit: str
    about: str


class Action(NamedTuple):
    """One component of an action, or another quantity that a drive limits."""

    name: str
    unit: str
    low: float
    high: float
    rate: float = INF  # limit of its change per second, in both directions

    @classmethod
    def symmetric(cls, name: str, unit: str, limit: float, rate: float = INF) -> Action:
        """A component between -limit and limit."""
        return cls(name, unit, -limit, limit, rate)


class LegLimit(NamedTuple):
    """A quantity that changes along a leg of a path, with its limits."""

    change: float  # meters or radians, 0 or more
    speed: float  # per second
    acceleration: float  # per second^2


class Drive(ABC):
    """Base class of drives: one part, or a part that moves the base and one that moves joints.

    Attributes:
        kind: name in scenario files; registers the class in `DRIVES`.
    """

    kind: ClassVar[str]

    def __init_subclass__(cls) -> None:
        if "kind" in cls.__dict__:
            DRIVES[cls.kind] = cls

    def __post_init__(self) -> None:
        """Check that limits are numbers over 0; those that default to infinity may be infinite."""
        for item in fields(self):  # type: ignore[arg-type]
            value = getattr(self, item.name)
            if value is None and item.default is None:
                continue
            name = f"{type(self).__name__}: {item.name}"
            if number_of(value, name, 0.0, finite=item.default != INF) == 0:
                raise ValueError(f"{name}: got 0, expected a limit over 0")

    @property
    @abstractmethod
    def parts(self) -> tuple[DrivePart, ...]:
        """The part that moves the base, then the part that moves the joints, if present."""

    @property
    def base_drive(self) -> DrivePart:
        """The part that moves the base, or the only part if none does."""
        return self.parts[0]

    def check(self, robot: ConfigurationSpace) -> None:
        """Raise ValueError if the drive does not fit the robot."""
        for part in self.parts:
            part.check_part(robot)

    def actions(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Components of an action, in order: the base's, then the joints'."""
        return tuple(action for part in self.parts for action in part.part_actions(robot))

    def limits(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Quantities that the drive limits, with their rates; see `limited_values`."""
        return tuple(limit for part in self.parts for limit in part.part_limits(robot))

    def limited_values(self, robot: ConfigurationSpace, actions: Floats) -> Floats:
        """Values of `limits` for actions (..., size): (..., limits)."""
        values = [part.part_values(a) for part, a in self._split(robot, actions)]
        return np.concatenate(values, axis=-1)

    def native(self, robot: ConfigurationSpace) -> _core.Drive:
        """The drive of a robot in the native core."""
        own = self.base_drive
        limits = np.array([(a.low, a.high, a.rate) for a in self.actions(robot)]).reshape(-1, 3)
        bounds = {"lower": robot.lower.tolist(), "upper": robot.upper.tolist()}
        return _core.Drive(own.native_kind, list(own.native_parameters()), limits, **bounds)

    def forward(self, robot: ConfigurationSpace, q: Floats, actions: Floats, dt: float) -> Floats:
        """Configurations after dt seconds from q (..., nq): the forward model.

        The base moves on the arc of a velocity that is constant in its frame; coordinates stop at
        their limits.

        Args:
            robot: the robot.
            q: configurations (..., nq).
            actions: in their own units, (..., size).
            dt: seconds.
        """
        return self.native(robot).forward(robot._core, actions, q, dt)

    def limited(
        self, robot: ConfigurationSpace, commands: Floats, before: Floats, dt: float
    ) -> Floats:
        """Actions in force, in their own units, for commands in [-1, 1]: (..., size).

        Args:
            robot: the robot.
            commands: (..., size), from -1 to 1 of the limits of `actions`.
            before: actions of the step before, in their own units, of the same shape.
            dt: seconds.
        """
        return self.native(robot).limit(commands, before, dt)

    def limit_violations(
        self, robot: ConfigurationSpace, actions: Floats, before: Floats, dt: float, slack: float
    ) -> tuple[Flags, Flags]:
        """Flags of `limits` that actions (..., size) exceed, by value and by rate: (..., limits).

        Args:
            robot: the robot.
            actions: in their own units.
            before: actions of the step before, of the same shape.
            dt: seconds.
            slack: tolerance, as a fraction of a limit.
        """
        limits = self.limits(robot)
        low, high, rate = (
            np.array([getattr(x, k) for x in limits]) for k in ("low", "high", "rate")
        )
        values = self.limited_values(robot, actions)
        change = np.abs(values - self.limited_values(robot, before))
        outside = (values < low - slack * np.abs(low)) | (values > high + slack * np.abs(high))
        return outside, change > rate * dt * (1 + slack) + 1e-9

    def inverse(
        self, robot: ConfigurationSpace, q0: Floats, q1: Floats, dt: float
    ) -> tuple[Floats, Floats]:
        """Actions that move the robot from q0 to q1 (..., nq) in dt seconds: the inverse model.

        Returns:
            Actions in their own units (..., size), not clipped to the limits, and the speed of the
            motion that the drive cannot execute (...), m/s or rad/s: a differential drive or a car
            does not move sideways, a car does not turn in place, a drone does not tilt.
        """
        q0, q1 = np.asarray(q0, dtype=np.float64), np.asarray(q1, dtype=np.float64)
        change = robot.difference(q0, q1)
        results = [part.part_inverse(robot, q0, change, dt) for part in self.parts]
        residual = sum((r for _, r in results), np.zeros(change.shape[:-1]))
        for undriven in self._undriven(robot, change):
            residual = residual + np.abs(undriven).sum(axis=-1) / dt
        return np.concatenate([actions for actions, _ in results], axis=-1), residual

    def normalized(self, robot: ConfigurationSpace, actions: Floats) -> Floats:
        """Actions (..., size) in their own units, as clipped numbers in [-1, 1]."""
        return normalized(self.actions(robot), actions)

    def steering(self, method: str | None = None) -> Steering:
        """The steering function of the drive.

        Args:
            method: one of `steering_methods`; None: the default.

        Raises:
            ValueError: the drive cannot follow the method.
        """
        own = self.base_drive
        if method is not None and method not in own.steering_methods:
            raise ValueError(
                f"steering: got {method!r} for a {type(own).__name__}, expected one of"
                f" {', '.join(own.steering_methods)}"
            )
        return Steering(method or own.steering_methods[0], own.steering_radius())

    def leg_limits(
        self, robot: ConfigurationSpace, q0: Floats, q1: Floats, dt: float
    ) -> list[LegLimit]:
        """Quantities that change on a straight leg from q0 to q1 (nq,), with their limits.

        Raises:
            ValueError: the drive cannot move along the leg.
        """
        change = robot.difference(q0, q1)
        if any((np.abs(undriven) > ZERO).any() for undriven in self._undriven(robot, change)):
            raise ValueError(
                f"{robot.name!r}: got start and goal that differ in coordinates that the drive does"
                " not move, expected equal ones; give the robot another drive"
            )
        limits = [x for part in self.parts for x in part.part_leg_limits(robot, q0, change, dt)]
        return [limit for limit in limits if limit.change > ZERO]

    def passes_waypoint(self, before: Floats, after: Floats) -> bool:
        """Whether the robot may pass a waypoint without a stop.

        Args:
            before, after: velocities (dof,) on the two legs that meet there.
        """
        return self.base_drive.passes_waypoint(before, after)

    def waypoint_toward(
        self, robot: ConfigurationSpace, q: Floats, target: Floats, seconds: float
    ) -> Floats:
        """Waypoint actions in [-1, 1] straight toward targets, within the reach at full speed.

        Args:
            robot: the robot.
            q, target: configurations (n, nq).
            seconds: time at full speed to the farthest waypoint.
        """
        parts = [part.part_waypoint(robot, q, target, seconds) for part in self.parts]
        return np.concatenate(parts, axis=1)

    def tracking_waypoint(
        self, robot: ConfigurationSpace, q: Floats, target: Floats, dt: float, seconds: float
    ) -> tuple[Floats, Flags]:
        """Waypoint actions that move the robot from q to target (n, nq) in one step.

        A robot drives to a waypoint as if to stop there. A waypoint that is farther by the stopping
        distance keeps it at its speed.

        Returns:
            Actions (n, numbers) in [-1, 1], and whether they track: a drive that cannot move
            sideways does not back up to a waypoint.
        """
        actions = self.inverse(robot, q, target, dt)[0]
        tracked = np.ones(len(actions), dtype=bool)
        waypoints = []
        for part, own in self._split(robot, actions):
            numbers, ok = part.part_tracking_waypoint(robot, own, dt, seconds)
            waypoints.append(numbers)
            tracked &= ok
        return np.clip(np.concatenate(waypoints, axis=1), -1.0, 1.0), tracked

    def tracking_action(
        self, robot: ConfigurationSpace, q: Floats, target: Floats, dt: float
    ) -> Floats:
        """Actions (..., size) in [-1, 1] that move the robot from q to target (..., nq)."""
        return self.normalized(robot, self.inverse(robot, q, target, dt)[0])

    def reaches(
        self, robot: ConfigurationSpace, q: Floats, target: Floats, before: Floats, dt: float
    ) -> bool:
        """Whether the robot gets from q to target (nq,) in a step within its limits.

        Args:
            robot: the robot.
            q, target: configurations (nq,).
            before: action of the step before, in its own units, (size,) or longer.
            dt: seconds.
        """
        actions = self.inverse(robot, q, target, dt)[0]
        before = before[: len(actions)]
        too_fast, too_sudden = self.limit_violations(robot, actions, before, dt, LIMIT_SLACK)
        return not (too_fast.any() or too_sudden.any())

    def _undriven(self, robot: ConfigurationSpace, change: Floats) -> list[Floats]:
        """Changes (..., dof) of coordinates that no part moves."""
        n = robot.dof - len(robot.moving_joints)
        moves_base = any(part.base is not None for part in self.parts)
        moves_joints = any(part.base is None for part in self.parts)
        return [
            *([] if moves_base else [change[..., :n]]),
            *([] if moves_joints else [change[..., n:]]),
        ]

    def _split(self, robot: ConfigurationSpace, actions: Floats) -> list[tuple[DrivePart, Floats]]:
        """Each part with its columns of actions (..., size)."""
        ends = np.cumsum([len(part.part_actions(robot)) for part in self.parts])[:-1]
        return list(zip(self.parts, np.split(actions, ends, axis=-1), strict=True))


class DrivePart(Drive):
    """A drive that moves either a base or joints.

    Attributes:
        base: joint of the base that the drive moves, `planar` or `free`; None: it moves joints.
        native_kind: name of the native kernel; "none": the base does not move.
        steering_methods: methods of `Steering` that the drive can follow, the default first.
        moves_sideways: whether the base can move in any direction at any heading.
        level: whether a free base turns about its vertical axis alone.
        tracking_error: deviation from a plan that the drive tracks as planned, meters.
        recovery_error: deviation up to which a delayed robot counts as on its plan, meters.
    """

    base: ClassVar[str | None] = None
    native_kind: ClassVar[str] = "none"
    steering_methods: ClassVar[tuple[str, ...]] = ("straight", "turn_drive_turn")
    moves_sideways: ClassVar[bool] = False
    level: ClassVar[bool] = False
    tracking_error: ClassVar[float] = 5e-4
    recovery_error: ClassVar[float] = 5e-4

    @property
    def parts(self) -> tuple[DrivePart, ...]:
        """The drive itself."""
        return (self,)

    def passes_waypoint(self, before: Floats, after: Floats) -> bool:
        """Whether the velocities have one direction and magnitude."""
        return continues(before, after)

    def native_parameters(self) -> tuple[float, ...]:
        """Parameters of the native kernel, in its order."""
        return ()

    @abstractmethod
    def check_part(self, robot: ConfigurationSpace) -> None:
        """Raise ValueError if the part does not fit the robot."""

    @abstractmethod
    def part_actions(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Components of the part's action, in order."""

    def part_limits(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Quantities that the part limits: the components of its action."""
        return self.part_actions(robot)

    def part_values(self, actions: Floats) -> Floats:
        """Values of `part_limits` for the part's actions (..., size)."""
        return actions

    @abstractmethod
    def part_inverse(
        self, robot: ConfigurationSpace, q: Floats, change: Floats, dt: float
    ) -> tuple[Floats, Floats]:
        """The part's actions (..., size) for a change (..., dof) at q, and the rest (...)."""

    @abstractmethod
    def part_leg_limits(
        self, robot: ConfigurationSpace, q: Floats, change: Floats, dt: float
    ) -> list[LegLimit]:
        """Limits on a leg that begins at q (nq,) and changes it by (dof,)."""

    @abstractmethod
    def part_waypoint(
        self, robot: ConfigurationSpace, q: Floats, target: Floats, seconds: float
    ) -> Floats:
        """The part's numbers of `waypoint_toward`."""

    @abstractmethod
    def part_tracking_waypoint(
        self, robot: ConfigurationSpace, actions: Floats, dt: float, seconds: float
    ) -> tuple[Floats, Flags]:
        """The part's numbers of `tracking_waypoint` for its actions (n, size)."""

    def max_speed(self, robot: ConfigurationSpace) -> float:
        """Upper bound of the speed of the base's origin, m/s."""
        return 0.0

    def steering_radius(self) -> float:
        """Turning radius of the steering function, meters."""
        return 1.0

    def track_velocity(
        self, robot: ConfigurationSpace, yaw: Floats, velocity: Floats, dt: float
    ) -> Floats:
        """Actions of the base, in [-1, 1], that track velocities of the world: (n, size).

        Args:
            robot: one with a planar base.
            yaw: headings (n,), rad.
            velocity: (n, 2), m/s.
            dt: seconds.
        """
        return np.empty((len(yaw), 0))


DRIVES: dict[str, type[Drive]] = {}


def normalized(limits: tuple[Action, ...], actions: Floats) -> Floats:
    """Actions (..., size) in their own units, as clipped numbers in [-1, 1] of their limits."""
    middle = np.array([0.5 * (a.low + a.high) for a in limits])
    half = np.array([0.5 * (a.high - a.low) for a in limits])
    return np.asarray(np.clip((actions - middle) / half, -1.0, 1.0))


def continues(before: Floats, after: Floats) -> bool:
    """Whether a motion continues straight on, from velocities (dof,) before and after."""
    total = float(np.linalg.norm(before) + np.linalg.norm(after))
    return float(np.linalg.norm(before - after)) <= DIRECTION_TOLERANCE * total

"""Timed paths: where robots are at each step, within their limits of speed and acceleration.

In a step every robot goes straight from one configuration to the next, which is what `env.step`
does and what is proved. Way points are passed exactly where accelerations are not limited, and
come to rest at where they are. Ruckig (L. Berscheid and T. Kroeger, "Jerk-limited real-time
trajectory generation with arbitrary target states", 2021) gives the profile along each stretch: it
works offline, in closed form, ends on whole steps, and never leaves a straight line; TOPP-RA wants
a spline through the way points, which leaves the polyline that was proved.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots import (
    Car,
    DifferentialDrive,
    Drive,
    Drone,
    Holonomic,
    JointVelocity,
    MobileManipulator,
    Robot,
)
from fgenv.robots.inverse_drive import changes

from .errors import PlanningError
from .steering import platform

SPEED = 1.0  # m/s of the fastest point of a robot that has no drive
BEND = 1e-6  # directions that differ less go on straight
LEAST = 1e-12  # a change that is none
ALIKE = 0.01  # of a car's speed: chords of one arc differ by less
CORNER = 2e-3  # of a car's speed: what steps across its chords' corners are off by
TILT = 1e-5  # radians


@dataclass(frozen=True)
class Amount:
    """One thing that a leg changes, and its limits: meters or radians, per second, per second^2."""

    change: float
    speed: float
    acceleration: float


def steps_of(robot: Robot, path: Floats, dt: float) -> Floats:
    """Configurations at each step of dt seconds along a path (m, nq), rest to rest: (k + 1, nq)."""
    return steps_together((robot,), (path,), dt)[0]


def steps_together(robots: Sequence[Robot], paths: Sequence[Floats], dt: float) -> list[Floats]:
    """The same of robots that are at way point i at the same time, (k + 1, nq) each.

    Args:
        robots: whose limits hold.
        paths: (m, nq) each, equally long.
        dt: seconds.
    """
    durations, rates, stretches = [], [], [0]
    before: list[Floats] = []
    for k in range(len(paths[0]) - 1):
        ends = [(path[k], path[k + 1]) for path in paths]
        amounts = [
            a for robot, leg in zip(robots, ends, strict=True) for a in amounts_of(robot, *leg, dt)
        ]
        duration = seconds(amounts)
        durations.append(duration)
        hardest = min((a.acceleration / a.change for a in amounts), default=math.inf)
        rates.append(hardest * duration if duration > 0 else math.inf)
        after = [
            changes(robot, *leg) / max(duration, LEAST)
            for robot, leg in zip(robots, ends, strict=True)
        ]
        if k and not all(map(_goes_on, robots, before, after)):
            stretches.append(k)
        before = after
    stretches.append(len(durations))
    places = [np.zeros(1)]
    for first, last in pairwise(stretches):
        places.append(
            _profile(durations[first:last], min(rates[first:last], default=math.inf), first, dt)
        )
    at = np.concatenate(places)
    return [_along(robot, path, at) for robot, path in zip(robots, paths, strict=True)]


def _profile(durations: list[float], acceleration: float, first: int, dt: float) -> Floats:
    """Places along a stretch at each step after its beginning: number of the leg plus fraction."""
    ends = np.concatenate([[0.0], np.cumsum(durations)])
    if ends[-1] < LEAST:
        return np.array([first + float(len(durations))]) if ends[-1] > 0 else np.empty(0)
    way = _ruckig(ends[-1], acceleration, dt)
    legs = np.interp(way, ends, np.arange(len(ends), dtype=float))
    legs[-1] = len(durations)
    places: Floats = first + legs
    return places


def _ruckig(length: float, acceleration: float, dt: float) -> Floats:
    """From rest to rest at a speed of 1 at most, in whole steps: where it is after each."""
    solver, expected, trajectory = _solver(dt)
    expected.target_position = [length]
    expected.max_velocity = [1.0]
    expected.max_acceleration = [acceleration]
    solver.calculate(expected, trajectory)
    steps = max(1, round(trajectory.duration / dt))
    return np.array([trajectory.at_time(k * dt)[0][0] for k in range(1, steps + 1)])


@cache
def _solver(dt: float):  # type: ignore[no-untyped-def]
    import ruckig

    expected = ruckig.InputParameter(1)
    expected.current_position = expected.current_velocity = expected.current_acceleration = [0.0]
    expected.target_velocity = expected.target_acceleration = [0.0]
    expected.duration_discretization = ruckig.DurationDiscretization.Discrete
    return ruckig.Ruckig(1, dt), expected, ruckig.Trajectory(1)


def _along(robot: Robot, path: Floats, at: Floats) -> Floats:
    """Configurations at places along a path: number of the leg plus fraction."""
    if len(path) == 1:
        return np.repeat(path, len(at), axis=0)
    leg = np.minimum(at.astype(int), len(path) - 2)
    return robot.interpolate(path[leg], path[leg + 1], np.clip(at - leg, 0.0, 1.0))


def _goes_on(robot: Robot, before: Floats, after: Floats) -> bool:
    """Whether it may pass a way point without a stop, by its velocities (dof,) on either side.

    A car's chords follow an arc: they may differ in direction, up to where it turns back.
    """
    if isinstance(platform(robot.drive), Car):
        a, b = float(np.hypot(*before[:2])), float(np.hypot(*after[:2]))
        if before[:2] @ after[:2] < 0 or abs(a - b) > ALIKE * max(a, b):
            return False
        before, after = before[3:], after[3:]
    most = float(np.linalg.norm(before) + np.linalg.norm(after))
    return float(np.linalg.norm(before - after)) <= BEND * most


def seconds(amounts: Sequence[Amount]) -> float:
    """That a leg takes at full speed."""
    return max((a.change / a.speed for a in amounts), default=0.0)


def amounts_of(robot: Robot, a: Floats, b: Floats, dt: float) -> list[Amount]:
    """What changes on a leg, with its limits."""
    if robot.drive is None:
        far = float(robot.distance(a, b))
        return [Amount(far, SPEED, math.inf)] if far > LEAST else []
    change = changes(robot, a, b)
    n = len(robot.moving_joints)
    base, joints = change[: len(change) - n], change[len(change) - n :]
    own = platform(robot.drive)
    drives_joints = isinstance(robot.drive, (JointVelocity, MobileManipulator))
    for moves, driven, what in (
        (base, own is not None and own.base is not None, "base"),
        (joints, drives_joints, "joints"),
    ):
        if not driven and (np.abs(moves) > LEAST).any():
            raise PlanningError(
                f"{robot.name!r}: its drive does not move its {what}; give it another, or let start"
                " and goal have the same"
            )
    found = []
    if own is not None and own.base is not None:
        found += _of_base(robot.name, own, base, float(a[2]), dt)
    if drives_joints:
        found += [
            Amount(abs(by), action.high, action.rate)
            for by, action in zip(joints.tolist(), robot.actions[-n:], strict=True)
        ]
    return [amount for amount in found if amount.change > LEAST]


def _of_base(name: str, drive: Drive, change: Floats, yaw: float, dt: float) -> list[Amount]:
    """What changes of a base. Of speeds a little is kept back where it turns on its way: a step's
    arc is longer than its chord."""
    flat = float(np.hypot(change[0], change[1]))
    if isinstance(drive, Drone):
        if (np.abs(change[3:5]) > TILT).any():
            raise PlanningError(f"{name!r}: start or goal is tilted, a drone stays level")
        turn = abs(float(change[5]))
        room = _arc(drive.turn_rate * dt) if turn > LEAST else 1.0
        climb = drive.speed if drive.climb is None else drive.climb
        return [
            _turning(flat, turn, room * drive.speed, drive.acceleration),
            Amount(abs(float(change[2])), climb, drive.acceleration),
            Amount(turn, drive.turn_rate, drive.turn_acceleration),
        ]
    turn = abs(float(change[2]))
    if isinstance(drive, Holonomic):
        room = _arc(drive.turn_rate * dt) if turn > LEAST else 1.0
        return [
            _turning(flat, turn, room * drive.speed, drive.acceleration),
            Amount(turn, drive.turn_rate, drive.turn_acceleration),
        ]
    if isinstance(drive, (DifferentialDrive, Car)):
        ahead = change[0] * math.cos(yaw) + change[1] * math.sin(yaw)
        back = drive.speed if drive.reverse is None else drive.reverse
        speed = drive.speed if ahead >= 0 else back
        if isinstance(drive, Car):
            speed *= 1 - CORNER
            if not math.isinf(drive.acceleration):
                speed = min(speed, drive.acceleration * dt / (4 * CORNER))
            return [Amount(flat, speed, drive.acceleration / 2)]
        return [
            Amount(flat, speed, drive.acceleration),
            Amount(turn, drive.turn_rate, drive.turn_acceleration),
        ]
    return []


def _turning(flat: float, turn: float, speed: float, acceleration: float) -> Amount:
    """A way in the plane, while turning: seen from the body a steady velocity turns, which is an
    acceleration too. Half of the limit is for that."""
    if turn <= LEAST or flat <= LEAST or math.isinf(acceleration):
        return Amount(flat, speed, acceleration)
    return Amount(flat, min(speed, math.sqrt(flat * acceleration / (2 * turn))), acceleration / 2)


def _arc(turn: float) -> float:
    """A chord's length by its arc's."""
    half = min(turn / 2, 1.5)
    return math.sin(half) / half if half > 0 else 1.0

"""Gymnasium spaces of a simulator: observations, actions, and the state of a world.

Bounds follow from the scenario: the workspace, the limits of drives and joints, the lidar's range.
Unknown bounds are infinite.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import ArrayLike, NDArray

from fgenv.arrays import Floats

from .native_config import lidar_of
from .observations import Part
from .state_readers import MOVING

if TYPE_CHECKING:
    from .simulator import Simulator

Bounds = tuple[Floats, Floats]

SLACK = 1e-5  # added to bounds, for single precision and the length of quaternions


def action_box(simulator: Simulator, robot: int) -> Box:
    """Return the space of a robot's actions, [-1, 1], (size,)."""
    return Box(-1.0, 1.0, (simulator.action_sizes[robot],), np.float32)


def observation_box(simulator: Simulator, robot: int) -> Box:
    """Return the space of a robot's observations, (size,)."""
    return box([bounds(simulator, robot, part) for part in simulator.layouts[robot]])


def state_box(simulator: Simulator) -> Box:
    """Return the space of `state_of`, (size,)."""
    parts = [(np.zeros(1), np.ones(1))]
    for i in range(simulator.n_robots):
        within = limits(simulator, i)
        parts += [within, within, speeds(simulator, i), (np.zeros(1), np.ones(1))]
    return box(parts)


def state_of(simulator: Simulator, world: int = 0) -> NDArray[np.float32]:
    """Return the state of a world, (size,): the elapsed share of the horizon; then of each robot
    configuration, goal, velocity, and 1 if it is moving, else 0."""
    q, goals, v = (
        x[world] for x in (simulator.configurations, simulator.goals, simulator.velocities)
    )
    moving = simulator.status[world] == MOVING
    parts: list[ArrayLike] = [[simulator.steps[world] / simulator.horizon]]
    for i, robot in enumerate(simulator.robots):
        n = robot.nq
        parts += [q[i, :n], goals[i, :n], v[i, : len(robot.actions)], [float(moving[i])]]
    return np.concatenate(parts).astype(np.float32)


def box(parts: list[Bounds]) -> Box:
    """Return the space with these bounds in sequence, rounded outward."""
    low, high = (np.concatenate([part[side] for part in parts]) for side in (0, 1))
    slack = SLACK * np.maximum(1.0, np.maximum(finite(low), finite(high)))
    low, high = np.where(low == 0, low, low - slack), high + slack
    return Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)


def finite(x: Floats) -> Floats:
    """Return magnitudes; 0 for infinite numbers."""
    return np.where(np.isfinite(x), np.abs(x), 0.0)


def bounds(simulator: Simulator, i: int, part: Part) -> Bounds:
    """Return bounds of a part of robot i's observations."""
    size = part.slice.stop - part.slice.start
    if part.name == "lidar":
        model = simulator.scenario.robots[i].model
        lidar = lidar_of(simulator.scenario.models[model].lidar, simulator.observation)
        assert lidar is not None
        return np.zeros(size), np.full(size, lidar.range)
    if part.name == "velocity":
        return speeds(simulator, i)
    if part.name == "configuration":
        return limits(simulator, i)
    high = (
        max_neighbors(simulator, i, size)
        if part.name == "neighbors"
        else max_offsets(simulator, i, part)
    )
    low = -high
    if part.name == "neighbors":
        one = simulator.observation.neighbor_size(flat(simulator))
        low[6 if flat(simulator) else 10 :: one] = 0.0  # radii
    return low, high


def limits(simulator: Simulator, i: int) -> Bounds:
    """Return bounds of robot i's configurations, including starts and goals."""
    robot, cases = simulator.robots[i], simulator.cases
    ends = np.concatenate([cases.starts[i], cases.goals[i]])
    return np.minimum(robot.lower, ends.min(axis=0)), np.maximum(robot.upper, ends.max(axis=0))


def speeds(simulator: Simulator, i: int) -> Bounds:
    """Return bounds of the velocities of robot i's drive, including rest."""
    ends = np.array([(a.low, a.high) for a in simulator.robots[i].actions]).reshape(-1, 2)
    return np.minimum(ends[:, 0], 0.0), np.maximum(ends[:, 1], 0.0)


def max_offsets(simulator: Simulator, i: int, part: Part) -> Floats:
    """Return the largest magnitudes of offsets to a goal or a point of the path."""
    robot = simulator.robots[i]
    low, high = limits(simulator, i)
    base = {"fixed": 0, "planar": 3, "free": 7}[robot.base]
    axes = {"fixed": 0, "planar": 2, "free": 3}[robot.base]
    position = np.full(axes, np.linalg.norm((high - low)[:axes]) if axes else 0.0)
    turn = np.ones({"fixed": 0, "planar": 2, "free": 4}[robot.base])
    joints = (high - low)[base:]
    if part.name == "goal":
        return np.concatenate([position, turn, joints])
    return position if axes else joints


def max_neighbors(simulator: Simulator, i: int, size: int) -> Floats:
    """Return the largest magnitudes of robot i's observation of other robots."""
    others = range(simulator.n_robots)
    distance = path_distance = extent(simulator)
    relative_speed = speed(simulator, i) + max(speed(simulator, j) for j in others)
    radius = max(robot.reach[robot.root] for robot in simulator.robots)
    axes, turn = (2, 2) if flat(simulator) else (3, 4)
    observation, closeness = simulator.observation, 1.0
    if observation.neighbor_range is not None:  # unit vectors, scaled by the closeness
        distance, closeness = 1.0, 1.0 + 2.0 * radius / observation.neighbor_range
    one = [
        *[distance] * axes,
        *[1.0] * turn,
        *[relative_speed] * axes,
        radius,
        *[path_distance] * axes * observation.intent,
    ]
    return np.tile(one, size // len(one)) * closeness


def flat(simulator: Simulator) -> bool:
    """Whether all robots have planar bases."""
    return all(robot.base == "planar" for robot in simulator.robots)


def speed(simulator: Simulator, i: int) -> float:
    """Return the maximum speed of robot i's base, m/s."""
    robot = simulator.robots[i]
    return robot.required_drive.base_drive.max_speed(robot)


def extent(simulator: Simulator) -> float:
    """Return the largest distance between two bases, m."""
    corners = []
    for i, robot in enumerate(simulator.robots):
        axes = {"fixed": 0, "planar": 2, "free": 3}[robot.base]
        low, high = (side[:axes] for side in limits(simulator, i))
        if not np.isfinite([low, high]).all():
            return np.inf
        for ends in itertools.product(*zip(low, high, strict=True)):
            corners.append(robot.mount[:3, :3] @ [*ends, *[0.0] * (3 - axes)] + robot.mount[:3, 3])
    return float(np.linalg.norm(np.ptp(corners, axis=0)))

"""Gymnasium spaces of a simulator: what robots observe and do, and the state of a world.

Bounds are as narrow as is known of the scenario, and infinite elsewhere: positions are within a
workspace, velocities and joints within limits, a lidar sees as far as its range.
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

SLACK = 1e-5  # of bounds: single precision rounds, a quaternion is nearly of length 1


def action_box(simulator: Simulator, robot: int) -> Box:
    """[-1, 1] for each number of a robot's action."""
    return Box(-1.0, 1.0, (simulator.action_sizes[robot],), np.float32)


def observation_box(simulator: Simulator, robot: int) -> Box:
    """Bounds of a robot's observation, (size,)."""
    return box([bounds(simulator, robot, part) for part in simulator.layouts[robot]])


def state_box(simulator: Simulator) -> Box:
    """Bounds of `state_of`, (size,)."""
    parts = [(np.zeros(1), np.ones(1))]
    for i in range(simulator.n_robots):
        within = limits(simulator, i)
        parts += [within, within, speeds(simulator, i), (np.zeros(1), np.ones(1))]
    return box(parts)


def state_of(simulator: Simulator, world: int = 0) -> NDArray[np.float32]:
    """All of a world that changes, (size,): the time gone, 0 to 1; then of each robot its
    configuration, goal, velocity, and whether it is on its way."""
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
    """Bounds one after the other, rounded outward."""
    low, high = (np.concatenate([part[side] for part in parts]) for side in (0, 1))
    slack = SLACK * np.maximum(1.0, np.maximum(finite(low), finite(high)))
    low, high = np.where(low == 0, low, low - slack), high + slack
    return Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)


def finite(x: Floats) -> Floats:
    """Sizes, 0 for what is infinite."""
    return np.where(np.isfinite(x), np.abs(x), 0.0)


def bounds(simulator: Simulator, i: int, part: Part) -> Bounds:
    """Bounds of a part of robot i's observations."""
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
    high = neighbors(simulator, i, size) if part.name == "neighbors" else ways(simulator, i, part)
    low = -high
    if part.name == "neighbors":
        one = simulator.observation.neighbor_size(flat(simulator))
        low[6 if flat(simulator) else 10 :: one] = 0.0  # radii
    return low, high


def limits(simulator: Simulator, i: int) -> Bounds:
    """Of robot i's configurations, starts and goals among them."""
    robot, cases = simulator.robots[i], simulator.cases
    ends = np.concatenate([cases.starts[i], cases.goals[i]])
    return np.minimum(robot.lower, ends.min(axis=0)), np.maximum(robot.upper, ends.max(axis=0))


def speeds(simulator: Simulator, i: int) -> Bounds:
    """Of what robot i's drive does; it may rest."""
    ends = np.array([(a.low, a.high) for a in simulator.robots[i].actions]).reshape(-1, 2)
    return np.minimum(ends[:, 0], 0.0), np.maximum(ends[:, 1], 0.0)


def ways(simulator: Simulator, i: int, part: Part) -> Floats:
    """The largest change to a goal or a point of the path, either way."""
    robot = simulator.robots[i]
    low, high = limits(simulator, i)
    base = {"fixed": 0, "planar": 3, "free": 7}[robot.base]
    axes = {"fixed": 0, "planar": 2, "free": 3}[robot.base]
    place = np.full(axes, np.linalg.norm((high - low)[:axes]) if axes else 0.0)
    turn = np.ones({"fixed": 0, "planar": 2, "free": 4}[robot.base])
    joints = (high - low)[base:]
    if part.name == "goal":
        return np.concatenate([place, turn, joints])
    return place if axes else joints


def neighbors(simulator: Simulator, i: int, size: int) -> Floats:
    """The largest numbers of what robot i sees of others, either way."""
    others = range(simulator.n_robots)
    far = way = extent(simulator)
    fast = speed(simulator, i) + max(speed(simulator, j) for j in others)
    radius = max(robot.reach[robot.root] for robot in simulator.robots)
    axes, turn = (2, 2) if flat(simulator) else (3, 4)
    seen, closest = simulator.observation, 1.0
    if seen.neighbor_range is not None:  # a direction, and all times the closeness
        far, closest = 1.0, 1.0 + 2.0 * radius / seen.neighbor_range
    one = [*[far] * axes, *[1.0] * turn, *[fast] * axes, radius, *[way] * axes * seen.intent]
    return np.tile(one, size // len(one)) * closest


def flat(simulator: Simulator) -> bool:
    """Whether all are on planar bases."""
    return all(robot.base == "planar" for robot in simulator.robots)


def speed(simulator: Simulator, i: int) -> float:
    """How fast robot i's base may go, m/s."""
    robot = simulator.robots[i]
    return robot.required_drive.base_drive.max_speed(robot)


def extent(simulator: Simulator) -> float:
    """Meters that two bases may be apart at most."""
    corners = []
    for i, robot in enumerate(simulator.robots):
        axes = {"fixed": 0, "planar": 2, "free": 3}[robot.base]
        low, high = (side[:axes] for side in limits(simulator, i))
        if not np.isfinite([low, high]).all():
            return np.inf
        for ends in itertools.product(*zip(low, high, strict=True)):
            corners.append(robot.mount[:3, :3] @ [*ends, *[0.0] * (3 - axes)] + robot.mount[:3, 3])
    return float(np.linalg.norm(np.ptp(corners, axis=0)))

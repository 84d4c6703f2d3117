"""A built scenario as the native simulator takes it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.scenarios import Built
from fgenv.scenarios.drive_specs import Lidar

from .cases import Cases
from .observations import Observation


def agents(world: World, built: Built, cases: Cases, observation: Observation) -> list[_core.Agent]:
    """The robots of a world that was built so, in their order.

    Raises:
        ValueError: a robot has no drive, or one that the simulator does not know; or observes
            nothing.
    """
    found = []
    plain = ("goal", "velocity", "configuration", "path_hint")
    others = min(observation.neighbors, len(built.robots) - 1)
    sees = others > 0 or any(getattr(observation, name) for name in plain)
    for i, robot in enumerate(built.robots):
        spec = built.scenario.robots[i]
        lidar = lidar_of(built.scenario.models[spec.model].lidar, observation)
        if robot.drive is None:
            raise ValueError(
                f"robot: got {robot.name!r} without a drive, expected one; give its model one to"
                " simulate it"
            )
        if not sees and lidar is None:
            raise ValueError(f"observation: {robot.name!r} observes nothing, expected one part on")
        found.append(
            _core.Agent(
                world._core,
                int(world.parts(built.groups[i][0])[0]),
                robot.drive.native(robot),
                starts=cases.starts[i],
                goals=cases.goals[i],
                tolerance=(spec.goal_tolerance.position, spec.goal_tolerance.angle),
                radius=robot.reach[robot.root],
                range=lidar.range if lidar else 0.0,
                position=np.array(lidar.position if lidar else (0.0, 0.0, 0.0)),
                directions=directions(lidar) if lidar else np.empty((0, 3)),
            )
        )
    return found


def lidar_of(own: Lidar | None, observation: Observation) -> Lidar | None:
    """The lidar that a robot has."""
    if not observation.lidar:
        return None
    if observation.rays is None:
        return own
    plain = Lidar(rays=observation.rays, range=observation.lidar_range)
    return plain if own is None else plain.model_copy(update={"position": own.position})


def directions(lidar: Lidar) -> Floats:
    """Unit vectors (rows * rays, 3) in the root's frame, row by row from the lowest.

    Going round, the first ray is ahead and the others follow to the left; else they go from right
    to left.
    """
    turns, rises = spread(lidar.rays, lidar.field_of_view), spread(lidar.rows, lidar.rise)
    if lidar.field_of_view >= 2 * math.pi:
        turns = [2 * math.pi * k / lidar.rays for k in range(lidar.rays)]
    found = []
    for rise in rises:
        up, flat = _core.sin_cos(rise)
        for turn in turns:
            sine, cosine = _core.sin_cos(turn)
            found.append((flat * cosine, flat * sine, up))
    return np.array(found)


def spread(n: int, width: float) -> Sequence[float]:
    """n angles evenly over a width about 0, both ends included; one alone is 0."""
    return [0.0] if n == 1 else [width * (k / (n - 1) - 0.5) for k in range(n)]


def standing(world: World, built: Built, cases: Cases) -> tuple[list[int], Any]:
    """Ids of bodies that stand elsewhere in each case, and their poses."""
    ids = dict(zip(world.names, world.ids.tolist(), strict=True))
    return [ids[built.names[k]] for k in cases.stands], cases.poses

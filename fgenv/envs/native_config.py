"""The native simulator of a built scenario."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.robots import Robot
from fgenv.robots.footprint import (
    enclosing_discs,
    enclosing_radius,
    footprint_size,
    is_elongated,
)
from fgenv.scenarios import Built
from fgenv.scenarios.drive_specs import Lidar

from .cases import Cases
from .observations import Observation
from .rewards import TERMS
from .simulator_settings import SimulatorSettings


def make_simulator(
    world: World, built: Built, cases: Cases, settings: SimulatorSettings, horizon: int
) -> _core.Simulator:
    """Make a native simulator from a world of a built scenario.

    Raises:
        ValueError: a robot has no drive or an unknown one, observes nothing, or cannot have the
            path hints of `settings`.
    """
    ids = dict(zip(world.names, world.ids.tolist(), strict=True))
    return _core.Simulator(
        world._core,
        robot_specs(world, built, cases, settings.observation),
        settings=native_settings(settings, built, horizon),
        worlds=settings.n_worlds,
        bodies=[ids[built.names[k]] for k in cases.bodies],
        poses=cases.poses,
        footprints=footprints(built) if settings.shortest_paths else [],
    )


def native_settings(settings: SimulatorSettings, built: Built, horizon: int) -> dict[str, Any]:
    """Return the values of the native SimulatorSettings."""
    scenario, observation, reward = built.scenario, settings.observation, settings.reward
    most_neighbors = observation.neighbors if observation.pad else len(built.robots) - 1
    return {
        "dt": scenario.time_step,
        "horizon": horizon,
        "response": scenario.on_collision,
        "vanish": scenario.at_goal == "vanish",
        "waypoint_actions": settings.actions == "way_points",
        "waypoint_seconds": float(settings.way_point_seconds),
        "random_starts": settings.starts == "random",
        "case_by_seed": settings.case_order == "seed",
        "measure_clearance": bool(settings.clearance),
        "closeness_range": float(reward.near),
        "tolerance": float(settings.tolerance),
        "goal": observation.goal,
        "velocity": observation.velocity,
        "configuration": observation.configuration,
        "path_hint": observation.path_hint,
        "lidar": observation.lidar,
        "neighbors": min(observation.neighbors, most_neighbors),
        "intent": observation.intent,
        "priority": observation.priority,
        "neighbor_range": float(observation.neighbor_range or 0.0),
        "look_ahead": float(observation.look_ahead),
        **{name: float(reward.weights.get(name, 0.0)) for name in TERMS},
    }


def robot_specs(
    world: World, built: Built, cases: Cases, observation: Observation
) -> list[_core.RobotSpec]:
    """Return the robots of a world of a built scenario, in their order."""
    specs = []
    for i, robot in enumerate(built.robots):
        spec = built.scenario.robots[i]
        lidar = lidar_of(built.scenario.models[spec.model].lidar, observation)
        if lidar is None and not observes_anything(observation, len(built.robots)):
            raise ValueError(
                f"observation: got no part for {robot.name!r}, expected at least one; switch one on"
            )
        specs.append(
            _core.RobotSpec(
                world._core,
                int(world.parts(built.groups[i][0])[0]),
                robot.required_drive.native(robot),
                starts=cases.starts[i],
                goals=cases.goals[i],
                tolerance=(spec.goal_tolerance.position, spec.goal_tolerance.angle),
                radius=robot.reach[robot.root],
                range=lidar.range if lidar else 0.0,
                position=np.array(lidar.position if lidar else (0.0, 0.0, 0.0)),
                directions=directions(lidar) if lidar else np.empty((0, 3)),
            )
        )
    return specs


def observes_anything(observation: Observation, n_robots: int) -> bool:
    """Return whether a robot without a lidar observes anything."""
    parts = ("goal", "velocity", "configuration", "path_hint")
    neighbors = min(observation.neighbors, n_robots - 1)
    return neighbors > 0 or any(getattr(observation, name) for name in parts)


def footprints(built: Built) -> list[_core.Footprint]:
    """Return the robots as shortest paths take them.

    Raises:
        ValueError: a robot has no planar base, has joints, or has no workspace.
    """
    models = [spec.model for spec in built.scenario.robots]
    return [
        footprint(robot, models.index(m)) for robot, m in zip(built.robots, models, strict=True)
    ]


def footprint(robot: Robot, model: int) -> _core.Footprint:
    """Return a robot's discs and workspace; `model`: the first robot of the same model.

    A single disc counts as wide as the ball about the base: low robots are wider than that, and
    need the room to drive around each other (on wheels in `random`, ORCA with the tightest discs
    solves 0.60 of the episodes instead of 0.88).
    """
    if robot.base != "planar" or robot.nq != 3 or robot.workspace is None:
        raise ValueError(
            f"path: got 'shortest' with {robot.name!r}, expected a robot with a planar base, a"
            " workspace and no joints; use 'straight'"
        )
    centers, radius = enclosing_discs(robot)
    extra = float(robot.reach[robot.root]) - enclosing_radius(robot) if len(centers) == 1 else 0.0
    return _core.Footprint(
        disc_centers=centers,
        disc_radius=radius,
        extra=extra,
        width=float(min(footprint_size(robot))),
        turns=is_elongated(robot),
        workspace=np.asarray(robot.workspace),
        model=model,
    )


def lidar_of(own: Lidar | None, observation: Observation) -> Lidar | None:
    """Return the lidar of a robot with this lidar in its model; None: it has none."""
    if not observation.lidar:
        return None
    if observation.rays is None:
        return own
    plain = Lidar(rays=observation.rays, range=observation.lidar_range)
    return plain if own is None else plain.model_copy(update={"position": own.position})


def directions(lidar: Lidar) -> Floats:
    """Return unit vectors (rows * rays, 3) in the root's frame, row by row from the lowest.

    On a full circle, the first ray points ahead and the others follow to the left; otherwise they
    run from right to left.
    """
    turns, rises = spread(lidar.rays, lidar.field_of_view), spread(lidar.rows, lidar.rise)
    if lidar.field_of_view >= 2 * math.pi:
        turns = [2 * math.pi * k / lidar.rays for k in range(lidar.rays)]
    vectors = []
    for rise in rises:
        up, flat = _core.sin_cos(rise)
        for turn in turns:
            sine, cosine = _core.sin_cos(turn)
            vectors.append((flat * cosine, flat * sine, up))
    return np.array(vectors)


def spread(n: int, width: float) -> Sequence[float]:
    """Return n evenly spaced angles over a width about 0, both ends included; a single one is 0."""
    return [0.0] if n == 1 else [width * (k / (n - 1) - 0.5) for k in range(n)]

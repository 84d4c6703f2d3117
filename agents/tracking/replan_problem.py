"""Replanning problems: scenarios that start from the current state of an episode."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots import Robot
from fgenv.scenarios import Scenario
from fgenv.scenarios.schema import Body, RobotSpec


def current_scenario(
    scenario: Scenario,
    robots: Sequence[Robot],
    q: Floats,
    movers: Sequence[int],
    standing: Sequence[int],
) -> tuple[Scenario, tuple[int, ...]]:
    """Return the scenario with movers at their configurations, and standing robots as bodies.

    All other robots are left out. A standing robot of several links stays a robot, with its current
    configuration as its goal.

    Args:
        scenario: with the goals of the episode.
        robots: models of its robots.
        q: configurations (robots, nq).

    Returns:
        The scenario, and the indices of its robots in the given one.
    """
    rows = [tuple(row[: model.nq].tolist()) for row, model in zip(q, robots, strict=True)]
    specs: dict[int, RobotSpec] = {}
    bodies = list(scenario.bodies)
    for i in sorted([*movers, *standing]):
        spec = scenario.robots[i]
        shape = scenario.models[spec.model].shape
        if i in movers:
            specs[i] = spec.model_copy(update={"start": rows[i]})
        elif shape is None:
            specs[i] = spec.model_copy(update={"start": rows[i], "goal": rows[i]})
        else:
            bodies.append(static_body(spec, shape, robots[i].forward(np.array(rows[i]), 0)))
    changed = {"robots": tuple(specs.values()), "bodies": tuple(bodies)}
    return scenario.model_copy(update=changed).at(scenario.folder), tuple(specs)


def static_body(spec: RobotSpec, shape: str, pose: Floats) -> Body:
    """A robot of one link as a static body at a pose (4, 4)."""
    r = pose[:3, :3]
    rpy = (
        math.atan2(r[2, 1], r[2, 2]),
        math.atan2(-r[2, 0], math.hypot(r[2, 1], r[2, 2])),
        math.atan2(r[1, 0], r[0, 0]),
    )
    place = tuple(pose[:3, 3].tolist())
    return Body(name=spec.name, shape=shape, position=place, rpy=rpy, groups=spec.groups)


def extrapolated(robot: Robot, before: Floats, now: Floats, steps: int) -> Floats:
    """Configurations (1 + steps, nq) if a robot repeats its last step; a free base keeps level.

    Args:
        before, now: configurations (nq,).
    """
    by = now - before
    by[robot.endless] = np.remainder(by[robot.endless] + math.pi, 2 * math.pi) - math.pi
    if robot.base == "free":
        by[3:7] = 0.0
    rows: Floats = now + np.arange(steps + 1)[:, None] * by
    ends = robot.endless
    rows[:, ends] = np.remainder(rows[:, ends] + math.pi, 2 * math.pi) - math.pi
    return rows

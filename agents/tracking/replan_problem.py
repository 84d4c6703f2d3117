"""Scenarios of episodes as they are now: robots from where they are, the rest in their way."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots import Robot
from fgenv.scenarios import Scenario
from fgenv.scenarios.schema import Body, RobotSpec


def from_here(
    scenario: Scenario,
    robots: Sequence[Robot],
    q: Floats,
    movers: Sequence[int],
    standing: Sequence[int],
) -> tuple[Scenario, tuple[int, ...]]:
    """The scenario with movers at their configurations, and standing robots as bodies.

    Robots that are neither are gone. A robot of several links that stands stays a robot, whose goal
    is where it is.

    Args:
        scenario: with the goals of the episode.
        robots: their models.
        q: configurations (robots, nq).

    Returns:
        The scenario, and the places of its robots in that given.
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
            bodies.append(body_of(spec, shape, robots[i].forward(np.array(rows[i]), 0)))
    changed = {"robots": tuple(specs.values()), "bodies": tuple(bodies)}
    return scenario.model_copy(update=changed).at(scenario.folder), tuple(specs)


def body_of(spec: RobotSpec, shape: str, pose: Floats) -> Body:
    """A robot of one link as a body that stands at a pose (4, 4)."""
    r = pose[:3, :3]
    rpy = (
        math.atan2(r[2, 1], r[2, 2]),
        math.atan2(-r[2, 0], math.hypot(r[2, 1], r[2, 2])),
        math.atan2(r[1, 0], r[0, 0]),
    )
    place = tuple(pose[:3, 3].tolist())
    return Body(name=spec.name, shape=shape, position=place, rpy=rpy, groups=spec.groups)


def onward(robot: Robot, before: Floats, now: Floats, steps: int) -> Floats:
    """Where a robot gets that goes on as in the last step, (1 + steps, nq); a free base level on.

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

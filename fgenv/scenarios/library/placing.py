"""Collision-free placement of robots, by the exact core."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fgenv.scenarios.errors import Problem, ScenarioError
from fgenv.scenarios.rng import micro
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import Body, RobotSpec

Q = tuple[float, ...]
TRIES = 3000  # for one robot
MARGIN = 0.02  # meters between robots, and to walls


def scatter(scenario: Scenario, draw: Callable[[int], Q], margin: float = MARGIN) -> list[Q]:
    """A configuration for each robot of a scenario in which it meets no body and no other robot.

    Args:
        scenario: its robots' starts and goals are not looked at.
        draw: gives a configuration to try for robot i.
        margin: meters that robots of one shape are apart from all else.

    Raises:
        ScenarioError: no place is left.
    """
    built = scenario.build()
    world, placed = built.world(robots=False), []
    for i, robot in enumerate(built.robots):
        me = -1
        gap = margin if len(robot.parts) == 1 else 0.0
        for _ in range(TRIES):
            q = draw(i)
            if not robot.valid(q):
                continue
            me = built.add_robot(world, i, np.array(q)) if me < 0 else me
            if not world.collides(me, q, margin=gap):
                world.set_configuration(me, q)
                placed.append(q)
                break
        else:
            told = Problem(f"no room is left for robot {i + 1} of {len(built.robots)}", CROWDED)
            raise ScenarioError(scenario.name, [told])
    return placed


CROWDED = "give fewer robots (n) or a larger size"


def sent(scenario: Scenario, starts: Sequence[Q], goals: Sequence[Q]) -> Scenario:
    """The scenario with starts and goals, checked: free of all contact.

    Raises:
        ScenarioError: something touches.
    """
    robots = tuple(
        spec.model_copy(update={"start": start, "goal": goal})
        for spec, start, goal in zip(scenario.robots, starts, goals, strict=True)
    )
    done = scenario.model_copy(update={"robots": robots})
    if problems := done.problems():
        raise ScenarioError(scenario.name, [*problems[:3], Problem("is too crowded", CROWDED)])
    return done


def team(n: int, model: str, nq: int, **fields: Any) -> list[RobotSpec]:
    """Robots of one model, not yet placed."""
    blank = (0.0,) * nq
    return [
        RobotSpec(name=f"robot {i + 1}", model=model, start=blank, goal=blank, **fields)
        for i in range(n)
    ]


def body(shape: str, x: float, y: float, yaw: float = 0.0, name: str | None = None) -> Body:
    """A body on the floor."""
    at, turn = (micro(x), micro(y), 0.0), (0.0, 0.0, micro(yaw))
    return Body(name=name, shape=shape, position=at, rpy=turn)


def block(x: float, y: float, z: float) -> dict[str, Any]:
    """The shape of a wall, meters."""
    return {"kind": "block", "size": (micro(x), micro(y), micro(z))}


def fence(width: float, depth: float, height: float = 0.4, thick: float = 0.1) -> Any:
    """Four walls around (width, depth): shapes by name, and bodies."""
    x, y = (width + thick) / 2, (depth + thick) / 2
    shapes = {
        "fence x": block(width + 2 * thick, thick, height),
        "fence y": block(thick, depth, height),
    }
    bodies = [
        body("fence x", 0.0, -y, name="south"),
        body("fence x", 0.0, y, name="north"),
        body("fence y", -x, 0.0, name="west"),
        body("fence y", x, 0.0, name="east"),
    ]
    return shapes, bodies


def bare(name: str, **fields: Any) -> Scenario:
    """A scenario with robots that are not placed yet."""
    return Scenario.model_validate({"version": 1, "name": name, **fields})


def area(width: float, depth: float) -> dict[str, Any]:
    """A planar workspace around the origin."""
    x, y = micro(width / 2), micro(depth / 2)
    return {"low": (-x, -y), "high": (x, y)}

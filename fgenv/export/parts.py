"""The meshes of shapes, robots at a configuration, and scenarios, placed and named."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.robots import Robot
from fgenv.scenarios import Scenario

from .meshes import PlacedMesh


def mesh_parts(shape: Shape) -> list[PlacedMesh]:
    """Return the mesh of a shape, as repaired, in its frame."""
    return _named([(shape.name or "mesh", shape, np.eye(4))])


def robot_parts(robot: Robot, q: ArrayLike | None = None) -> list[PlacedMesh]:
    """Return the shapes of a robot at a configuration (nq,), by default `rest`.

    They are named ROBOT/LINK; further shapes of a link have numbers.
    """
    return _named(_placed(robot, robot.name, robot.rest if q is None else q))


def scenario_parts(
    scenario: Scenario, configurations: Sequence[ArrayLike] | None = None
) -> list[PlacedMesh]:
    """Return the static bodies and the robots of a scenario.

    Args:
        configurations: (nq,) of each robot; by default the starts.
    """
    built = scenario.build()
    rows: Sequence[ArrayLike] = built.starts if configurations is None else configurations
    items = list(zip(built.names, built.shapes, built.poses, strict=True))
    for robot, groups, q in zip(built.robots, built.groups, rows, strict=True):
        items += _placed(robot, groups[0], q)
    return _named(items)


def _placed(robot: Robot, label: str, q: ArrayLike) -> list[tuple[str, Shape, Floats]]:
    poses = robot.forward(q)
    if poses.ndim != 3:
        raise ValueError(f"q: got {poses.shape[:-3]} configurations, expected one, ({robot.nq},)")
    return [
        (f"{label}/{robot.links[p.link].name}", p.shape, poses[p.link] @ p.origin)
        for p in robot.parts
    ]


def _named(items: Iterable[tuple[str, Shape, Floats]]) -> list[PlacedMesh]:
    """Return meshes with unique names of one line."""
    meshes: list[PlacedMesh] = []
    used: set[str] = set()
    for name, shape, pose in items:
        plain = " ".join(name.split()) or "mesh"
        unique, k = plain, 2
        while unique in used:
            unique, k = f"{plain} {k}", k + 1
        used.add(unique)
        meshes.append(PlacedMesh(unique, shape.vertices, shape.faces, pose))
    return meshes

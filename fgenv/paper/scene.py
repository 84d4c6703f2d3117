"""The scene of the published experiment: the scenario `three_tanks`, with any robot."""

from pathlib import Path

import numpy as np

from fgenv.collision import Shape, World
from fgenv.collision.world import BodyRecord
from fgenv.planners import PlanningError, Problem
from fgenv.scenarios import Scenario
from fgenv.scenarios.schema import Placement
from fgenv.scenarios.shapes.bodies import MeshFile

LONGEST = 6.0  # m; the tanks leave no room for a longer robot
HEADING = float(np.arctan2(5.0, 8.0))  # rad, of the straight path
NOZZLES = {"tank 1": -60.0, "tank 2": 150.0, "tank 3": 220.0}  # degrees


def published_scenario() -> Scenario:
    """The scenario `three_tanks` without a workspace, and with exact angles.

    The scenario's file has its angles to a microradian.
    """
    scenario = Scenario.load("three_tanks")
    shapes = dict(scenario.shapes)
    for name, degrees in NOZZLES.items():
        shapes[name] = shapes[name].model_copy(update={"nozzle": float(np.deg2rad(degrees))})
    robot = scenario.robots[0]
    ends = {"start": (*robot.start[:2], HEADING), "goal": (*robot.goal[:2], HEADING)}
    robots = (robot.model_copy(update=ends),)
    return scenario.replace(workspace=None, shapes=shapes, robots=robots)


def three_tanks(mesh: str | Path | None = None, *, scale: float = 1.0) -> Problem:
    """The published scene as a planning problem with one robot.

    Args:
        mesh: file of the robot's mesh (STL, OBJ, PLY, OFF, GLB or DAE, z up, x forward), None for
            the built-in robot. The mesh's lowest vertex is put on the floor.
        scale: factor from the file's unit to meters.

    Raises:
        ValueError: the robot is longer than 6 m, or collides at its start or its goal.
    """
    scenario = published_scenario()
    if mesh is None:
        return Problem.from_scenario(scenario)
    form = MeshFile(kind="mesh", file=str(Path(mesh).resolve()), scale=scale)
    shape = form.shape()
    sides = np.ptp(shape.vertices, axis=0)
    robot = f"mesh {mesh}: a robot of {' x '.join(f'{side:.3g}' for side in sides)} m"
    remedy = "scale it down (0.001 if drawn in millimeters)"
    if sides.max() > LONGEST:
        raise ValueError(f"{robot} is too long for this scene; {remedy}")
    mount = Placement(position=(0.0, 0.0, -float(shape.vertices[:, 2].min())))
    spec = scenario.robots[0].model_copy(update={"mount": mount})
    shapes = {**scenario.shapes, spec.name: form}
    problem = Problem.from_scenario(scenario.replace(shapes=shapes, robots=(spec,)))
    try:
        problem.check()
    except PlanningError as error:
        raise ValueError(f"{robot}: {error}; {remedy}") from None
    return problem


def model_list(world: World) -> list[BodyRecord]:
    """The records of all bodies, the robot's first."""
    records = [world.record(body) for body in world.ids.tolist()]
    return sorted(records, key=lambda record: record.robot is None)


def masks(world: World) -> dict[str, int]:
    """The collision mask of each body by name, the robot's first."""
    return {record.name: record.mask for record in model_list(world)}


def robot_shape(problem: Problem) -> Shape:
    """The shape of the problem's robot."""
    return problem.models[0].parts[0].shape

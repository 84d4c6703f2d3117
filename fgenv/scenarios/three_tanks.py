"""The scene of the published experiment: one mobile robot and three tanks."""

from pathlib import Path

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import Shape, World
from fgenv.scenarios.meshes.three_tanks import mobile_robot, tank
from fgenv.scenarios.scene import Scene, in_contact
from fgenv.scenarios.se2 import as_poses

START = (0.0, 0.0, float(np.arctan2(5.0, 8.0)))
GOAL = (8.0, 5.0, float(np.arctan2(5.0, 8.0)))

# Name, where it stands (x, y), radius, height, direction of its nozzle (degrees). Tank 1 is out
# of the way, tank 2 stands in the straight path, tank 3 beside it.
TANKS = (
    ("tank 1", (1.4, 7.6), 0.9, 3.0, -60.0),
    ("tank 2", (4.3, 2.6), 0.65, 2.1, 150.0),
    ("tank 3", (6.6, 1.5), 0.75, 1.6, 220.0),
)


def three_tanks(
    mesh: str | Path | None = None, *, scale: float = 1.0, method: str = "exact"
) -> Scene:
    """The scene, with the robot of `mesh` (any format trimesh reads, scaled) or the built-in one.

    A mesh is stood on the floor (its lowest vertex at z = 0), its origin on the path, x forward.
    Raises ValueError where the robot is longer than 6 m, or collides at its start or its goal.
    """
    shape = _builtin(method) if mesh is None else Shape.load(mesh, scale=scale, method=method)
    height = 0.0 if mesh is None else -float(shape.vertices[:, 2].min())
    world = World()
    robot = world.add(shape, as_poses(START, height), name="robot")
    for name, place, radius, tall, nozzle in TANKS:
        body = tank(radius, tall, np.deg2rad(nozzle))
        stands = as_poses((*place, 0.0))
        world.add(Shape(body.vertices, body.faces, method=method, name=name), stands, name=name)
    size = np.ptp(shape.vertices, axis=0)
    if size.max() > 6.0:
        raise ValueError(_too_big(mesh, size, "is too long for this scene"))
    for end, at in (("start", START), ("goal", GOAL)):
        hit = in_contact(world, robot, as_poses(at, height))
        if hit:
            why = f"collides with {' and '.join(hit)} at its {end} ({at[0]:g}, {at[1]:g})"
            raise ValueError(_too_big(mesh, size, why))
    return Scene("three_tanks", world, robot, START, GOAL, height)


def _too_big(mesh: str | Path | None, size: Floats, why: str) -> str:
    sides = " x ".join(f"{side:.3g}" for side in size)
    return f"mesh {mesh}: a robot of {sides} m {why}; scale it down (0.001 if drawn in millimeters)"


def _builtin(method: str) -> Shape:
    mesh = mobile_robot()
    return Shape(mesh.vertices, mesh.faces, method=method, name="robot")

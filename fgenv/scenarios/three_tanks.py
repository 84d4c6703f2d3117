"""The scene of the published experiment: one mobile robot and three tanks."""

from pathlib import Path

import numpy as np

from fgenv.collision import Shape, collide
from fgenv.scenarios.body import Body, Scene
from fgenv.scenarios.solids import mobile_robot, tank

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
    Raises ValueError where the robot collides at its start or its goal.
    """
    shape = _builtin(method) if mesh is None else Shape.load(mesh, scale=scale, method=method)
    height = 0.0 if mesh is None else -float(shape.vertices[:, 2].min())
    mover = Body(0, "robot", shape, START, height, own_bit=1)
    scene = Scene("three_tanks", mover, _tanks(method), START, GOAL)
    _check(scene, "start", mesh)
    _check(scene, "goal", mesh)
    return scene


def _builtin(method: str) -> Shape:
    mesh = mobile_robot()
    return Shape(mesh.vertices, mesh.faces, method=method, name="robot")


def _tanks(method: str) -> list[Body]:
    bodies = []
    for number, (name, place, radius, height, nozzle) in enumerate(TANKS, start=1):
        mesh = tank(radius, height, np.deg2rad(nozzle))
        shape = Shape(mesh.vertices, mesh.faces, method=method, name=name)
        bodies.append(Body(number, name, shape, (*place, 0.0)))
    return bodies


def _check(scene: Scene, end: str, mesh: str | Path | None) -> None:
    mover = scene.mover
    mover.configuration = scene.goal if end == "goal" else scene.start
    hit = [b.name for b in scene.obstacles if collide(mover.shape, mover.pose, b.shape, b.pose)]
    mover.configuration = scene.start
    if hit:
        size = " x ".join(f"{s:.3g}" for s in np.ptp(mover.shape.vertices, axis=0))
        raise ValueError(
            f"mesh {mesh}: the robot ({size} m) collides with {' and '.join(hit)} at its {end} "
            f"{getattr(scene, end)[:2]}; give a smaller one, or scale= "
            "(0.001 for a mesh drawn in millimetres)"
        )

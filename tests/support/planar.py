"""Planning problems with one robot on the floor, and python-fcl on their bodies."""

from __future__ import annotations

from typing import Any

import fcl
import numpy as np
import trimesh

from fgenv.arrays import Floats
from fgenv.collision.world import BodyRecord
from fgenv.paper.scene import model_list, robot_shape
from fgenv.paper.timed_path import as_path, radius_of, refine
from fgenv.planners import Problem
from fgenv.scenarios import Scenario

Configuration = tuple[float, float, float]


def planar_problem(
    robot: trimesh.Trimesh,
    start: Configuration,
    goal: Configuration,
    bodies: dict[str, tuple[trimesh.Trimesh, Configuration]] | None = None,
    workspace: Any = None,
) -> Problem:
    """A robot with a planar base among named bodies, each with a mesh and x, y, yaw."""
    bodies = bodies or {}
    meshes = {"robot": robot, **{name: mesh for name, (mesh, _) in bodies.items()}}
    shapes = {
        name: {"kind": "triangles", "vertices": m.vertices.tolist(), "faces": m.faces.tolist()}
        for name, m in meshes.items()
    }
    standing = [
        {"name": name, "shape": name, "position": (x, y, 0.0), "rpy": (0.0, 0.0, yaw)}
        for name, (_, (x, y, yaw)) in bodies.items()
    ]
    document = {
        "version": 1,
        "name": "planar",
        "shapes": shapes,
        "models": {"robot": {"shape": "robot"}},
        "robots": [{"name": "robot", "model": "robot", "start": start, "goal": goal}],
        "bodies": standing,
        "workspace": workspace and dict(zip(("low", "high"), workspace, strict=True)),
    }
    return Problem.from_scenario(Scenario.model_validate(document))


class Fcl:
    """python-fcl on the bodies of a problem with one robot."""

    def __init__(self, problem: Problem) -> None:
        robot, *bodies = model_list(problem.world)
        self.model, self.robot = problem.models[0], self._object(robot)
        self.bodies = {body.name: self._object(body) for body in bodies}
        self.radius = radius_of(robot_shape(problem).vertices)

    @staticmethod
    def _object(body: BodyRecord) -> Any:
        model = fcl.BVHModel()
        model.beginModel(len(body.shape.vertices), len(body.shape.faces))
        model.addSubModel(body.shape.vertices, body.shape.faces)
        model.endModel()
        return fcl.CollisionObject(model, fcl.Transform(body.pose[:3, :3], body.pose[:3, 3]))

    def hits(self, q: Floats) -> list[str]:
        """Names of the bodies that the robot collides with at a configuration (3,)."""
        pose = self.model.forward(q, 0)
        self.robot.setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
        return [name for name, body in self.bodies.items() if fcl.collide(self.robot, body)]

    def free(self, path: Any, step: float) -> bool:
        """Whether no configuration of a path collides, with `step` meters between them."""
        return not any(self.hits(q) for q in refine(as_path(path), self.radius, step))


def box(x: float, y: float, z: float = 1.0) -> trimesh.Trimesh:
    """A box with its center at the origin."""
    mesh: trimesh.Trimesh = trimesh.creation.box((x, y, z))
    return mesh


def at(problem: Problem) -> Floats:
    """The robot's current configuration, (3,)."""
    return np.asarray(problem.world.configuration(problem.robot_ids[0]))

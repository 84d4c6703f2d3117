"""An arm's exact link meshes in pinocchio with coal, as a careful user writes a checker in Python.

The same meshes, scene and pairs of links that fgenv takes; `computeCollisions` places all links and
asks all pairs in one call, up to the first contact. Obstacles are one merged mesh, or a body each
(boxes as coal's own), whichever is faster.
"""

from __future__ import annotations

from functools import cached_property
from importlib import import_module
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.planners.problem import Problem
from fgenv.scenarios.build import urdf_path

from .coal_ import coal_model
from .rigid import Bind, Collides, faster
from .task import merged, moved

ARM = "pinocchio + coal"
STEP = 1 / 32  # radians in the joint space: of a discrete check
SAMPLES = 300


class ArmTask:
    """An arm on a fixed base, from start to goal.

    Attributes:
        name: of the problem.
        problem: as planners take it.
        resolution: radians in the joint space, of a discrete check.
    """

    def __init__(self, name: str, problem: Problem) -> None:
        self.name, self.problem = name, problem
        self.resolution = STEP

    @cached_property
    def samples(self) -> Floats:
        """Configurations at random, (SAMPLES, nq)."""
        return self.problem.models[0].random(np.random.default_rng(0), SAMPLES)

    def steps(self, q0: Floats, q1: Floats, step: float) -> int:
        """Steps between configurations (nq,) that are no longer."""
        return max(1, int(np.ceil(np.linalg.norm(q1 - q0) / step)))

    def between(self, q0: Floats, q1: Floats, t: Floats) -> Floats:
        """Configurations (k, nq) at fractions t (k,)."""
        return self.problem.models[0].interpolate(q0, q1, t)


class Kinematics:
    """pinocchio's model of a problem's arm, its links as coal's meshes."""

    def __init__(self, problem: Problem) -> None:
        pin = import_module("pinocchio")
        self.pin, self.problem, self.robot = pin, problem, problem.models[0]
        spec = problem.scenario.models[problem.scenario.robots[0].model]
        self.model = pin.buildModelFromUrdf(str(urdf_path(str(spec.urdf), problem.scenario.folder)))
        if tuple(self.model.names)[1:] != self.robot.coordinates:
            raise ValueError(f"mbm: joints {list(self.model.names)}, expected the robot's")
        self.links = [coal_model(moved(part.shape, np.eye(4))) for part in self.robot.parts]

    def bind(self, standing: list[Any]) -> Bind:
        """A checker among bodies (geometry, pose) that stand."""
        pin, model = self.pin, self.model
        shapes = pin.GeometryModel()
        placed = [shapes.addGeometryObject(self._link(i)) for i in range(len(self.links))]
        still = [
            shapes.addGeometryObject(
                pin.GeometryObject(f"body {k}", 0, 0, pin.SE3(self.robot.mount).inverse() * pose, g)
            )
            for k, (g, pose) in enumerate(standing)
        ]
        turning = [i for i in placed if shapes.geometryObjects[i].parentJoint > 0]
        allowed = set(self.robot.allowed_parts)
        pairs = [(i, k) for i in turning for k in still]
        pairs += [(i, j) for i in placed for j in placed if i < j and (i, j) not in allowed]
        for pair in pairs:
            shapes.addCollisionPair(pin.CollisionPair(*pair))
        compute = pin.computeCollisions

        def bound(row: Floats) -> Collides:
            data, held = model.createData(), shapes.createData()
            return lambda: bool(compute(model, data, shapes, held, row, True))

        return bound

    def _link(self, i: int) -> Any:
        part = self.robot.parts[i]
        frame = self.model.getFrameId(self.robot.links[part.link].name)
        on = self.model.frames[frame]
        pose = on.placement * self.pin.SE3(np.array(part.origin))
        return self.pin.GeometryObject(f"part {i}", on.parentJoint, frame, pose, self.links[i])


def arm_bodies(task: ArmTask) -> Bind:
    """pinocchio's and coal's form of a problem."""
    import coal

    arm, built = Kinematics(task.problem), task.problem.built
    pin, here = arm.pin, arm.pin.SE3.Identity()
    meshes = [moved(shape, pose) for shape, pose in zip(built.shapes, built.poses, strict=True)]
    bodies = task.problem.scenario.bodies
    forms = [task.problem.scenario.shapes[body.shape] for body in bodies]
    each = [
        (coal.Box(*form.size), pin.SE3(pose)) if form.kind == "box" else (coal_model(mesh), here)
        for form, pose, mesh in zip(forms, built.poses, meshes, strict=True)
    ]
    ways = [arm.bind(each), arm.bind([(coal_model(merged(meshes)), here)])]
    return faster(task.name, task.samples, ways)

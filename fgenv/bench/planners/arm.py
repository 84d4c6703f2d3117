"""An arm's exact link meshes in pinocchio with coal: a checker in Python.

Meshes, scene and pairs of links are those of fgenv. `computeCollisions` places all links and checks
all pairs in one call, up to the first contact. Obstacles are one merged mesh, or a body each
(boxes as coal's own), whichever is faster.
"""

from __future__ import annotations

from functools import cached_property
from importlib import import_module
from typing import Any

import coal
import numpy as np

from fgenv.arrays import Floats
from fgenv.bench.peers.coal_ import PEER as COAL
from fgenv.planners.ompl.spaces import StateLayout, state_space
from fgenv.planners.problem import Problem
from fgenv.scenarios.build import urdf_path

from .rigid import Bind, Collides, fastest
from .task import merged, moved

STEP = 1 / 32  # radians in the joint space, per step of a discrete check
SAMPLES = 300


class ArmTask:
    """An arm on a fixed base, from start to goal.

    Attributes:
        name: name of the problem.
        problem: for planners.
        resolution: radians in the joint space, of a discrete check.
    """

    def __init__(self, name: str, problem: Problem) -> None:
        self.name, self.problem = name, problem
        self.resolution = STEP

    @cached_property
    def samples(self) -> Floats:
        """Random configurations, (SAMPLES, nq)."""
        return self.problem.models[0].random(np.random.default_rng(0), SAMPLES)

    @cached_property
    def layout(self) -> StateLayout:
        """Layout of configurations in states."""
        robot = self.problem.models[0]
        return StateLayout(robot, robot.steering())

    @property
    def ends(self) -> tuple[Floats, Floats]:
        """Start and goal, (nq,)."""
        start, goal = self.problem.starts[0], self.problem.goals[0]
        return self.layout.states(start), self.layout.states(goal)

    def discrete_space(self) -> Any:
        """Return a new space of OMPL with steps of the resolution at most."""
        space = state_space(self.layout)
        space.setLongestValidSegmentFraction(self.resolution / space.getMaximumExtent())
        return space

    def steps(self, q0: Floats, q1: Floats, step: float) -> int:
        """Return a number of steps between configurations (nq,), each at most `step` long."""
        return max(1, int(np.ceil(np.linalg.norm(q1 - q0) / step)))

    def between(self, q0: Floats, q1: Floats, t: Floats) -> Floats:
        """Return configurations (k, nq) at fractions t (k,)."""
        return self.problem.models[0].interpolate(q0, q1, t)


class Kinematics:
    """pinocchio's model of a problem's arm, with its links as coal's meshes."""

    def __init__(self, problem: Problem) -> None:
        pin = import_module("pinocchio")
        self.pin, self.problem, self.robot = pin, problem, problem.models[0]
        spec = problem.scenario.models[problem.scenario.robots[0].model]
        self.model = pin.buildModelFromUrdf(str(urdf_path(str(spec.urdf), problem.scenario.folder)))
        if tuple(self.model.names)[1:] != self.robot.coordinates:
            raise ValueError(
                f"mbm: got joints {list(self.model.names)}, expected {list(self.robot.coordinates)}"
            )
        self.links = [COAL.build(moved(part.shape, np.eye(4))) for part in self.robot.parts]

    def bind(self, obstacles: list[Any]) -> Bind:
        """Return a checker among fixed bodies (geometry, pose)."""
        pin, model = self.pin, self.model
        shapes = pin.GeometryModel()
        placed = [shapes.addGeometryObject(self._link(i)) for i in range(len(self.links))]
        still = [
            shapes.addGeometryObject(
                pin.GeometryObject(f"body {k}", 0, 0, pin.SE3(self.robot.mount).inverse() * pose, g)
            )
            for k, (g, pose) in enumerate(obstacles)
        ]
        turning = [i for i in placed if shapes.geometryObjects[i].parentJoint > 0]
        allowed = set(self.robot.allowed_parts)
        pairs = [(i, k) for i in turning for k in still]
        pairs += [(i, j) for i in placed for j in placed if i < j and (i, j) not in allowed]
        for pair in pairs:
            shapes.addCollisionPair(pin.CollisionPair(*pair))
        compute = pin.computeCollisions

        def bound(row: Floats) -> Collides:
            data, shape_data = model.createData(), shapes.createData()
            return lambda: bool(compute(model, data, shapes, shape_data, row, True))

        return bound

    def _link(self, i: int) -> Any:
        part = self.robot.parts[i]
        frame = self.model.getFrameId(self.robot.links[part.link].name)
        parent = self.model.frames[frame]
        pose = parent.placement * self.pin.SE3(np.array(part.origin))
        return self.pin.GeometryObject(f"part {i}", parent.parentJoint, frame, pose, self.links[i])


def arm_bodies(task: ArmTask) -> Bind:
    """Return the model of a problem in pinocchio and coal."""
    arm, built = Kinematics(task.problem), task.problem.built
    pin, origin = arm.pin, arm.pin.SE3.Identity()
    meshes = [moved(shape, pose) for shape, pose in zip(built.shapes, built.poses, strict=True)]
    bodies = task.problem.scenario.bodies
    forms = [task.problem.scenario.shapes[body.shape] for body in bodies]
    each = [
        (coal.Box(*form.size), pin.SE3(pose)) if form.kind == "box" else (COAL.build(mesh), origin)
        for form, pose, mesh in zip(forms, built.poses, meshes, strict=True)
    ]
    binds = [arm.bind(each), arm.bind([(COAL.build(merged(meshes)), origin)])]
    return fastest(task.name, task.samples, binds)

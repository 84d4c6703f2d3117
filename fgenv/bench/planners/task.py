"""Planning problems by name, and as plain meshes for the other libraries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from fgenv.arrays import Floats
from fgenv.bench.common.meshes import Mesh
from fgenv.planners.ompl.setup import problem_space
from fgenv.planners.ompl.spaces import StateLayout
from fgenv.planners.problem import Problem

FINE = 0.01  # of the space's extent: OMPL's default resolution
SAMPLES = 2000  # configurations, to compare lengths of steps on


class DiscreteTask(Protocol):
    """Data of a task for discrete checks."""

    @property
    def resolution(self) -> float:
        """Resolution of discrete checks, see `steps`."""

    @property
    def samples(self) -> Floats:
        """Random states, (k, size)."""

    @property
    def ends(self) -> tuple[Floats, Floats]:
        """Start and goal, (size,)."""

    def discrete_space(self) -> Any:
        """Return a new space of OMPL with steps of this resolution."""

    def steps(self, q0: Floats, q1: Floats, step: float) -> int:
        """Return a number of steps between states (size,) that are not longer than `step`."""

    def between(self, q0: Floats, q1: Floats, t: Floats) -> Floats:
        """Return states (k, size) at fractions t (k,) of a motion."""


@dataclass(frozen=True)
class Task:
    """Free bodies, from starts to goals among fixed obstacles.

    Attributes:
        name: name of the scenario, with `:2` for two robots.
        problem: for planners.
        resolution: maximum travel of any point per step of a discrete check, meters.
    """

    name: str
    problem: Problem
    resolution: float

    @classmethod
    def of(cls, name: str, resolution: float | None = None) -> Task:
        """Return the task `cubicles` or `cubicles:2`; default resolution: 1 % of the diagonal.

        Raises:
            ValueError: an unknown scenario, or robots that are not free bodies.
        """
        scenario, _, n = name.partition(":")
        if n and not n.isdecimal():
            raise ValueError(f"problems: got {name!r}, expected a scenario's name, or NAME:ROBOTS")
        problem = Problem.from_scenario(scenario, **({"n": int(n)} if n else {}))
        for robot in problem.models:
            if robot.base != "free" or robot.nq != 7 or (robot.mount != np.eye(4)).any():
                raise ValueError(f"problems: got {name!r}, expected robots that are free bodies")
        if resolution is not None and not resolution > 0:
            raise ValueError(f"resolution: got {resolution}, expected meters over 0")
        task = cls(name, problem, resolution or 1.0)
        if any(layout.level for layout in task.layouts):
            raise ValueError(f"problems: got {name!r}, expected robots that rotate freely")
        return task if resolution else cls(name, problem, FINE * task.extent)

    @cached_property
    def layouts(self) -> list[StateLayout]:
        """Layouts of configurations in states."""
        return [StateLayout(robot, robot.steering()) for robot in self.problem.models]

    def space(self) -> Any:
        """Return a new space of OMPL with the bounds and weights of `fgenv.planners.setup`."""
        return problem_space(self.problem, self.layouts)

    def discrete_space(self) -> Any:
        """Return a new space with fgenv's mean number of steps.

        OMPL's distance of rotations is half their angle.
        """
        space, step = self.space(), self.step_share * self.resolution
        for body, robot in zip(bodies_of(space), self.problem.models, strict=True):
            angle = 0.5 * step / max(float(robot.weights[3]), 1e-3)
            for part, length in zip(body.getSubspaces(), (step, angle), strict=True):
                part.setLongestValidSegmentFraction(min(length / part.getMaximumExtent(), 1.0))
        return space

    @cached_property
    def step_share(self) -> float:
        """Share of the resolution that a step of OMPL may translate, and rotate, a body.

        fgenv's steps bound both motions together; OMPL counts the steps of each and takes the
        larger number. With this share both have the same mean number of steps on random motions.
        """
        q0, q1 = np.split(self.samples[:, :7], 2)
        shift = np.linalg.norm(q1[:, :3] - q0[:, :3], axis=1)
        turn = self.problem.models[0].displacement_bound(q0, q1) - shift
        return float(np.maximum(shift, turn).mean() / (shift + turn).mean())

    @property
    def extent(self) -> float:
        """Diagonal of the bounds of the first robot's origin, meters."""
        return float(bodies_of(self.space())[0].getSubspaces()[0].getMaximumExtent())

    @cached_property
    def obstacles(self) -> list[Mesh]:
        """Obstacles, in the world frame."""
        built = self.problem.built
        return [moved(shape, pose) for shape, pose in zip(built.shapes, built.poses, strict=True)]

    @cached_property
    def movers(self) -> list[Mesh]:
        """Robots, each in its own frame."""
        return [
            merged([moved(part.shape, part.origin) for part in robot.parts])
            for robot in self.problem.models
        ]

    @cached_property
    def samples(self) -> Floats:
        """Random joint configurations within the bounds, (SAMPLES, 7 n)."""
        rng = np.random.default_rng(0)
        bounds = [space.getBounds() for space in bodies_of(self.space())]
        low, high = (
            np.array([[getattr(b, end)[k] for k in range(3)] for b in bounds])
            for end in ("low", "high")
        )
        places = rng.uniform(low, high, (SAMPLES, *low.shape))
        turns = rng.normal(size=(SAMPLES, len(low), 4))
        turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
        return np.concatenate([places, turns], axis=-1).reshape(SAMPLES, -1)

    @property
    def ends(self) -> tuple[Floats, Floats]:
        """Start and goal, joint states (7 n,)."""
        start, goal = (
            np.concatenate([layout.states(q) for layout, q in zip(self.layouts, qs, strict=True)])
            for qs in (self.problem.starts, self.problem.goals)
        )
        return start, goal

    def steps(self, q0: Floats, q1: Floats, step: float) -> int:
        """Return steps between joint configurations (7 n,); no point travels over `step` meters."""
        travel = [
            float(robot.displacement_bound(q0[7 * i : 7 * i + 7], q1[7 * i : 7 * i + 7]))
            for i, robot in enumerate(self.problem.models)
        ]
        return max(1, int(np.ceil(max(travel) / step)))

    def between(self, q0: Floats, q1: Floats, t: Floats) -> Floats:
        """Return joint configurations (k, 7 n) at fractions t (k,) of a motion."""
        cut = [slice(7 * i, 7 * i + 7) for i in range(len(self.problem.models))]
        parts = [
            robot.interpolate(q0[s], q1[s], t)
            for robot, s in zip(self.problem.models, cut, strict=True)
        ]
        return np.concatenate(parts, axis=-1)


def bodies_of(space: Any) -> list[Any]:
    """Return the SE3 spaces in a task's space."""
    first = space.getSubspaces()
    return [space] if hasattr(space, "getBounds") else list(first)


def moved(shape: Any, pose: Floats) -> Mesh:
    """Return a shape's triangles at a pose."""
    vertices = np.ascontiguousarray(shape.vertices @ pose[:3, :3].T + pose[:3, 3])
    return Mesh("", vertices, np.asarray(shape.faces, np.int32))


def merged(meshes: Sequence[Mesh]) -> Mesh:
    """Return several meshes as one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + k for mesh, k in zip(meshes, starts, strict=False)]
    vertices = np.concatenate([mesh.vertices for mesh in meshes])
    return Mesh("", vertices, np.concatenate(faces).astype(np.int32))

"""Planning problems by name, and as plain triangles for the other libraries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.planners.ompl.setup import problem_space
from fgenv.planners.ompl.spaces import StateLayout
from fgenv.planners.problem import Problem

FINE = 0.01  # of the space's extent: OMPL's default resolution
SAMPLES = 2000  # configurations, to compare lengths of steps on


class Triangles(NamedTuple):
    """A mesh as libraries take it, meters."""

    vertices: Floats  # (n, 3)
    faces: NDArray[np.int64]  # (m, 3)


@dataclass(frozen=True)
class Task:
    """Bodies that turn any way, from starts to goals among bodies that stand.

    Attributes:
        name: of the scenario, with `:2` for two robots.
        problem: as planners take it.
        resolution: meters that no point moves farther in a discrete check's step.
    """

    name: str
    problem: Problem
    resolution: float

    @classmethod
    def of(cls, name: str, resolution: float | None = None) -> Task:
        """The task `cubicles` or `cubicles:2`; default resolution: 1 % of the diagonal.

        Raises:
            ValueError: no such scenario; not one of free bodies.
        """
        scenario, _, n = name.partition(":")
        if n and not n.isdecimal():
            raise ValueError(f"problems: got {name!r}, expected a scenario's name, or NAME:ROBOTS")
        problem = Problem.from_scenario(scenario, **({"n": int(n)} if n else {}))
        for robot in problem.models:
            if robot.base != "free" or robot.nq != 7 or (robot.mount != np.eye(4)).any():
                raise ValueError(f"problems: {name!r}: expected robots that are free bodies")
        if resolution is not None and not resolution > 0:
            raise ValueError(f"resolution: got {resolution}, expected meters over 0")
        task = cls(name, problem, resolution or 1.0)
        if any(layout.level for layout in task.layouts):
            raise ValueError(f"problems: {name!r}: expected robots that turn any way")
        return task if resolution else cls(name, problem, FINE * task.extent)

    @cached_property
    def layouts(self) -> list[StateLayout]:
        """How configurations stand in states."""
        return [StateLayout(robot, robot.steering()) for robot in self.problem.models]

    def space(self) -> Any:
        """A new space of OMPL, as `fgenv.planners.setup` makes it: bounds and weights the same."""
        return problem_space(self.problem, self.layouts)

    @property
    def extent(self) -> float:
        """Meters: the diagonal of where the first robot's origin may be."""
        return float(bodies_of(self.space())[0].getSubspaces()[0].getMaximumExtent())

    @cached_property
    def standing(self) -> list[Triangles]:
        """All that stands, in the world."""
        built = self.problem.built
        return [moved(shape, pose) for shape, pose in zip(built.shapes, built.poses, strict=True)]

    @cached_property
    def movers(self) -> list[Triangles]:
        """Each robot, in its own frame."""
        return [
            merged([moved(part.shape, part.origin) for part in robot.parts])
            for robot in self.problem.models
        ]

    @cached_property
    def samples(self) -> Floats:
        """Joint configurations at random within the bounds, (SAMPLES, 7 n)."""
        rng = np.random.default_rng(0)
        low, high = (
            np.array(
                [
                    getattr(space.getBounds(), end)[k]
                    for space in bodies_of(self.space())
                    for k in range(3)
                ]
            ).reshape(-1, 3)
            for end in ("low", "high")
        )
        places = rng.uniform(low, high, (SAMPLES, *low.shape))
        turns = rng.normal(size=(SAMPLES, len(low), 4))
        turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
        return np.concatenate([places, turns], axis=-1).reshape(SAMPLES, -1)

    @property
    def ends(self) -> tuple[Floats, Floats]:
        """Start and goal, joint states (7 n,)."""
        made = [
            np.concatenate([layout.states(q) for layout, q in zip(self.layouts, qs, strict=True)])
            for qs in (self.problem.starts, self.problem.goals)
        ]
        return made[0], made[1]

    def steps(self, q0: Floats, q1: Floats, step: float) -> int:
        """Steps between joint configurations (7 n,) in which no point moves farther."""
        far = [
            float(robot.displacement_bound(q0[7 * i : 7 * i + 7], q1[7 * i : 7 * i + 7]))
            for i, robot in enumerate(self.problem.models)
        ]
        return max(1, int(np.ceil(max(far) / step)))

    def between(self, q0: Floats, q1: Floats, t: Floats) -> Floats:
        """Joint configurations (k, 7 n) at fractions t (k,) of a motion."""
        cut = [slice(7 * i, 7 * i + 7) for i in range(len(self.problem.models))]
        parts = [
            robot.interpolate(q0[s], q1[s], t)
            for robot, s in zip(self.problem.models, cut, strict=True)
        ]
        return np.concatenate(parts, axis=-1)


def bodies_of(space: Any) -> list[Any]:
    """The SE3 spaces in a task's space."""
    first = space.getSubspaces()
    return [space] if hasattr(space, "getBounds") else list(first)


def moved(shape: Any, pose: Floats) -> Triangles:
    """A shape's triangles at a pose."""
    return Triangles(shape.vertices @ pose[:3, :3].T + pose[:3, 3], np.asarray(shape.faces))


def merged(meshes: Sequence[Triangles]) -> Triangles:
    """Several meshes as one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + k for mesh, k in zip(meshes, starts, strict=False)]
    return Triangles(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))

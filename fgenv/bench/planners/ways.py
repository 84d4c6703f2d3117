"""Ways to check the same problem: fgenv's plug-in, and state checkers in Python."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og

from fgenv.planners.ompl.setup import Setup, setup
from fgenv.planners.ompl.states import StateBuffer, capsule, serializer
from fgenv.planners.problem import Problem

from .coal_ import coal_bodies
from .fcl_ import fcl_bodies
from .rigid import Bind
from .task import Task, bodies_of

CERTIFIED, DISCRETE, FCL, COAL = "certified", "discrete", "python-fcl", "coal"
PEERS = {FCL: "fcl", COAL: "coal"}  # and the modules that they need


class PythonChecker(ob.StateValidityChecker):  # type: ignore[misc]
    """Reads a state into a row and checks it for collisions. Counts the checks."""

    def __init__(self, si: Any, collides_in: Bind, size: int) -> None:
        super().__init__(si)
        row = np.empty(size)
        serialize, into = serializer(si), capsule(row)
        collides, counter = collides_in(row), count()
        self.row, self.counter = row, counter

        def valid(state: Any) -> bool:
            next(counter)
            serialize(into, state)
            return not collides()

        self.isValid = valid

    @property
    def checks(self) -> int:
        """States asked so far."""
        return next(self.counter)


class Search:
    """An OMPL `SimpleSetup` ready to be solved, and what counts its checks."""

    def __init__(self, simple: Any, validity: Any) -> None:
        self.simple, self.validity = simple, validity
        self.si = simple.getSpaceInformation()
        self.buffer = StateBuffer(self.si)
        simple.setPlanner(og.RRTConnect(self.si))

    @property
    def motions(self) -> int:
        """Motions checked so far."""
        if isinstance(self.simple, Setup):
            return self.simple.motions.checks
        return int(self.si.getMotionValidator().getCheckedMotionCount())


Way = Callable[[], Search]  # everything of OMPL's is new in each


def ours(problem: Problem, resolution: float | None = None) -> Way:
    """fgenv's plug-in: certified, or discrete at a resolution in meters."""

    def make() -> Search:
        made = setup(problem, resolution=resolution, world=problem.world)
        return Search(made, made.validity)

    return make


def theirs(task: Task, bind: Bind) -> Way:
    """A checker in Python under OMPL's own discrete motion validator."""
    share = same_steps(task)

    def make() -> Search:
        space = task.space()
        simple = og.SimpleSetup(space)
        si = simple.getSpaceInformation()
        set_steps(space, task, share)
        checker = PythonChecker(si, bind, task.samples.shape[1])
        simple.setStateValidityChecker(checker)
        search = Search(simple, checker)
        ends = [search.buffer.write(si.allocState(), q) for q in task.ends]
        simple.setStartAndGoalStates(*ends)
        return search

    return make


def ways_of(task: Task, peers: list[str]) -> dict[str, Way]:
    """All that are raced, by name."""
    makers = {FCL: fcl_bodies, COAL: coal_bodies}
    found = {CERTIFIED: ours(task.problem), DISCRETE: ours(task.problem, task.resolution)}
    return found | {name: theirs(task, makers[name](task)) for name in peers}


def same_steps(task: Task) -> float:
    """How much of the resolution a step of OMPL's may shift a body, and as much turn it.

    fgenv's steps bound shift and turn together; OMPL counts steps for each apart and takes the
    larger number. With this share both take as many steps on random motions, in the mean.
    """
    q0, q1 = np.split(task.samples[:, :7], 2)
    robot = task.problem.models[0]
    shift = np.linalg.norm(q1[:, :3] - q0[:, :3], axis=1)
    turn = robot.displacement_bound(q0, q1) - shift
    return float(np.maximum(shift, turn).mean() / (shift + turn).mean())


def set_steps(space: Any, task: Task, share: float) -> None:
    """Tell OMPL's spaces how long a step may be; its distance of turns is half their angle."""
    for body, robot in zip(bodies_of(space), task.problem.models, strict=True):
        place, turn = body.getSubspaces()
        step = share * task.resolution
        angle = 0.5 * step / max(float(robot.weights[3]), 1e-3)
        for part, length in ((place, step), (turn, angle)):
            part.setLongestValidSegmentFraction(min(length / part.getMaximumExtent(), 1.0))

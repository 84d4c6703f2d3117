"""Methods to check the same problem: fgenv's plug-in, and state checkers in Python."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from itertools import count
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og

from fgenv.planners.ompl.setup import Setup, setup
from fgenv.planners.ompl.states import StateBuffer, capsule, serializer
from fgenv.planners.problem import Problem

from .rigid import Bind
from .task import DiscreteTask, Task

CERTIFIED, DISCRETE, FCL, COAL = "certified", "discrete", "python-fcl", "coal"
ARM = "pinocchio + coal"
PEERS = {FCL: "fcl", COAL: "coal"}  # modules by name


class PythonChecker(ob.StateValidityChecker):  # type: ignore[misc]
    """Reads a state into a row, checks it for collisions and counts the checks."""

    def __init__(self, si: Any, collides_in: Bind, size: int) -> None:
        super().__init__(si)
        row = np.empty(size)
        serialize, target = serializer(si), capsule(row)
        collides, counter = collides_in(row), count()
        self.row, self.counter = row, counter

        def valid(state: Any) -> bool:
            next(counter)
            serialize(target, state)
            return not collides()

        self.isValid = valid

    @property
    def checks(self) -> int:
        """Number of states checked."""
        return next(self.counter)


class Search:
    """An OMPL `SimpleSetup` with RRTConnect, and its counted checker."""

    def __init__(self, simple: Any, validity: Any) -> None:
        self.simple, self.validity = simple, validity
        self.si = simple.getSpaceInformation()
        self.buffer = StateBuffer(self.si)
        simple.setPlanner(og.RRTConnect(self.si))

    @property
    def motions(self) -> int:
        """Number of motions checked."""
        if isinstance(self.simple, Setup):
            return self.simple.motions.checks
        return int(self.si.getMotionValidator().getCheckedMotionCount())


Method = Callable[[], Search]  # makes a new search


def plugin(problem: Problem, resolution: float | None = None) -> Method:
    """Return fgenv's plug-in: certified, or discrete at a resolution in meters."""

    def make() -> Search:
        configured = setup(problem, resolution=resolution, world=problem.world)
        return Search(configured, configured.validity)

    return make


def python_checker(task: DiscreteTask, bind: Bind) -> Method:
    """Return a checker in Python under OMPL's own discrete motion validator."""

    def make() -> Search:
        simple = og.SimpleSetup(task.discrete_space())
        si = simple.getSpaceInformation()
        checker = PythonChecker(si, bind, task.samples.shape[1])
        simple.setStateValidityChecker(checker)
        search = Search(simple, checker)
        simple.setStartAndGoalStates(*(search.buffer.write(si.allocState(), q) for q in task.ends))
        return search

    return make


def methods_of(task: Task, peers: Sequence[str]) -> dict[str, Method]:
    """Return the methods of a comparison by name."""
    methods = {CERTIFIED: plugin(task.problem), DISCRETE: plugin(task.problem, task.resolution)}
    for name in peers:
        module = import_module(f"{__package__}.{PEERS[name]}_")
        methods[name] = python_checker(task, getattr(module, f"{PEERS[name]}_bodies")(task))
    return methods

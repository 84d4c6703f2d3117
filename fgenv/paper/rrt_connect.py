"""OMPL's RRTConnect in SE2 for the experiment's robot; its path is certified before it is used."""

import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from fgenv.arrays import Floats
from fgenv.paper.scene import model_list, robot_shape
from fgenv.paper.timed_path import as_path, radius_of, refine
from fgenv.planners import Certificate, PlanningError, Problem, StateValidityChecker, certify
from fgenv.planners.ompl.states import StateBuffer

RESOLUTIONS = (0.02, 0.005, 0.00125)  # m between checked states; the next if not certified
SAMPLING = 0.02  # m between the configurations whose clearance is measured
SHORTENING_ROUNDS = 4


@dataclass(frozen=True)
class PlanarPlan:
    """A certified path.

    Attributes:
        path: (n, 3), x, y (m), yaw (rad).
        length: meters of the origin's path.
        checks: states checked by OMPL.
        seconds: wall-clock time of the search.
        certificate: of the motion between all configurations of the path.
        nearest: configuration (3,) with the least clearance.
    """

    path: Floats
    length: float
    checks: int
    seconds: float
    certificate: Certificate
    nearest: Floats


def rrt_connect(
    problem: Problem,
    start: ArrayLike,
    *,
    margin: float = 0.0,
    seed: int = 0,
    time_limit: float = 10.0,
) -> PlanarPlan:
    """Plan a path for the problem's robot from a configuration (3,) to its goal.

    The validity checker is the world's `collides` with `margin` meters. OMPL checks motions at
    discrete states; the simplified path is then certified, and planned again at a finer resolution
    if it collides between them. The same seed gives the same path, unless time runs out.

    Raises:
        PlanningError: start or goal collides, or there is no path within `time_limit` seconds.
    """
    began = time.perf_counter()
    built = replace(problem.built, starts=(np.array(start, dtype=np.float64),))
    problem = replace(problem, built=built, world=problem.world.copy(), margin=margin, seed=seed)
    problem.check()
    checks, exact = 0, replace(problem, margin=0.0)
    for resolution in RESOLUTIONS:
        search = _Search(problem, resolution, began + time_limit)
        path = search.solve()
        checks += search.validity.checks
        if path is None:
            raise PlanningError(
                f"no path to {np.round(problem.goals[0], 3).tolist()} within {time_limit:g} s"
                f" ({checks} states checked); give more time, another seed or a wider workspace"
            )
        fine = refine(path, search.radius, SAMPLING)
        certificate = certify(exact, [fine])
        if certificate:
            length = float(np.hypot(*np.diff(path[:, :2], axis=0).T).sum())
            nearest = fine[certificate.nearest[0] if certificate.nearest else 0]
            seconds = time.perf_counter() - began
            return PlanarPlan(path, length, checks, seconds, certificate, nearest)
    raise PlanningError(f"the paths are not free between states {resolution:g} m apart")


class _Search:
    """OMPL's objects for one search; none of them outlives it."""

    def __init__(self, problem: Problem, resolution: float, deadline: float) -> None:
        self.ends = as_path([problem.starts[0], problem.goals[0]])
        self.radius = radius_of(robot_shape(problem).vertices)
        self.seed, self.deadline = problem.seed, deadline
        box = workspace(problem, self.radius)
        limits = ob.RealVectorBounds(2)
        for axis, (low, high) in enumerate(box.T.tolist()):
            limits.setLow(axis, low)
            limits.setHigh(axis, high)
        space = ob.SE2StateSpace()
        space.setBounds(limits)
        # OMPL expects a fraction of each subspace's extent: the rectangle's diagonal, and pi.
        extent = max(float(np.hypot(*(box[1] - box[0]))), math.pi * self.radius)
        self.si = ob.SpaceInformation(space)
        self.si.setStateValidityCheckingResolution(resolution / (2.0 * extent))
        self.validity = StateValidityChecker(
            self.si, problem.names[0], problem.world, margin=problem.margin, steering="straight"
        )
        self.si.setStateValidityChecker(self.validity)
        self.buffer = StateBuffer(self.si)

    def solve(self) -> Floats | None:
        """The simplified path (n, 3), or None without a path in time.

        Raises:
            BaseException: an exception in a validity check, KeyboardInterrupt included.
        """
        level = ou.getLogLevel()
        ou.setLogLevel(ou.LOG_NONE)
        try:
            ou.RNG.setSeed(self.seed + 1)  # OMPL ignores a seed of 0
            path = self._solve()
        finally:
            ou.setLogLevel(level)
        if self.validity.error is not None:
            raise self.validity.error
        return path

    def _solve(self) -> Floats | None:
        setup = og.SimpleSetup(self.si)
        setup.setStartAndGoalStates(*(self._state(q) for q in self.ends))
        setup.setPlanner(og.RRTConnect(self.si))
        setup.solve(ob.PlannerTerminationCondition(self._stop))
        if not setup.haveExactSolutionPath() or self.validity.error is not None:
            return None
        solution = setup.getSolutionPath()
        shorten(og.PathSimplifier(self.si), solution)
        states = [solution.getState(k) for k in range(solution.getStateCount())]
        path = as_path([self.buffer.read(state) for state in states])
        path[:, 2] += self.ends[0, 2] - path[0, 2]  # full turns, which OMPL removes
        return path

    def _stop(self) -> bool:
        return self.validity.error is not None or time.perf_counter() > self.deadline

    def _state(self, q: Floats) -> Any:
        wrapped = [q[0], q[1], (q[2] + math.pi) % (2 * math.pi) - math.pi]
        return self.buffer.write(self.si.allocState(), wrapped)


def shorten(simplifier: Any, path: Any) -> None:
    """Shorten a path in a fixed number of rounds; OMPL's `simplify` depends on the clock."""
    for _ in range(SHORTENING_ROUNDS):
        simplifier.ropeShortcutPath(path)
        simplifier.reduceVertices(path)
        simplifier.partialShortcutPath(path)
    simplifier.reduceVertices(path)


def workspace(problem: Problem, radius: float) -> Floats:
    """Bounds (2, 2) of the robot's origin: its workspace, or room to pass around all bodies."""
    robot = problem.models[0]
    if robot.workspace is not None:
        return robot.workspace
    boxes = [r.bounds[:, :2] for r in model_list(problem.world) if r.robot is None]
    corners = np.concatenate([[problem.starts[0][:2]], [problem.goals[0][:2]], *boxes])
    space = 2.0 * (radius + problem.margin)
    return np.stack([corners.min(axis=0) - space, corners.max(axis=0) + space])

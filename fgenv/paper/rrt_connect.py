"""OMPL's RRTConnect in SE2 for the experiment's robot; its path is certified."""

import math
import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from fgenv.arrays import Floats
from fgenv.paper.scene import model_list, robot_shape
from fgenv.paper.timed_path import as_path, radius_of, refine
from fgenv.planners import (
    Certificate,
    PlanningError,
    Problem,
    StateLayout,
    StateValidityChecker,
    certify,
    state_space,
)
from fgenv.planners.ompl.simplify import simplify
from fgenv.planners.ompl.states import StateBuffer

RESOLUTION = 0.02  # m between checked states, and between measurements of the clearance
YAW_WEIGHT = 0.5  # of OMPL's SE2


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
    margin: float = 0.05,
    seed: int = 0,
    time_limit: float = 10.0,
) -> PlanarPlan:
    """Plan a path for the problem's robot from a configuration (3,) to its goal.

    The validity checker is the world's `collides` with `margin` meters. OMPL checks motions at
    states in which no point of the robot moves more than 20 mm: a margin over that keeps the
    motion between them free. The same seed gives the same path, unless time runs out.

    Raises:
        PlanningError: start or goal collides, there is no path within `time_limit` seconds, or the
            path is not free.
        BaseException: an exception in a check, KeyboardInterrupt included.
    """
    began = time.perf_counter()
    built = replace(problem.built, starts=(np.array(start, dtype=np.float64),))
    problem = replace(problem, built=built, margin=margin)
    problem.check()
    radius = radius_of(robot_shape(problem).vertices)
    level = ou.getLogLevel()
    ou.setLogLevel(ou.LOG_NONE)
    try:
        ou.RNG.setSeed(seed + 1)  # OMPL ignores a seed of 0
        path, checks, error = _search(problem, radius, began + time_limit)
    finally:
        ou.setLogLevel(level)
    if error is not None:
        raise error
    if path is None:
        raise PlanningError(
            f"no path to {np.round(problem.goals[0], 3).tolist()} within {time_limit:g} s"
            f" ({checks} states checked); give more time, another seed or a wider workspace"
        )
    fine = refine(path, radius, RESOLUTION)
    certificate = certify(problem, [fine], margin=0.0)
    if not certificate:
        raise PlanningError("the path is not free between the checked states; give more margin")
    length = float(np.hypot(*np.diff(path[:, :2], axis=0).T).sum())
    nearest = fine[certificate.nearest[0] if certificate.nearest else 0]
    return PlanarPlan(path, length, checks, time.perf_counter() - began, certificate, nearest)


def _search(
    problem: Problem, radius: float, deadline: float
) -> tuple[Floats | None, int, BaseException | None]:
    """A simplified path (n, 3) if there is one in time, the number of checked states, an error.

    The error is returned: its traceback would keep OMPL's objects alive.
    """
    robot, box = problem.models[0], workspace(problem, radius)
    layout = StateLayout(robot, robot.steering("straight"))
    space = state_space(layout, box)
    space.setSubspaceWeight(1, YAW_WEIGHT)
    si = ob.SpaceInformation(space)
    # OMPL expects a fraction of each subspace's extent: the rectangle's diagonal, and pi.
    extent = max(float(np.hypot(*(box[1] - box[0]))), math.pi * radius)
    si.setStateValidityCheckingResolution(RESOLUTION / (2.0 * extent))
    validity = StateValidityChecker(
        si, problem.names[0], problem.world, margin=problem.margin, steering="straight"
    )
    si.setStateValidityChecker(validity)
    buffer, ends = StateBuffer(si), (problem.starts[0], problem.goals[0])
    setup = og.SimpleSetup(si)
    setup.setStartAndGoalStates(*(buffer.write(si.allocState(), layout.states(q)) for q in ends))
    setup.setPlanner(og.RRTConnect(si))
    stop = ob.PlannerTerminationCondition(
        lambda: validity.error is not None or time.perf_counter() > deadline
    )
    setup.solve(stop)
    path = None
    if setup.haveExactSolutionPath() and validity.error is None:
        solution = setup.getSolutionPath()
        simplify(si, solution)
        path = as_path([buffer.read(state) for state in solution.getStates()])
        path[:, 2] += ends[0][2] - path[0, 2]  # full turns, which OMPL removes
    return path, validity.checks, validity.error


def workspace(problem: Problem, radius: float) -> Floats:
    """Bounds (2, 2) of the robot's origin: its workspace, or room to pass around all bodies."""
    bounds = problem.models[0].workspace
    if bounds is not None:
        return bounds
    boxes = [r.bounds[:, :2] for r in model_list(problem.world) if r.robot is None]
    corners = np.concatenate([[problem.starts[0][:2]], [problem.goals[0][:2]], *boxes])
    space = 2.0 * (radius + problem.margin)
    return np.stack([corners.min(axis=0) - space, corners.max(axis=0) + space])

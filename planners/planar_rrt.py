"""OMPL's RRTConnect in SE2 with a Python validity checker, as plain arrays.

OMPL objects never leave this file. What its Python bindings ask for is done here: the checker
returns a real bool, an error in it is kept and raised after the solver has returned, the random
numbers are seeded before anything is built, the path is copied before anything is freed.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats
from fgenv.planners.errors import PlanningError
from fgenv.scenarios.se2 import as_path, refine

Valid = Callable[[float, float, float], bool]


@dataclass(frozen=True)
class PlanarPlan:
    """A path (n, 3) of x, y (m), yaw (rad), its length (m), and what it took to find it."""

    path: Floats
    length: float
    checks: int
    seconds: float
    seed: int


class _Latch:
    """A validity checker for OMPL: counts, and keeps the first error instead of raising it."""

    def __init__(self, valid: Valid, seconds: float) -> None:
        self.valid = valid
        self.deadline = time.monotonic() + seconds
        self.checks = 0
        self.error: BaseException | None = None

    def __call__(self, state: Any) -> bool:
        self.checks += 1
        if self.error is not None:
            return False
        try:
            return bool(self.valid(state.getX(), state.getY(), state.getYaw()))
        except BaseException as error:
            self.error = error
            return False

    def stop(self) -> bool:
        return self.error is not None or time.monotonic() > self.deadline


def rrt_connect(
    valid: Valid,
    start: ArrayLike,
    goal: ArrayLike,
    bounds: ArrayLike,
    *,
    radius: float = 1.0,
    resolution: float = 0.02,
    seed: int = 0,
    time_limit: float = 10.0,
    proof: Callable[[Floats], bool] | None = None,
) -> PlanarPlan:
    """PlanarPlan from start to goal (x, y, yaw each) within bounds (2, 2): least and greatest x, y.

    `valid(x, y, yaw)` says whether a configuration is free. Motions are checked every
    `resolution` meters, of a body whose points lie within `radius` meters of its z axis. Then
    `proof(path)` has to say that the whole simplified path (n, 3) is free; without one its states
    are checked four times finer. Where it fails, it is planned anew at that resolution. Same seed,
    same path, unless the time limit (s) cuts the search short.

    Raises PlanningError (start or goal not valid or out of bounds, no path in time), ValueError
    for bad arguments, and whatever `valid` raises.
    """
    ends = as_path([_configuration("start", start), _configuration("goal", goal)])
    box = np.asarray(bounds, dtype=np.float64)
    if box.shape != (2, 2) or not (box[0] < box[1]).all():
        raise ValueError(f"bounds: got {bounds!r}, want (2, 2): least x, y below greatest x, y")
    if not (resolution > 0 and radius > 0 and time_limit > 0 and seed >= 0):
        raise ValueError("resolution, radius, time_limit: want > 0; seed: want >= 0")
    for name, q in zip(("start", "goal"), ends, strict=True):
        if not ((box[0] <= q[:2]) & (q[:2] <= box[1])).all():
            raise PlanningError(f"{name} {_show(q)} is outside the bounds {box.tolist()}")
        if not valid(*q.tolist()):
            raise PlanningError(f"{name} {_show(q)} is not valid")
    began, latch = time.perf_counter(), _Latch(valid, time_limit)
    for fine in (resolution, resolution / 4, resolution / 16):
        path = _solve(latch, ends, box, radius, fine, seed)
        if path is None:
            raise PlanningError(
                f"no path from {_show(ends[0])} to {_show(ends[1])} within {time_limit:g} s "
                f"({latch.checks} checks): give a longer time_limit, wider bounds or another seed"
            )
        finer = refine(path, radius, fine / 4).tolist()
        if proof(path) if proof else all(latch.valid(*q) for q in finer):
            length = float(np.hypot(*np.diff(path[:, :2], axis=0).T).sum())
            return PlanarPlan(path, length, latch.checks, time.perf_counter() - began, seed)
    raise PlanningError(
        f"the paths found are not free between states {resolution / 16:g} m apart: "
        "give a finer resolution"
    )


def _solve(
    latch: _Latch, ends: Floats, box: Floats, radius: float, resolution: float, seed: int
) -> Floats | None:
    """One search and simplification: a path (n, 3), or None where there was no time for one."""
    from ompl import base as ob
    from ompl import geometric as og
    from ompl import util as ou

    loud = ou.getLogLevel()
    ou.setLogLevel(ou.LOG_NONE)
    try:
        ou.RNG.setSeed(seed + 1)  # OMPL ignores a seed of 0
        setup = _setup(latch, ends, box, radius, resolution)
        setup.solve(ob.PlannerTerminationCondition(latch.stop))
        found = setup.haveExactSolutionPath() and latch.error is None
        if found:
            solution = setup.getSolutionPath()
            _simplify(og.PathSimplifier(setup.getSpaceInformation()), solution)
    finally:
        ou.setLogLevel(loud)
    if latch.error is not None:
        raise latch.error
    if not found:
        return None
    states = [solution.getState(i) for i in range(solution.getStateCount())]
    path = as_path([(s.getX(), s.getY(), s.getYaw()) for s in states])
    path[:, 2] += ends[0, 2] - path[0, 2]  # whole turns, which OMPL takes away
    return path


def _setup(latch: _Latch, ends: Floats, box: Floats, radius: float, resolution: float) -> Any:
    """OMPL's objects for one search."""
    from ompl import base as ob
    from ompl import geometric as og

    space = ob.SE2StateSpace()
    limits = ob.RealVectorBounds(2)
    for axis in range(2):
        limits.setLow(axis, float(box[0, axis]))
        limits.setHigh(axis, float(box[1, axis]))
    space.setBounds(limits)
    setup = og.SimpleSetup(space)
    info = setup.getSpaceInformation()
    setup.setStateValidityChecker(latch)
    # OMPL wants a fraction of each subspace's extent: the rectangle's diagonal, and pi.
    extent = max(float(np.hypot(*(box[1] - box[0]))), np.pi * radius)
    info.setStateValidityCheckingResolution(resolution / (2.0 * extent))
    setup.setStartAndGoalStates(_state(info, ends[0]), _state(info, ends[1]))
    setup.setPlanner(og.RRTConnect(info))
    return setup


def _simplify(simplifier: Any, path: Any) -> None:
    """Shorten a path by counted steps: OMPL's own `simplify` stops by the clock."""
    for _ in range(4):
        simplifier.ropeShortcutPath(path)
        simplifier.reduceVertices(path)
        simplifier.partialShortcutPath(path)
    simplifier.reduceVertices(path)


def _state(info: Any, q: Floats) -> Any:
    state = info.allocState()
    state.setX(float(q[0]))
    state.setY(float(q[1]))
    state.setYaw(float((q[2] + np.pi) % (2 * np.pi) - np.pi))
    return state


def _configuration(name: str, q: ArrayLike) -> Floats:
    array = np.asarray(q, dtype=np.float64)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name}: got {q!r}, want finite x, y, yaw")
    return array


def _show(q: Floats) -> str:
    return "(" + ", ".join(f"{v:.3f}" for v in q) + ")"

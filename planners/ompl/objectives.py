"""Optimization objectives: path length, clearance, time."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from ompl import base as ob

from fgenv.planners.timing import full_speed_time, leg_limits
from fgenv.scenarios.errors import near

from .setup import Setup
from .spaces import configurations_of

MIN_CLEARANCE = 1e-3  # m; a smaller clearance costs as much
OBJECTIVES = ("length", "clearance", "time")


def objective_of(name: str, ss: Setup) -> Any:
    """Return OMPL's objective of a name.

    `length`: path length in the space's metric. `clearance`: integral of the inverse clearance
    (meters) along the path. `time`: seconds at full speed, of the slowest robot on each motion.

    Raises:
        ValueError: unknown name.
    """
    si = ss.getSpaceInformation()
    if name == "length":
        return ob.PathLengthOptimizationObjective(si)
    if name == "clearance":
        return ClearanceObjective(si, ss)
    if name == "time":
        return TimeObjective(si, ss)
    raise ValueError(f"objective: got {name!r}; {near(name, OBJECTIVES)}")


class ClearanceObjective(ob.StateCostIntegralObjective):  # type: ignore[misc]
    """Integral of the inverse clearance along the path."""

    def __init__(self, si: Any, ss: Setup) -> None:
        super().__init__(si, True)
        self._clearance = ss.validity.clearance

    def stateCost(self, state: Any) -> Any:  # noqa: N802
        """Inverse clearance of a state, 1/m."""
        return ob.Cost(1.0 / max(self._clearance(state), MIN_CLEARANCE))


class TimeObjective(ob.OptimizationObjective):  # type: ignore[misc]
    """Time at full speed along the robots' steering; the slowest robot counts on each motion."""

    def __init__(self, si: Any, ss: Setup) -> None:
        super().__init__(si)
        # A reference to the set-up would be a cycle through OMPL that is never freed.
        self._read, self._layouts, self._dt = ss.buffer.read, ss.layouts, ss.problem.dt

    def stateCost(self, state: Any) -> Any:  # noqa: N802
        """Zero: only motions have a cost."""
        return ob.Cost(0.0)

    def motionCost(self, a: Any, b: Any) -> Any:  # noqa: N802
        """Seconds from one state to another."""
        slowest = 0.0
        ends = (configurations_of(self._layouts, self._read(state)) for state in (a, b))
        for layout, q0, q1 in zip(self._layouts, *ends, strict=True):
            rows = layout.robot.steer(q0, q1, layout.steering.method)
            limits = [leg_limits(layout.robot, *leg, self._dt) for leg in pairwise(rows)]
            slowest = max(slowest, sum(map(full_speed_time, limits)))
        return ob.Cost(slowest)

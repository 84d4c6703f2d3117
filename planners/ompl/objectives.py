"""What a planner makes least: length, nearness, or time."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from ompl import base as ob

from fgenv.planners.steering import legs
from fgenv.planners.timing import amounts_of, seconds

from .plugin import Setup

NEAREST = 1e-3  # meters: nearer counts as this near
OBJECTIVES = ("length", "clearance", "time")


def objective_of(name: str, made: Setup) -> Any:
    """OMPL's objective of that name.

    `length`: of the path, as the space measures it. `clearance`: the integral of one by the
    clearance (meters) along the path. `time`: seconds that the robots need at full speed.

    Raises:
        ValueError: the name is not known.
    """
    si = made.getSpaceInformation()
    if name == "length":
        return ob.PathLengthOptimizationObjective(si)
    if name == "clearance":
        return Nearness(si, made)
    if name == "time":
        return Seconds(si, made)
    raise ValueError(f"objective: got {name!r}, expected one of {', '.join(OBJECTIVES)}")


class Nearness(ob.StateCostIntegralObjective):  # type: ignore[misc]
    """One by the clearance, integrated along the path."""

    def __init__(self, si: Any, made: Setup) -> None:
        super().__init__(si, True)
        self._clearance = made.validity.clearance

    def stateCost(self, state: Any) -> Any:  # noqa: N802
        """Of one state."""
        return ob.Cost(1.0 / max(self._clearance(state), NEAREST))


class Seconds(ob.OptimizationObjective):  # type: ignore[misc]
    """Time at full speed on the ways that robots take, of the slowest one on each motion."""

    def __init__(self, si: Any, made: Setup) -> None:
        super().__init__(si)
        self._read, self._layouts, self._dt = made.buffer.read, made.layouts, made.problem.dt

    def stateCost(self, state: Any) -> Any:  # noqa: N802
        """None of a state."""
        return ob.Cost(0.0)

    def motionCost(self, a: Any, b: Any) -> Any:  # noqa: N802
        """Seconds from one state to another."""
        slowest, k = 0.0, 0
        start, end = self._read(a), self._read(b)
        for layout in self._layouts:
            part = slice(k, k := k + layout.size)
            q0, q1 = (layout.configurations(state[part]) for state in (start, end))
            rows = legs(layout.robot, q0, q1, layout.steering.way)
            each = [amounts_of(layout.robot, *leg, self._dt) for leg in pairwise(rows)]
            slowest = max(slowest, sum(map(seconds, each)))
        return ob.Cost(slowest)

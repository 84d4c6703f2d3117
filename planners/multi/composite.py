"""Composite planning: one OMPL search in the joint space of one or more robots."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.planners.deadline import Deadline
from fgenv.planners.errors import PlanningError
from fgenv.planners.ompl.objectives import objective_of
from fgenv.planners.ompl.setup import Setup, setup
from fgenv.planners.ompl.simplify import simplified, steered
from fgenv.planners.problem import Problem
from fgenv.scenarios.errors import near

PLANNERS = (
    "RRT", "RRTConnect", "RRTstar", "InformedRRTstar", "SORRTstar", "AORRTC", "BITstar",
    "PRM", "PRMstar", "FMT", "BFMT", "KPIECE1", "BKPIECE1", "LBKPIECE1",
)  # fmt: skip
SEARCH_SHARE = 0.9  # of the time limit, where a simplification follows


@dataclass(frozen=True)
class JointPath:
    """Waypoints of robots in their joint space: all robots are at waypoint k at the same time.

    Attributes:
        robots: places of the robots in the problem.
        paths: (m, nq) of each robot; straight between waypoints.
        facts: `seconds` in total, `found_after` (s), `search` (CPU seconds of OMPL), numbers of
            checked states, motions and pairs of bodies (after masks), waypoints before
            simplification, vertices and edges of the planner's graph.
        graph: the planner's graph, if requested.
    """

    robots: tuple[int, ...]
    paths: tuple[Floats, ...]
    facts: dict[str, Any] = field(default_factory=dict)
    graph: PlannerGraph | None = None


@dataclass(frozen=True)
class PlannerGraph:
    """Tree or roadmap that a planner has built.

    Attributes:
        states: joint states, (n, size); `Setup.configurations` splits them by robot.
        edges: (m, 2), states from and to.
    """

    states: Floats
    edges: NDArray[np.int64]


def plan_composite(
    problem: Problem,
    robots: Sequence[int] | None = None,
    *,
    planner: str = "RRTConnect",
    time_limit: float = 10.0,
    simplify: bool = True,
    objective: str | None = None,
    motions: int = 0,
    steering: str | None = None,
    world: World | None = None,
    graph: bool = False,
) -> JointPath:
    """Plan robots in their joint space; the other robots stand at their starts.

    Args:
        robots: places of the robots in the problem; all by default.
        planner: one of `PLANNERS`.
        time_limit: seconds; the search has 0.9 of them if the path is simplified. Optimizing
            planners use all of their time.
        simplify: shorten the path.
        objective: `length`, `clearance` or `time`; the planner's own by default.
        motions: maximum number of checked motions; 0: unlimited.
        steering: see `MotionValidator`.
        world: world to plan in; a copy of the problem's by default.
        graph: return the planner's graph.

    Raises:
        PlanningError: no path within the time limit; start or goal in collision.
        ValueError: unknown planner or objective.
    """
    _check_arguments(planner, objective, time_limit)
    robots = tuple(range(len(problem.names)) if robots is None else robots)
    began, deadline = time.perf_counter(), Deadline.after(time_limit)
    search_time = time_limit * (SEARCH_SHARE if simplify else 1.0)
    with _seeded(problem.seed):
        ss = setup(problem, robots, steering=steering, world=world)
        cpu = time.process_time()
        states = _search(ss, planner, objective, search_time, motions)
        cpu = time.process_time() - cpu
        found_after = time.perf_counter() - began
        if states is None:
            names = ", ".join(problem.names[i] for i in robots)
            raise PlanningError(
                f"no path for {names} within {found_after:.3g} s by {planner}"
                f" ({ss.motions.checks} motions checked): allow more time, or use another planner"
                " or seed"
            )
        facts = {"planner": planner, "found_after": found_after, "search": cpu}
        facts["waypoints_found"] = len(states)
        if simplify:
            states = simplified(ss, states, deadline)
    data = _planner_data(ss, graph or planner != "BITstar")  # OMPL 2.0.1: BITstar's data leaks
    facts |= {"seconds": time.perf_counter() - began, **_counts(ss, data)}
    return JointPath(robots, steered(ss, states), facts, _graph(ss, data) if graph else None)


def _check_arguments(planner: str, objective: str | None, time_limit: float) -> None:
    if planner not in PLANNERS:
        raise ValueError(f"planner: got {planner!r}, which is unknown; {near(planner, PLANNERS)}")
    if planner in ("PRM", "PRMstar") and objective in ("clearance", "time"):
        raise ValueError(
            f"objective: {objective!r} deadlocks {planner}, since its second thread"
            " computes costs; expected 'length', or another planner"
        )
    if not 0 < time_limit < math.inf:
        raise ValueError(f"time_limit: got {time_limit}, expected finite seconds over 0")


@contextmanager
def _seeded(seed: int) -> Iterator[None]:
    """Seed OMPL's random numbers, and silence its log."""
    level = ou.getLogLevel()
    ou.setLogLevel(ou.LOG_NONE)
    try:
        ou.RNG.setSeed(seed % (2**31 - 2) + 1)  # OMPL ignores a seed of 0
        yield
    finally:
        ou.setLogLevel(level)


def _search(
    ss: Setup, planner: str, objective: str | None, time_limit: float, motions: int
) -> Floats | None:
    """States of the solution, or None; after an interrupt, the best solution so far if any."""
    if objective is not None:
        ss.setOptimizationObjective(objective_of(objective, ss))
    space = ss.getStateSpace()
    if "KPIECE" in planner and not space.hasDefaultProjection():  # compound spaces have none
        space.registerDefaultProjection(ob.SubspaceProjectionEvaluator(space, 0))
    ss.setPlanner(getattr(og, planner)(ss.getSpaceInformation()))
    try:
        ss.solve(time_limit, motions)
    except KeyboardInterrupt:
        if not ss.haveExactSolutionPath():
            raise
    except RuntimeError as error:  # some planners do not support compound spaces
        raise PlanningError(
            f"{planner} does not support this problem: {error}; use another planner"
        ) from None
    if not ss.haveExactSolutionPath():
        return None
    states = ss.states_of(ss.getSolutionPath())
    ends = np.stack([ss.states(ss.problem.starts), ss.states(ss.problem.goals)])
    if np.allclose(states[[0, -1]], ends, atol=1e-9):
        return states
    # AORRTC of OMPL 2.0.1 returns the goal twice where the straight motion is free.
    return ends if ss.motions._core.free(*ends) else None


def _counts(ss: Setup, data: Any) -> dict[str, int]:
    return {
        "states_checked": ss.validity.checks,
        "motions_checked": ss.motions.checks,
        "pairs_checked": ss.world._core.tests(),
        "vertices": data.numVertices(),
        "edges": data.numEdges(),
    }


def _planner_data(ss: Setup, filled: bool) -> Any:
    data = ob.PlannerData(ss.getSpaceInformation())
    if filled:
        ss.getPlannerData(data)
        data.decoupleFromPlanner()  # the planner would free its states
    return data


def _graph(ss: Setup, data: Any) -> PlannerGraph:
    vertices = range(data.numVertices())
    states = np.array([ss.buffer.read(data.getVertex(k).getState()) for k in vertices])
    edges = [(k, int(to)) for k in vertices for to in data.getEdges(k)]
    return PlannerGraph(
        states.reshape(-1, ss.buffer.size), np.array(edges, dtype=np.int64).reshape(-1, 2)
    )

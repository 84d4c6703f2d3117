"""One search by a planner of OMPL in the joint space of one robot or several: `composite`."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.planners.errors import PlanningError
from fgenv.planners.ompl.objectives import objective_of
from fgenv.planners.ompl.plugin import Setup, setup
from fgenv.planners.problem import Problem
from fgenv.planners.steering import legs

PLANNERS = (
    "RRT", "RRTConnect", "RRTstar", "InformedRRTstar", "SORRTstar", "AORRTC", "BITstar",
    "PRM", "PRMstar", "FMT", "BFMT", "KPIECE1", "BKPIECE1", "LBKPIECE1",
)  # fmt: skip
ROUNDS = 4  # of shortening


@dataclass(frozen=True)
class Route:
    """Way points of robots that go together: all are at way point k at once.

    Attributes:
        which: places of the robots in the problem.
        paths: (m, nq) each; straight from one to the next.
        facts: `seconds` in all, `found_after` so many; `search`, CPU seconds in OMPL; states,
            motions and pairs of bodies checked (those that masks left); way points found before
            shortening; size of the planner's graph.
        graph: what the planner has grown, if it was asked for.
    """

    which: tuple[int, ...]
    paths: tuple[Floats, ...]
    facts: dict[str, Any] = field(default_factory=dict)
    graph: Graph | None = None


@dataclass(frozen=True)
class Graph:
    """What a planner has grown.

    Attributes:
        states: joint states, (n, size); `Setup.configurations` parts them by robots.
        edges: (m, 2), places in `states`, from and to.
    """

    states: Floats
    edges: NDArray[np.int64]


def composite(
    problem: Problem,
    which: Sequence[int] | None = None,
    *,
    planner: str = "RRTConnect",
    time_limit: float = 10.0,
    simplify: bool = True,
    objective: str | None = None,
    motions: int = 0,
    steering: str | None = None,
    world: World | None = None,
    graph: bool = False,
) -> Route:
    """Plan robots in their joint space, the others standing at their starts.

    Args:
        which: places of the robots; all if left out.
        planner: of `PLANNERS`.
        time_limit: seconds of the search; a planner that looks for the best path takes it all.
            Shortening comes on top.
        objective: `length`, `clearance` or `time`; None: the planner's own.
        motions: at most so many checks of motions, 0 for any number.
        world: to plan in; a copy of the problem's if left out.
        graph: keep what the planner has grown.

    Raises:
        PlanningError: no path in time; start or goal in collision.
        ValueError: planner or objective not known.
    """
    if planner not in PLANNERS:
        from fgenv.scenarios.errors import near

        raise ValueError(f"planner: {planner!r} is not known; {near(planner, PLANNERS)}")
    if planner in ("PRM", "PRMstar") and objective in ("clearance", "time"):
        raise ValueError(
            f"objective: {objective!r} blocks {planner}, whose second thread asks for it;"
            " expected 'length', or another planner"
        )
    if not 0 < time_limit < math.inf:
        raise ValueError(f"time_limit: got {time_limit}, expected finite seconds over 0")
    which = tuple(range(len(problem.names)) if which is None else which)
    began = time.perf_counter()
    level = ou.getLogLevel()
    ou.setLogLevel(ou.LOG_NONE)
    try:
        ou.RNG.setSeed(problem.seed % (2**31 - 2) + 1)  # OMPL ignores a seed of 0
        made = setup(problem, which, steering=steering, world=world)
        search = time.process_time()
        states = _search(made, planner, objective, time_limit, motions)
        search = time.process_time() - search
        found_after = time.perf_counter() - began
        if states is None:
            names = ", ".join(problem.names[i] for i in which)
            raise PlanningError(
                f"no path for {names} within {found_after:.3g} s by {planner}"
                f" ({made.motions.checks} motions checked): give more time, another planner or seed"
            )
        raw = len(states)
        if simplify:
            states = shortened(made, states)
    finally:
        ou.setLogLevel(level)
    data = ob.PlannerData(made.getSpaceInformation())
    if graph or planner != "BITstar":  # asked for it, OMPL 2.0.1's never lets go of the problem
        made.getPlannerData(data)
        data.decoupleFromPlanner()  # its states die with the planner
    facts = {
        "planner": planner,
        "seconds": time.perf_counter() - began,
        "found_after": found_after,
        "search": search,
        "states_checked": made.validity.checks,
        "motions_checked": made.motions.checks,
        "pairs_checked": made.world._core.tests(),
        "way_points_found": raw,
        "vertices": data.numVertices(),
        "edges": data.numEdges(),
    }
    return Route(which, passed(made, states), facts, _graph(made, data) if graph else None)


def _search(
    made: Setup, planner: str, objective: str | None, time_limit: float, motions: int
) -> Floats | None:
    """The solution's states, or None; interrupted, the best so far if there is one."""
    si = made.getSpaceInformation()
    if objective is not None:
        made.setOptimizationObjective(objective_of(objective, made))
    if planner in ("KPIECE1", "BKPIECE1", "LBKPIECE1"):
        _project(made.getStateSpace())
    made.setPlanner(getattr(og, planner)(si))
    try:
        made.solve(time_limit, motions)
    except KeyboardInterrupt:
        if not made.haveExactSolutionPath():
            raise
    except RuntimeError as error:  # some do not plan in compound spaces
        raise PlanningError(
            f"{planner} does not plan here: {error}; take another planner"
        ) from None
    if not made.haveExactSolutionPath():
        return None
    states = made.path()
    ends = np.stack([made.states(made.problem.starts), made.states(made.problem.goals)])
    if np.allclose(states[[0, -1]], ends, atol=1e-9):
        return states
    # AORRTC of OMPL 2.0.1 gives goal and goal where nothing is in the way.
    return ends if made.motions._core.free(*ends) else None


def _project(space: Any) -> None:
    """Compound spaces have no projection of their own."""
    if not space.hasDefaultProjection():
        space.registerDefaultProjection(ob.SubspaceProjectionEvaluator(space, 0))


def _graph(made: Setup, data: Any) -> Graph:
    count = range(data.numVertices())
    states = np.array([made.buffer.read(data.getVertex(k).getState()) for k in count])
    edges = [(k, int(to)) for k in count for to in data.getEdges(k)]
    return Graph(
        states.reshape(-1, made.buffer.size), np.array(edges, dtype=np.int64).reshape(-1, 2)
    )


def shortened(made: Setup, states: Floats) -> Floats:
    """A shorter path, whose edges are free again; by counted steps, since OMPL's own goes by time.

    Where robots turn or steer, only way points are left out: between two of them OMPL would cut
    where they do not go.
    """
    si = made.getSpaceInformation()
    simplifier = og.PathSimplifier(si)
    path = _path(made, states)
    straight = all(layout.steering.way == "straight" for layout in made.layouts)
    for _ in range(ROUNDS):
        if straight:
            simplifier.ropeShortcutPath(path)
        simplifier.reduceVertices(path)
        if straight:
            simplifier.partialShortcutPath(path)
    simplifier.reduceVertices(path)
    if made.motions.error is not None:
        raise made.motions.error
    count = path.getStateCount()
    shorter = np.array([made.buffer.read(path.getState(k)) for k in range(count)])
    return shorter if made.motions._core.free(shorter[:-1], shorter[1:]).all() else states


def _path(made: Setup, states: Floats) -> Any:
    si = made.getSpaceInformation()
    path = og.PathGeometric(si)
    for row in states:
        path.append(made.buffer.write(si.allocState(), row))
    return path


def passed(made: Setup, states: Floats) -> tuple[Floats, ...]:
    """What each robot passes along joint states, (m, nq) each, the legs of its steering among it.

    Robots with different numbers of legs take equal times for each of theirs.
    """
    rows = made.configurations(states)
    first = [made.problem.starts[i] for i in made.which]
    last = [made.problem.goals[i] for i in made.which]
    for path, start, goal in zip(rows, first, last, strict=True):
        path[0], path[-1] = start, goal
    out: list[list[Floats]] = [[path[:1]] for path in rows]
    for k in range(len(states) - 1):
        edges = [
            legs(layout.robot, path[k], path[k + 1], layout.steering.way)
            for layout, path in zip(made.layouts, rows, strict=True)
        ]
        ends = np.unique(np.concatenate([np.arange(1, len(e)) / (len(e) - 1) for e in edges]))
        for layout, edge, passes in zip(made.layouts, edges, out, strict=True):
            at = ends * (len(edge) - 1)
            leg = np.minimum(at.astype(int), len(edge) - 2)
            passes.append(layout.robot.interpolate(edge[leg], edge[leg + 1], at - leg))
    return tuple(np.concatenate(passes) for passes in out)

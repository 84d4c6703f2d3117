"""Simplification of OMPL's paths, and waypoints along the robots' steering."""

from __future__ import annotations

from typing import Any

import numpy as np
from ompl import geometric as og

from fgenv.arrays import Floats
from fgenv.planners.deadline import NEVER, Deadline

from .setup import Setup

ROUNDS = 4
ROPE_STEPS = 32  # states along a path between which shortcuts are tried


def simplified(ss: Setup, states: Floats, deadline: Deadline) -> Floats:
    """Shorten a path of joint states (m, size) until a deadline; its motions are checked again.

    Where robots steer, only vertices are removed: OMPL's shortcuts interpolate along straight
    motions.
    """
    path = _path(ss, states)
    straight = all(layout.steering.method == "straight" for layout in ss.layouts)
    simplify(ss.getSpaceInformation(), path, straight, deadline)
    if ss.motions.error is not None:
        raise ss.motions.error
    shorter = ss.states_of(path)
    return shorter if ss.motions._core.free(shorter[:-1], shorter[1:]).all() else states


def simplify(si: Any, path: Any, shortcuts: bool = True, deadline: Deadline = NEVER) -> None:
    """Shorten OMPL's path in place, by shortcuts, if given, and by removing vertices.

    The number of steps is fixed, unlike in OMPL's own simplification, up to the deadline.
    """
    simplifier = og.PathSimplifier(si)

    def rope_shortcut(path: Any) -> None:
        # The step is a part of the path: the work does not depend on the unit of length.
        simplifier.ropeShortcutPath(path, path.length() / ROPE_STEPS)

    round_of_steps = [simplifier.reduceVertices]
    if shortcuts:
        round_of_steps = [rope_shortcut, simplifier.reduceVertices, simplifier.partialShortcutPath]
    for step in [*(ROUNDS * round_of_steps), simplifier.reduceVertices]:
        if deadline.left < 0:
            return
        step(path)


def _path(ss: Setup, states: Floats) -> Any:
    si = ss.getSpaceInformation()
    path = og.PathGeometric(si)
    for row in states:
        path.append(ss.buffer.write(si.allocState(), row))
    return path


def steered(ss: Setup, states: Floats) -> tuple[Floats, ...]:
    """Waypoints (m, nq) of each robot along joint states, with the legs of its steering.

    All legs of a robot between two states take equal times.
    """
    paths = ss.configurations(states)
    for i, path in zip(ss.robots, paths, strict=True):
        path[0], path[-1] = ss.problem.starts[i], ss.problem.goals[i]
    out: list[list[Floats]] = [[path[:1]] for path in paths]
    for k in range(len(states) - 1):
        edges = [
            layout.robot.steer(path[k], path[k + 1], layout.steering.method)
            for layout, path in zip(ss.layouts, paths, strict=True)
        ]
        ends = np.unique(np.concatenate([np.arange(1, len(e)) / (len(e) - 1) for e in edges]))
        for layout, edge, rows in zip(ss.layouts, edges, out, strict=True):
            at = ends * (len(edge) - 1)
            leg = np.minimum(at.astype(int), len(edge) - 2)
            rows.append(layout.robot.interpolate(edge[leg], edge[leg + 1], at - leg))
    return tuple(np.concatenate(rows) for rows in out)

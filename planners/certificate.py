"""Proof that a timed path is free: every robot's motion in every step, all of them at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision.world import TOLERANCE

from .problem import Problem

ROOM = 1e-4  # meters that the least clearance is found to
ROUNDS = 12  # of halving


@dataclass(frozen=True)
class Certificate:
    """What is proved of a timed path.

    Attributes:
        proved: all motions are free, and more than `margin` meters from everything all along.
        margin: meters; a robot's own links only may not touch.
        least: meters that nobody comes nearer on the way: a bound that is proved, within 0.1 mm
            of what the steps' ends show, or as near as was looked; infinite where nobody is near.
        steps: that were proved.
        failed: the first step that is not proved, or None.
        nearest: who is nearest to whom at the end of which step, as (step, robot, other), or None.
    """

    proved: bool
    margin: float
    least: float
    steps: int
    failed: int | None = None
    nearest: tuple[int, str, str] | None = None

    def __bool__(self) -> bool:
        return self.proved


def certify(
    problem: Problem, configurations: Sequence[Floats], margin: float | None = None
) -> Certificate:
    """Prove the motion of all robots from step to step, (k + 1, nq) each, at once.

    Robots that vanish at their goals are gone from the step on in which they come to rest there.

    Args:
        margin: meters to keep; the problem's if left out.

    Raises:
        ValueError: not one array (k + 1, nq) for each of the problem's robots.
    """
    _fit(problem, configurations)
    margin = problem.margin if margin is None else margin
    steps = len(configurations[0]) - 1
    least, nearest = np.inf, None
    for first, last, present in _phases(problem, configurations):
        rows = np.concatenate([configurations[i][first : last + 1] for i in present], axis=1)
        free = _free(problem, present, rows, margin)
        if not free.all():
            return Certificate(False, margin, 0.0, steps, first + int(free.argmin()))
        gaps = _checker(problem, present, margin).clearance(rows)
        bound = _least(problem, present, rows, margin, gaps)
        if bound < least:
            least = bound
            step = int(np.argmin(gaps))
            nearest = (first + step, *_who(problem, present, configurations, first + step))
    return Certificate(True, margin, float(least), steps, None, nearest)


def _fit(problem: Problem, configurations: Sequence[Floats]) -> None:
    """ValueError where a robot is left out, or arrays are of other shapes."""
    shapes = [np.shape(q) for q in configurations]
    steps = {shape[0] for shape in shapes if shape}
    if (
        [s[1:] for s in shapes] != [(m.nq,) for m in problem.models]
        or len(steps) != 1
        or 0 in steps
    ):
        raise ValueError(
            f"configurations: shapes {shapes}, expected (steps + 1, nq) of each of the"
            f" {len(problem.models)} robots, equally long"
        )


def _phases(
    problem: Problem, configurations: Sequence[Floats]
) -> Iterator[tuple[int, int, list[int]]]:
    """Stretches of steps with who is there in them."""
    n, steps = len(configurations), len(configurations[0]) - 1
    ends = [steps] * n
    if problem.vanish:
        ends = [max(arrival(q), 1) for q in configurations]  # gone after a step at the earliest
    cuts = sorted({0, steps, *(end for end in ends if 0 < end < steps)})
    if steps == 0:
        yield 0, 0, list(range(n))
    for first, last in pairwise(cuts):
        present = [i for i in range(n) if ends[i] > first or not problem.vanish]
        if present:
            yield first, last, present


def arrival(q: Floats) -> int:
    """The step from which on a robot rests at where it ends, of configurations (k + 1, nq)."""
    moving = (q != q[-1]).any(axis=1)
    return int(np.flatnonzero(moving)[-1]) + 1 if moving.any() else 0


def _free(problem: Problem, present: list[int], rows: Floats, margin: float) -> NDArray[np.bool_]:
    checker = _checker(problem, present, margin)
    begin = np.atleast_1d(np.asarray(checker.valid(rows[0])))
    if len(rows) == 1 or not begin[0]:
        return begin
    return np.asarray(checker.free(rows[:-1], rows[1:]))


def _least(
    problem: Problem, present: list[int], rows: Floats, margin: float, gaps: Floats
) -> float:
    """A clearance that is proved: the largest found by halving between `margin` and the gaps seen.

    Only steps that are not proved at one are asked at the next.
    """
    most = float(np.min(gaps))
    if not np.isfinite(most) or len(rows) == 1:
        return most
    starts, ends = rows[:-1], rows[1:]
    near = np.minimum(gaps[:-1], gaps[1:])
    low, high = margin, most - ROOM
    tried = high
    if tried <= margin:
        return margin
    left = np.ones(len(starts), dtype=bool)
    for _ in range(ROUNDS):
        checker = _checker(problem, present, tried)
        asked = np.flatnonzero(left & (near <= tried + _reach(problem, present, starts, ends)))
        bad = asked[~np.asarray(checker.free(starts[asked], ends[asked]))] if len(asked) else asked
        if len(bad) == 0:
            low = tried
        else:
            high = tried
            left = np.zeros_like(left)
            left[bad] = True
        if high - low < ROOM or tried == most - ROOM == low:
            break
        tried = (low + high) / 2
    return low


def _reach(problem: Problem, present: list[int], starts: Floats, ends: Floats) -> Floats:
    """Meters by which two robots can come nearer to each other within a step, at most."""
    far, k = [], 0
    for i in present:
        model = problem.models[i]
        part = slice(k, k + model.nq)
        far.append(np.asarray(model.distance(starts[:, part], ends[:, part])))
        k += model.nq
    both: Floats = 2.0 * np.max(far, axis=0)
    return both


def _checker(problem: Problem, present: list[int], margin: float) -> _core.Checker:
    """Of robots that go straight, those that are gone left out of the world."""
    world = problem.world
    if len(present) < len(problem.names):
        world = world.copy()
        for i in set(range(len(problem.names))) - set(present):
            world.remove(problem.robots[i])
    n = len(present)
    ids = [problem.robots[i] for i in present]
    sizes = [problem.models[i].nq for i in present]
    return _core.Checker(
        world._core, ids, sizes, [0] * n, [1.0] * n, [True] * n, margin, TOLERANCE, 0.0
    )


def _who(
    problem: Problem, present: list[int], configurations: Sequence[Floats], step: int
) -> tuple[str, str]:
    """The two that are nearest to each other at a step."""
    world = problem.world.copy()
    for i, robot in enumerate(problem.robots):
        if i in present:
            world.set_configuration(robot, configurations[i][step])
        else:
            world.remove(robot)
    found: list[tuple[float, str, Any]] = []
    names = dict(zip(world.ids.tolist(), world.names, strict=True))
    for i in present:
        gap = world.clearance(problem.robots[i], configurations[i][step])
        if gap.body >= 0:
            found.append((float(gap.distance), problem.names[i], names[int(gap.body)]))
    _, robot_name, other = min(found)
    return robot_name, str(other).split("/")[0]

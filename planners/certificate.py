"""Certificates: timed paths are free along each step's motion, with all robots moving at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fgenv import _core
from fgenv.arrays import Flags, Floats

from .checker import joint_checker
from .problem import Problem

RESOLUTION = 1e-4  # m, of the certified clearance
MAX_BISECTIONS = 12


@dataclass(frozen=True)
class Certificate:
    """Certified properties of timed paths.

    Attributes:
        proved: all motions are free, and stay more than `margin` meters from all bodies.
        margin: meters; it does not apply between the links of one robot.
        clearance: certified lower bound on the distance of any robot to other bodies, meters. It
            is within 0.1 mm of the distances at the ends of the steps where the bisection
            converged; infinite without other bodies.
        steps: number of certified steps.
        failed_step: first step that is not certified, or None.
        nearest: (step, robot, body) with the least distance at the end of a step, or None.
    """

    proved: bool
    margin: float
    clearance: float
    steps: int
    failed_step: int | None = None
    nearest: tuple[int, str, str] | None = None

    def __bool__(self) -> bool:
        return self.proved


def certify(
    problem: Problem, configurations: Sequence[Floats], margin: float | None = None
) -> Certificate:
    """Certify the simultaneous motion of all robots, step by step.

    Robots that vanish at their goals are absent from the step on in which they arrive for good.

    Args:
        configurations: of each robot at each step, (k + 1, nq).
        margin: meters; the problem's by default.

    Raises:
        ValueError: not one array (k + 1, nq) for each of the problem's robots.
    """
    _check_shapes(problem, configurations)
    margin = problem.margin if margin is None else margin
    steps = len(configurations[0]) - 1
    clearance, nearest = np.inf, None
    for phase in _phases(problem, configurations):
        free = phase.free(margin)
        if not free.all():
            return Certificate(False, margin, 0.0, steps, phase.first + int(free.argmin()))
        gaps = np.asarray(phase.checker(margin).clearance(phase.rows))
        bound = phase.clearance_bound(margin, gaps)
        if bound < clearance:
            clearance, step = bound, int(np.argmin(gaps))
            nearest = (phase.first + step, *phase.nearest_pair(step))
    return Certificate(True, margin, float(clearance), steps, None, nearest)


def arrival(q: Floats) -> int:
    """Step from which on a robot with configurations q (k + 1, nq) rests at the last one."""
    moving = (q != q[-1]).any(axis=1)
    return int(np.flatnonzero(moving)[-1]) + 1 if moving.any() else 0


def _check_shapes(problem: Problem, configurations: Sequence[Floats]) -> None:
    shapes = [np.shape(q) for q in configurations]
    steps = {shape[0] for shape in shapes if shape}
    sizes = [(model.nq,) for model in problem.models]
    if [shape[1:] for shape in shapes] != sizes or len(steps) != 1 or 0 in steps:
        raise ValueError(
            f"configurations: got shapes {shapes}, expected (steps + 1, nq) for each of the"
            f" {len(problem.models)} robots, with equal numbers of steps"
        )


def _phases(problem: Problem, configurations: Sequence[Floats]) -> Iterator[_Phase]:
    """Split the steps into phases with the same robots present."""
    n, steps = len(configurations), len(configurations[0]) - 1
    ends = [steps] * n
    if problem.vanish:
        ends = [max(arrival(q), 1) for q in configurations]  # robots vanish after one step or more
    if steps == 0:
        yield _Phase(problem, configurations, list(range(n)), 0, 0)
    cuts = sorted({0, steps, *(end for end in ends if 0 < end < steps)})
    for first, last in pairwise(cuts):
        present = [i for i in range(n) if ends[i] > first or not problem.vanish]
        if present:
            yield _Phase(problem, configurations, present, first, last)


class _Phase:
    """Consecutive steps in which the same robots are present.

    Attributes:
        first: number of the first step.
        rows: joint configurations of the present robots at the ends of the steps, (m + 1, size).
    """

    def __init__(
        self,
        problem: Problem,
        configurations: Sequence[Floats],
        present: list[int],
        first: int,
        last: int,
    ) -> None:
        self.problem, self.present, self.first = problem, present, first
        self.parts = [configurations[i][first : last + 1] for i in present]
        self.rows = np.concatenate(self.parts, axis=1)
        self.world = problem.world
        absent = set(range(len(problem.names))) - set(present)
        if absent:
            self.world = problem.world.copy()
        for i in absent:
            self.world.remove(problem.robot_ids[i])

    def checker(self, margin: float) -> _core.Checker:
        """Checker for the joint configurations."""
        ids = [self.problem.robot_ids[i] for i in self.present]
        return joint_checker(self.world, ids, [q.shape[1] for q in self.parts], margin)

    def free(self, margin: float) -> Flags:
        """Whether each step is certified free, (m,); only the start if that is not, (1,)."""
        checker = self.checker(margin)
        start = np.atleast_1d(np.asarray(checker.valid(self.rows[0])))
        if len(self.rows) == 1 or not start[0]:
            return start
        return np.asarray(checker.free(self.rows[:-1], self.rows[1:]))

    def clearance_bound(self, margin: float, gaps: Floats) -> float:
        """Certified clearance: the largest found by bisection between the margin and the gaps.

        Only steps that failed at the last failed distance are checked again.

        Args:
            gaps: clearances at the ends of the steps, (m + 1,), meters.
        """
        least = float(np.min(gaps))
        if not np.isfinite(least) or len(self.rows) == 1:
            return least
        low, high = margin, least - RESOLUTION
        if high <= low:
            return margin
        tried = high
        reach, near = self._approach(), np.minimum(gaps[:-1], gaps[1:])
        left = np.ones(len(near), dtype=bool)
        for _ in range(MAX_BISECTIONS):
            steps = np.flatnonzero(left & (near <= tried + reach))
            free = np.asarray(self.checker(tried).free(self.rows[steps], self.rows[steps + 1]))
            failed = steps[~free]
            if len(failed):
                high, left = tried, np.zeros_like(left)
                left[failed] = True
            else:
                low = tried
            if high - low < RESOLUTION:
                break
            tried = (low + high) / 2
        return low

    def _approach(self) -> Floats:
        """Bound on how much nearer two robots can come to each other within each step, meters."""
        models = [self.problem.models[i] for i in self.present]
        pairs = zip(models, self.parts, strict=True)
        length = [np.asarray(model.displacement_bound(q[:-1], q[1:])) for model, q in pairs]
        bound: Floats = 2.0 * np.max(length, axis=0)
        return bound

    def nearest_pair(self, step: int) -> tuple[str, str]:
        """Names of a robot and a body with the least distance at the beginning of a step."""
        world = self.world.copy()
        ids = [self.problem.robot_ids[i] for i in self.present]
        for robot, q in zip(ids, self.parts, strict=True):
            world.set_configuration(robot, q[step])
        names = dict(zip(world.ids.tolist(), world.names, strict=True))
        pairs = []
        for i, robot, q in zip(self.present, ids, self.parts, strict=True):
            gap = world.clearance(robot, q[step])
            if gap.body >= 0:
                body = str(names[int(gap.body)]).split("/")[0]
                pairs.append((float(gap.distance), self.problem.names[i], body))
        return min(pairs)[1:]

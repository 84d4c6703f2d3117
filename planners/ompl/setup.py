"""OMPL's SimpleSetup for robots of a problem."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.planners.problem import Problem

from .checkers import MotionValidator, StateValidityChecker
from .spaces import StateLayout, configurations_of, joint_space, state_space
from .states import StateBuffer


class Setup(og.SimpleSetup):  # type: ignore[misc]
    """A `SimpleSetup` with fgenv's checks; `solve` raises exceptions of the checks.

    Attributes:
        problem, robots: the problem, and the places of the planned robots in it.
        world: world of the checks.
        layouts: state layout of each planned robot.
        validity, motions: state validity checker and motion validator.
        buffer: reads and writes states.
    """

    def __init__(
        self,
        problem: Problem,
        robots: Sequence[int],
        world: World,
        *,
        steering: str | None = None,
        resolution: float | None = None,
    ) -> None:
        self.problem, self.robots, self.world = problem, tuple(robots), world
        models = [problem.models[i] for i in robots]
        self.layouts = [StateLayout(model, model.steering(steering)) for model in models]
        super().__init__(problem_space(problem, self.layouts))
        si = self.getSpaceInformation()
        names, margin = [problem.names[i] for i in robots], problem.margin
        self.validity = StateValidityChecker(si, names, world, margin=margin, steering=steering)
        self.motions = MotionValidator(
            si, names, world, margin=margin, steering=steering, resolution=resolution
        )
        self.setStateValidityChecker(self.validity)
        si.setMotionValidator(self.motions)
        self.buffer = StateBuffer(si)
        self.setStartAndGoalStates(
            self.buffer.write(si.allocState(), self.states(problem.starts)),
            self.buffer.write(si.allocState(), self.states(problem.goals)),
        )

    def states(self, configurations: Sequence[Floats]) -> Floats:
        """Joint state (size,) of the configurations of all of the problem's robots."""
        pairs = zip(self.layouts, self.robots, strict=True)
        return np.concatenate([layout.states(configurations[i]) for layout, i in pairs])

    def configurations(self, states: Floats) -> list[Floats]:
        """Configurations (..., nq) of each planned robot in joint states (..., size)."""
        return configurations_of(self.layouts, states)

    def states_of(self, path: Any) -> Floats:
        """States (m, size) of one of OMPL's geometric paths."""
        count = path.getStateCount()
        return np.array([self.buffer.read(path.getState(k)) for k in range(count)])

    def solve(self, limit: Any = 1.0, motions: int = 0) -> Any:
        """Search for `limit` seconds, or until an OMPL termination condition holds.

        Args:
            limit: seconds, or a termination condition.
            motions: maximum number of checked motions; 0: unlimited. If this ends the search, the
                same seed gives the same path.

        Raises:
            BaseException: raised in a check; KeyboardInterrupt included.
        """
        if isinstance(limit, (int, float)):
            limit = ob.timedPlannerTerminationCondition(float(limit))
        self.validity._core.watch(limit.terminate, 0)
        self.motions._core.watch(limit.terminate, motions)
        try:
            status = super().solve(limit)
        finally:
            error = self.motions.error or self.validity.error
            self.validity._core.watch(None, 0)
            self.motions._core.watch(None, 0)
        if error is not None:
            raise error
        return status


def setup(
    scenario: Any,
    robot: int | str | Sequence[int | str] | None = None,
    *,
    margin: float = 0.0,
    seed: int = 0,
    steering: str | None = None,
    resolution: float | None = None,
    world: World | None = None,
) -> Setup:
    """Return a complete `SimpleSetup` for robots of a scenario; the others stand at their starts.

    Args:
        scenario: a Scenario, its name or file, or a `Problem`.
        robot: name or place in the scenario, or a sequence of them for a joint space; all robots
            by default.
        margin: meters that states and motions keep from all bodies.
        seed: of a built-in scenario that is given by its name.
        steering, resolution: see `MotionValidator`.
        world: world to plan in; a copy of the problem's by default.

    Raises:
        PlanningError: start or goal collides.
    """
    problem = Problem.from_scenario(scenario, margin, seed)
    several = range(len(problem.names)) if robot is None else robot
    names = [several] if isinstance(several, (int, str, np.integer)) else list(several)
    if not names:
        raise ValueError("robot: got none, expected at least one")
    robots = [problem.index(name) for name in names]
    world = problem.world.copy() if world is None else world
    ss = Setup(problem, robots, world, steering=steering, resolution=resolution)
    for label, ends in (("start", problem.starts), ("goal", problem.goals)):
        if not ss.validity._core.valid(ss.states(ends)):
            there = world.copy()
            for i in robots:
                there.set_configuration(problem.names[i], ends[i])
            for i in robots:
                problem.check_robot(there, i, label)
    return ss


def problem_space(problem: Problem, layouts: Sequence[StateLayout]) -> Any:
    """Joint state space of robots of a problem, bounded by `base_bounds`."""
    return joint_space([state_space(layout, base_bounds(problem, layout)) for layout in layouts])


def base_bounds(problem: Problem, layout: StateLayout) -> Floats | None:
    """Lowest and highest base position (2, 3), meters, for a robot without a workspace.

    The box contains the start, the goal and all static bodies, with space to go around them. None
    for a robot that has a workspace or a fixed base.
    """
    robot = layout.robot
    if robot.base == "fixed" or robot.workspace is not None:
        return None
    i = problem.models.index(robot)
    ends = np.array([problem.starts[i], problem.goals[i]])[:, :3]
    ends = ends if robot.base == "free" else np.column_stack([ends[:, :2], np.zeros(2)])
    points = [ends @ robot.mount[:3, :3].T + robot.mount[:3, 3]]
    for shape, pose in zip(problem.built.shapes, problem.built.poses, strict=True):
        points.append(shape.vertices @ pose[:3, :3].T + pose[:3, 3])
    local = (np.concatenate(points) - robot.mount[:3, 3]) @ robot.mount[:3, :3]
    reach = float(robot.weights[3 if robot.base == "free" else 2])
    space = 2.0 * (reach + problem.margin)
    return np.stack([local.min(axis=0) - space, local.max(axis=0) + space])

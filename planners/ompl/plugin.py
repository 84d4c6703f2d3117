"""OMPL's state validity checker and motion validator on a world of fgenv, for any problem.

    >>> space_information.setStateValidityChecker(StateValidityChecker(si, "cart", world))
    >>> space_information.setMotionValidator(MotionValidator(si, "cart", world))

Both serialize OMPL's states straight into native buffers; a motion is one native call: the path's
mask, then proved free all along, or not. What goes wrong in a call is kept, since some planners
would end the process: from then on all is invalid, and `Setup.solve` raises it after the planner
has returned (elsewhere `error` has it).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.collision.world import TOLERANCE, Body
from fgenv.planners.problem import Problem
from fgenv.planners.steering import Steering

from .spaces import Layout, compound_of, leaves, space_of
from .states import StateBuffer, serialize_of

Robots = Body | Sequence[Body]

BODY = {"SE2": 3, "SE3": 7}  # numbers in a state of a body that is no robot


class StateValidityChecker(ob.StateValidityChecker):  # type: ignore[misc]
    """Valid is what meets nothing, and is more than `margin` meters from everything.

    Args:
        si: OMPL's space information; its space as `fgenv.planners.space_of` makes it for the
            robot, or SE2 or SE3 for a body that is no robot.
        robot: id or name in the world; or several, whose states follow each other.
        world: may change between two searches, or in one.
        margin: meters.
        steering: how the robot gets from state to state; what its drive can do if left out.
    """

    def __init__(
        self,
        si: Any,
        robot: Robots,
        world: World,
        *,
        margin: float = 0.0,
        steering: str | None = None,
    ) -> None:
        super().__init__(si)
        self._core = checker_of(si, robot, world, margin=margin, steering=steering)
        self.isValid, _, self.clearance = self._core.serve(serialize_of(si))

    @property
    def error(self) -> BaseException | None:
        """What went wrong in a call, if anything did."""
        return self._core.error()

    @property
    def checks(self) -> int:
        """States asked so far."""
        return self._core.counts()[0]


class MotionValidator(ob.MotionValidator):  # type: ignore[misc]
    """A motion is valid if it is proved free all along, on the way that the robot's drive takes.

    As with OMPL's own, the beginning is taken to be valid.

    Args:
        si, robot, world, margin, steering: as for `StateValidityChecker`.
        resolution: meters; if given, the motion is only looked at in steps in which no point moves
            farther than that, as OMPL's own validator does. It can miss what is between.
    """

    def __init__(
        self,
        si: Any,
        robot: Robots,
        world: World,
        *,
        margin: float = 0.0,
        steering: str | None = None,
        resolution: float | None = None,
    ) -> None:
        super().__init__(si)
        self._core = checker_of(
            si, robot, world, margin=margin, steering=steering, resolution=resolution
        )
        _, self.checkMotion, _ = self._core.serve(serialize_of(si))

    @property
    def error(self) -> BaseException | None:
        """What went wrong in a call, if anything did."""
        return self._core.error()

    @property
    def checks(self) -> int:
        """Motions asked so far."""
        return self._core.counts()[1]


class Setup(og.SimpleSetup):  # type: ignore[misc]
    """A `SimpleSetup` whose checks are ours; `solve` raises what went wrong in them.

    Attributes:
        problem, which: the scenario's problem, and the places of the robots that are planned.
        layouts: of each of them.
        validity, motions: the plug-ins.
        buffer: reads and writes states.
    """

    def __init__(
        self,
        problem: Problem,
        which: Sequence[int],
        world: World,
        *,
        steering: str | None = None,
        resolution: float | None = None,
    ) -> None:
        self.problem, self.which, self.world = problem, tuple(which), world
        self.layouts = [
            Layout(problem.models[i], Steering.of(problem.models[i], steering)) for i in which
        ]
        space = compound_of([space_of(layout, room(problem, layout)) for layout in self.layouts])
        super().__init__(space)
        si = self.getSpaceInformation()
        names = [problem.names[i] for i in which]
        options = {"margin": problem.margin, "steering": steering}
        self.validity = StateValidityChecker(si, names, world, **options)  # type: ignore[arg-type]
        self.motions = MotionValidator(si, names, world, resolution=resolution, **options)  # type: ignore[arg-type]
        self.setStateValidityChecker(self.validity)
        si.setMotionValidator(self.motions)
        self.buffer = StateBuffer(si)
        self.setStartAndGoalStates(
            self.buffer.write(si.allocState(), self.states(problem.starts)),
            self.buffer.write(si.allocState(), self.states(problem.goals)),
        )

    def states(self, configurations: Sequence[Floats]) -> Floats:
        """The joint state (size,) of configurations of all the problem's robots."""
        pairs = zip(self.layouts, self.which, strict=True)
        return np.concatenate([layout.states(configurations[i]) for layout, i in pairs])

    def configurations(self, states: Floats) -> list[Floats]:
        """Configurations (..., nq) of each robot of joint states (..., size)."""
        ends = np.cumsum([layout.size for layout in self.layouts])[:-1]
        return [
            layout.configurations(part)
            for layout, part in zip(self.layouts, np.split(states, ends, axis=-1), strict=True)
        ]

    def solve(self, limit: Any = 1.0, motions: int = 0) -> Any:
        """Search for `limit` seconds, or until a termination condition of OMPL says so.

        Args:
            motions: at most so many checks of motions; 0: any number. Then, and with time to
                spare, the same seed gives the same path.

        Raises:
            BaseException: what went wrong in a check, KeyboardInterrupt among it.
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

    def path(self) -> Floats:
        """The solution's states, (m, size), as plain numbers."""
        path = self.getSolutionPath()
        count = path.getStateCount()
        return np.array([self.buffer.read(path.getState(k)) for k in range(count)])


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
    """A ready `SimpleSetup` for a robot of a scenario; the others stand at their starts.

    Args:
        scenario: a Scenario, its name or file, or a `Problem`.
        robot: its name or place in the scenario; several are planned in their joint space; all if
            left out.
        margin: meters that states and motions keep from everything.
        steering, resolution: as for `MotionValidator`.
        world: to plan in; a copy of the problem's if left out.

    Raises:
        PlanningError: start or goal collides; says with whom.
    """
    problem = Problem.of(scenario, margin, seed)
    several = range(len(problem.names)) if robot is None else robot
    names = [several] if isinstance(several, (int, str, np.integer)) else list(several)
    if not names:
        raise ValueError("robot: none, expected one at least")
    which = [problem.index(name) for name in names]
    made = Setup(
        problem,
        which,
        problem.world.copy() if world is None else world,
        steering=steering,
        resolution=resolution,
    )
    for label, ends in (("start", problem.starts), ("goal", problem.goals)):
        if not made.validity._core.valid(made.states(ends)):
            there = made.world.copy()
            for i in which:
                there.set_configuration(problem.names[i], ends[i])
            for i in which:
                problem.check_there(there, i, label)
    return made


def room(problem: Problem, layout: Layout) -> Floats | None:
    """Where its base may be: its workspace, or what leaves space to go around everything."""
    robot = layout.robot
    if robot.base == "fixed" or robot.workspace is not None:
        return None
    i = problem.models.index(robot)
    ends = np.array([problem.starts[i], problem.goals[i]])[:, :3]
    ends = ends if robot.base == "free" else np.column_stack([ends[:, :2], np.zeros(2)])
    around = [ends @ robot.mount[:3, :3].T + robot.mount[:3, 3]]
    for shape, pose in zip(problem.built.shapes, problem.built.poses, strict=True):
        around.append(shape.vertices @ pose[:3, :3].T + pose[:3, 3])
    points = np.concatenate(around) - robot.mount[:3, 3]
    points = points @ robot.mount[:3, :3]
    reach = float(robot.weights[3 if robot.base == "free" else 2])
    space = 2.0 * (reach + problem.margin)
    return np.stack([points.min(axis=0) - space, points.max(axis=0) + space])


def checker_of(
    si: Any,
    robot: Robots,
    world: World,
    *,
    margin: float = 0.0,
    steering: str | None = None,
    resolution: float | None = None,
) -> _core.Checker:
    """The native checker for states of a space; ValueError where the space does not fit."""
    several = [robot] if isinstance(robot, (int, str, np.integer)) else list(robot)
    if not several:
        raise ValueError("robot: none, expected one at least")
    if resolution is not None and not resolution > 0:
        raise ValueError(f"resolution: got {resolution}, expected meters over 0, or None")
    given = leaves(si.getStateSpace())
    layouts = [_layout(world, body, steering) for body in several]
    expected: list[tuple[str, int]] = []
    sizes = []
    for layout in layouts:
        leaf = given[len(expected)] if len(expected) < len(given) else ("SE2", 3)
        if layout is None:
            leaf = leaf if leaf[0] in BODY else ("SE2", 3)
            sizes.append(BODY[leaf[0]])
            expected.append(leaf)
        else:
            sizes.append(layout.size)
            expected += leaves(space_of(layout, np.array([[-1.0] * 3, [1.0] * 3])))
    if _flat(given) != _flat(expected):
        raise ValueError(
            f"si: a space of {_told(given)}, expected {_told(expected)};"
            " fgenv.planners.space_of makes it"
        )
    steerings = [Steering() if layout is None else layout.steering for layout in layouts]
    return _core.Checker(
        world._core,
        several,
        sizes,
        [s.code for s in steerings],
        [s.radius for s in steerings],
        [s.reverse for s in steerings],
        margin,
        TOLERANCE,
        resolution or 0.0,
        [Layout.room_of(layout) for layout in layouts],
    )


def _layout(world: World, body: Body, steering: str | None) -> Layout | None:
    """None: a body that is no robot."""
    model = world.record(body).robot
    if model is None and steering not in (None, "straight"):
        raise ValueError(f"steering: {steering!r}, a body that is no robot goes straight")
    return None if model is None else Layout(model, Steering.of(model, steering))  # type: ignore[arg-type]


def _flat(parts: list[tuple[str, int]]) -> list[tuple[str, int]]:
    """Real vectors that follow each other are one."""
    out: list[tuple[str, int]] = []
    for kind, size in parts:
        if out and kind == out[-1][0] == "RealVector":
            out[-1] = (kind, out[-1][1] + size)
        else:
            out.append((kind, size))
    return out


def _told(parts: list[tuple[str, int]]) -> str:
    return ", ".join(f"R{n}" if kind == "RealVector" else kind for kind, n in _flat(parts))

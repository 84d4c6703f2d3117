"""A policy that plans each episode and drives the plan."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fgenv.agents.policies.base import BasePolicy
from fgenv.agents.policies.plan_arguments import check_plan, method_and_planner
from fgenv.agents.tracking.executable_plan import Course, find
from fgenv.agents.tracking.lookahead import free_steps
from fgenv.agents.tracking.plan_clock import Run, rates
from fgenv.arrays import Flags, Floats, Floats32
from fgenv.envs import View
from fgenv.envs.recorder import scenario_of_episode
from fgenv.planners import Plan, PlanningError
from fgenv.scenarios import Scenario

WAY_POINT_TOLERANCE = 0.05  # m; robots do not approach way points closer than 2 cm


class PlanWarning(UserWarning):
    """A world has no plan, and its robots rest."""


class PlanPolicy(BasePolicy):
    """Plans the episode of each world at its start, and drives the plan.

    Each action leads from a robot's current configuration to the plan's configuration after the
    step, so that errors do not accumulate. If a robot is held up, the plan's clock stops until the
    robot has caught up: the other robots slow down within the limits of their drives and wait, and
    each step with the clock stopped is certified free first. A robot that never catches up blocks
    all others; `ReplanPolicy` does not.

    With way points as actions, differential drives and cars accept plans without reverse motion
    only, since they turn around for a way point behind them.

    Args:
        method, planner, time_limit: see `fgenv.planners.plan`.
        plan: to drive, instead of planning.
        seed: of random numbers in planning.
        strict: a world without a plan is an error; otherwise a warning, and its robots rest.

    Attributes:
        problems: reasons for worlds without a plan, by world.
    """

    def __init__(
        self,
        method: str | None = None,
        planner: str = "RRTConnect",
        *,
        plan: Plan | str | Path | None = None,
        seed: int = 0,
        time_limit: float = 10.0,
        strict: bool = False,
    ) -> None:
        self.method, self.planner, self.seed = method, planner, seed
        self.plan = plan if plan is None or isinstance(plan, Plan) else Plan.load(plan)
        self.time_limit, self.strict = time_limit, strict
        self.problems: dict[int, str] = {}

    def reset(self, view: View) -> None:
        """Plan new episodes.

        Raises:
            PlanningError: with `strict`, if there is no plan.
        """
        super().reset(view)
        self._simulator = view._simulator  # the view lacks the scenario of the episode
        self._runs: list[Run | None] = [None] * view.n_worlds
        self._worst = 0.0
        self._refresh()

    @property
    def tracking_error(self) -> float:
        """Largest distance of a robot from its plan since the last reset, m."""
        self._look(self.view.configurations)
        return self._worst

    @property
    def waited(self) -> float:
        """Longest time for which the clock of a plan has stopped, over worlds, s."""
        return (
            max((run.waited for run in self._runs if run is not None), default=0.0) * self.view.dt
        )

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size)."""
        view = self.view
        self._refresh()
        q = view.configurations
        off, tolerance = self._look(q), self._tolerance
        late = np.zeros(off.shape, dtype=bool)
        for k, run in enumerate(self._runs):
            assert run is not None
            run.steps = int(view.steps[k])
            if run.course is not None:
                late[k] = run.late(off[k], tolerance)
                self._tick(k, run, q[k], off[k] > tolerance, late[k])
        places, out = self._places(q), off > tolerance
        stay = out & np.array([run is not None and run.held for run in self._runs])[:, None]
        places[stay] = q[stay]
        return self._lead(q, places)

    # Episodes

    @property
    def _keys(self) -> list[tuple[int, int]]:
        """Seed and number of the episode of each world."""
        simulator = self._simulator
        return list(zip(simulator.seeds.tolist(), simulator.episodes.tolist(), strict=True))

    def _refresh(self) -> None:
        """Plan episodes that have begun."""
        for k, key in enumerate(self._keys):
            run, steps = self._runs[k], int(self.view.steps[k])
            if run is None or run.key != key or steps < run.steps:
                self._runs[k] = Run(key, self._course(k), steps=steps)

    def _course(self, world: int) -> Course | None:
        self.problems.pop(world, None)
        try:
            return self._plan(scenario_of_episode(self._simulator, world), world)
        except PlanningError as error:
            if self.strict:
                raise
            self.problems[world] = str(error)
            warnings.warn(f"world {world}: {error}; its robots rest", PlanWarning, stacklevel=4)
            return None

    def _plan(self, scenario: Scenario, world: int) -> Course:
        if self.plan is not None:
            course = Course.of(self.plan)
            check_plan(course, self.view, world)
            return course
        return self._find(scenario, self.seed, self.time_limit)

    def _find(self, scenario: Scenario, seed: int, time_limit: float) -> Course:
        return find(
            scenario,
            self.method,
            self.planner,
            seed=seed,
            time_limit=time_limit,
            way_points=self._simulator.actions == "way_points",
        )

    # Following

    @property
    def _tolerance(self) -> Floats:
        """Distance from the course beyond which each robot is late, m."""
        if self._simulator.actions == "way_points":
            return np.full(self.view.n_robots, WAY_POINT_TOLERANCE)
        return np.array(
            [robot.required_drive.base_drive.recovery_error for robot in self.view.robots]
        )

    def _places(self, q: Floats) -> Floats:
        """Configurations (worlds, robots, nq) of the plans at their clocks; q without a plan."""
        places = q.copy()
        for k, run in enumerate(self._runs):
            if run is not None and run.course is not None:
                for i, row in enumerate(run.course.at(run.clock)):
                    places[k, i, : len(row)] = row
        return places

    def _look(self, q: Floats) -> Floats:
        """Distances from the courses (worlds, robots), m; 0 for robots at their goals."""
        off, places, moving = np.zeros(q.shape[:2]), self._places(q), self.view.moving
        for i, robot in enumerate(self.view.robots):
            off[:, i] = robot.displacement_bound(q[:, i, : robot.nq], places[:, i, : robot.nq])
        keys = zip(self._simulator.seeds, self._simulator.episodes, strict=True)
        same = [
            run is not None and run.key == key for run, key in zip(self._runs, keys, strict=True)
        ]
        off = np.where(moving & np.array(same)[:, None], off, 0.0)
        self._worst = max(self._worst, float(off.max()))
        return off

    def _tick(self, world: int, run: Run, q: Floats, out: Flags, late: Flags) -> None:
        """Advance the clock, or stop it for late robots; `out` robots are off their courses."""
        assert run.course is not None
        last, run.held = float(run.course.last), False
        if run.rate == 1.0 and run.clock == int(run.clock) and not out.any():
            run.clock = min(run.clock + 1.0, last)
            return
        for rate in rates(run, bool(late.any())):
            clock = min(run.clock + rate, last)
            if self._can(world, run, q, out, clock) and self._free(world, run, q, clock):
                break
        else:
            clock, run.held = run.clock, True  # no rate is free: brake as hard as possible
        run.rate = 1.0 if clock == last else clock - run.clock
        run.waited, run.clock = run.waited + 1.0 - run.rate, clock

    def _can(self, world: int, run: Run, q: Floats, out: Flags, clock: float) -> bool:
        """Whether all robots on their courses can follow the clock."""
        assert run.course is not None
        view, rows = self.view, run.course.at(clock)
        before, on = view.velocities[world], view.moving[world] & ~out

        def can(i: int) -> bool:
            robot = view.robots[i]
            here = q[i, : robot.nq]
            return robot.required_drive.reaches(robot, here, rows[i], before[i], view.dt)

        return all(can(i) for i in np.flatnonzero(on).tolist())

    def _free(self, world: int, run: Run, q: Floats, *clocks: float) -> bool:
        """Whether the simultaneous motions through the plan at these clocks are certified free."""
        on = np.flatnonzero(self.view.moving[world]).tolist()
        if not on:
            return True
        names, models = [self.view.names[i] for i in on], [self.view.robots[i] for i in on]
        rows = [self._expected(run, q, i, clocks) for i in on]
        return bool(free_steps(self.view.world(world), names, models, rows).all())

    def _expected(self, run: Run, q: Floats, i: int, clocks: Sequence[float]) -> Floats:
        """Current and planned configurations of a robot at clocks, (1 + len(clocks), nq)."""
        assert run.course is not None
        ahead = [run.course.at(clock)[i] for clock in clocks]
        return np.array([q[i, : self.view.robots[i].nq], *ahead])

    def _lead(self, q: Floats, places: Floats) -> Floats:
        """Actions to places, by the inverse models of the drives or by way points."""
        view, simulator = self.view, self._simulator
        backs = np.zeros(q.shape[:2], dtype=bool)
        asked = np.zeros((view.n_worlds, view.n_robots, view.action_size))
        for i, robot in enumerate(view.robots):
            ends = q[:, i, : robot.nq], places[:, i, : robot.nq]
            if simulator.actions == "way_points":
                own, led = robot.required_drive.tracking_waypoint(
                    robot, *ends, view.dt, simulator.way_point_seconds
                )
                backs[:, i] = ~led
            else:
                own = robot.required_drive.tracking_action(robot, *ends, view.dt)
            asked[:, i, : own.shape[1]] = own
        if backs.any():
            asked[backs] = view.toward(places)[backs]
        return asked


def plan(argument: str, seed: int) -> PlanPolicy:
    """Make the policy named `plan[:METHOD[:PLANNER]]` or `plan:FILE.npz`."""
    if argument.endswith(".npz"):
        return PlanPolicy(plan=argument)
    return PlanPolicy(*method_and_planner(argument), seed=seed)

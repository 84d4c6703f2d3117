"""A policy that plans each episode and drives the plan."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fgenv.agents.policies.base import BasePolicy
from fgenv.agents.policies.plan_arguments import check_plan, method_and_planner
from fgenv.agents.tracking.executable_plan import ExecutablePlan, plan_executable
from fgenv.agents.tracking.lookahead import free_steps
from fgenv.agents.tracking.plan_clock import PlanExecution, clock_rates
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
        planner: str | None = None,
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
        self._runs: list[PlanExecution | None] = [None] * view.n_worlds
        self._max_error = 0.0
        self._plan_new_episodes()

    @property
    def tracking_error(self) -> float:
        """Largest distance of a robot from its plan since the last reset, m."""
        self._tracking_errors(self.view.configurations)
        return self._max_error

    @property
    def waited(self) -> float:
        """Longest time for which the clock of a plan has stopped, over worlds, s."""
        return (
            max((run.waited for run in self._runs if run is not None), default=0.0) * self.view.dt
        )

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size)."""
        view = self.view
        self._plan_new_episodes()
        q = view.configurations
        errors, tolerance = self._tracking_errors(q), self._tolerance
        late = np.zeros(errors.shape, dtype=bool)
        for k, run in enumerate(self._runs):
            assert run is not None
            run.steps = int(view.steps[k])
            if run.course is not None:
                late[k] = run.delayed(errors[k], tolerance)
                self._advance_clock(k, run, q[k], errors[k] > tolerance, late[k])
        references, off_course = self._references(q), errors > tolerance
        stay = off_course & np.array([run is not None and run.held for run in self._runs])[:, None]
        references[stay] = q[stay]
        return self._tracking_actions(q, references)

    # Episodes

    @property
    def _episode_keys(self) -> list[tuple[int, int]]:
        """Seed and number of the episode of each world."""
        simulator = self._simulator
        return list(zip(simulator.seeds.tolist(), simulator.episodes.tolist(), strict=True))

    def _plan_new_episodes(self) -> None:
        """Plan episodes that have begun."""
        for k, key in enumerate(self._episode_keys):
            run, steps = self._runs[k], int(self.view.steps[k])
            if run is None or run.key != key or steps < run.steps:
                self._runs[k] = PlanExecution(key, self._course(k), steps=steps)

    def _course(self, world: int) -> ExecutablePlan | None:
        self.problems.pop(world, None)
        try:
            return self._plan(scenario_of_episode(self._simulator, world), world)
        except PlanningError as error:
            if self.strict:
                raise
            self.problems[world] = str(error)
            warnings.warn(f"world {world}: {error}; its robots rest", PlanWarning, stacklevel=4)
            return None

    def _plan(self, scenario: Scenario, world: int) -> ExecutablePlan:
        if self.plan is not None:
            course = ExecutablePlan.of(self.plan)
            check_plan(course, self.view, world)
            return course
        return self._plan_scenario(scenario, self.seed, self.time_limit)

    def _plan_scenario(self, scenario: Scenario, seed: int, time_limit: float) -> ExecutablePlan:
        return plan_executable(
            scenario,
            self.method,
            self.planner,
            seed=seed,
            time_limit=time_limit,
            way_points=self._simulator.actions == "way_points",
        )

    # Tracking

    @property
    def _tolerance(self) -> Floats:
        """Distance from the course beyond which each robot is late, m."""
        if self._simulator.actions == "way_points":
            return np.full(self.view.n_robots, WAY_POINT_TOLERANCE)
        return np.array(
            [robot.required_drive.base_drive.recovery_error for robot in self.view.robots]
        )

    def _references(self, q: Floats) -> Floats:
        """Configurations (worlds, robots, nq) of the plans at their clocks; q without a plan."""
        references = q.copy()
        for k, run in enumerate(self._runs):
            if run is not None and run.course is not None:
                for i, row in enumerate(run.course.at(run.clock)):
                    references[k, i, : len(row)] = row
        return references

    def _tracking_errors(self, q: Floats) -> Floats:
        """Distances from the courses (worlds, robots), m; 0 for robots at their goals."""
        errors, references, moving = np.zeros(q.shape[:2]), self._references(q), self.view.moving
        for i, robot in enumerate(self.view.robots):
            errors[:, i] = robot.displacement_bound(
                q[:, i, : robot.nq], references[:, i, : robot.nq]
            )
        keys = zip(self._simulator.seeds, self._simulator.episodes, strict=True)
        same = [
            run is not None and run.key == key for run, key in zip(self._runs, keys, strict=True)
        ]
        errors = np.where(moving & np.array(same)[:, None], errors, 0.0)
        self._max_error = max(self._max_error, float(errors.max()))
        return errors

    def _advance_clock(
        self, world: int, run: PlanExecution, q: Floats, off_course: Flags, late: Flags
    ) -> None:
        """Advance the clock, or stop it for late robots."""
        assert run.course is not None
        last, run.held = float(run.course.last), False
        if run.rate == 1.0 and run.clock == int(run.clock) and not off_course.any():
            run.clock = min(run.clock + 1.0, last)
            return
        for rate in clock_rates(run, bool(late.any())):
            clock = min(run.clock + rate, last)
            if self._reachable(world, run, q, off_course, clock) and self._certified(
                world, run, q, clock
            ):
                break
        else:
            clock, run.held = run.clock, True  # no rate is free: brake as hard as possible
        run.rate = 1.0 if clock == last else clock - run.clock
        run.waited, run.clock = run.waited + 1.0 - run.rate, clock

    def _reachable(
        self, world: int, run: PlanExecution, q: Floats, off_course: Flags, clock: float
    ) -> bool:
        """Whether all robots on their courses can follow the clock."""
        assert run.course is not None
        view, rows = self.view, run.course.at(clock)
        before, on = view.velocities[world], view.moving[world] & ~off_course

        def reachable(i: int) -> bool:
            robot = view.robots[i]
            current = q[i, : robot.nq]
            return robot.required_drive.reaches(robot, current, rows[i], before[i], view.dt)

        return all(reachable(i) for i in np.flatnonzero(on).tolist())

    def _certified(self, world: int, run: PlanExecution, q: Floats, *clocks: float) -> bool:
        """Whether the simultaneous motions through the plan at these clocks are certified free."""
        on = np.flatnonzero(self.view.moving[world]).tolist()
        if not on:
            return True
        names, models = [self.view.names[i] for i in on], [self.view.robots[i] for i in on]
        rows = [self._predicted(run, q, i, clocks) for i in on]
        return bool(free_steps(self.view.world(world), names, models, rows).all())

    def _predicted(self, run: PlanExecution, q: Floats, i: int, clocks: Sequence[float]) -> Floats:
        """Current and planned configurations of a robot at clocks, (1 + len(clocks), nq)."""
        assert run.course is not None
        ahead = [run.course.at(clock)[i] for clock in clocks]
        return np.array([q[i, : self.view.robots[i].nq], *ahead])

    def _tracking_actions(self, q: Floats, references: Floats) -> Floats:
        """Actions toward references, by the inverse models of the drives or by way points."""
        view, simulator = self.view, self._simulator
        reverse = np.zeros(q.shape[:2], dtype=bool)
        actions = np.zeros((view.n_worlds, view.n_robots, view.action_size))
        for i, robot in enumerate(view.robots):
            ends = q[:, i, : robot.nq], references[:, i, : robot.nq]
            if simulator.actions == "way_points":
                own, tracked = robot.required_drive.tracking_waypoint(
                    robot, *ends, view.dt, simulator.settings.way_point_seconds
                )
                reverse[:, i] = ~tracked
            else:
                own = robot.required_drive.tracking_action(robot, *ends, view.dt)
            actions[:, i, : own.shape[1]] = own
        if reverse.any():
            actions[reverse] = view.toward(references)[reverse]
        return actions


def plan(argument: str, seed: int) -> PlanPolicy:
    """Make the policy named `plan[:METHOD[:PLANNER]]` or `plan:FILE.npz`."""
    file = Path(argument)
    if file.suffix == ".npz" or (file.suffix and file.is_file()):
        return PlanPolicy(plan=argument)
    return PlanPolicy(*method_and_planner(argument), seed=seed)

"""A policy that drives a plan, and replans if the world differs from the plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fgenv.agents.policies.plan import PlanPolicy
from fgenv.agents.policies.plan_arguments import method_and_planner
from fgenv.agents.tracking.executable_plan import ExecutablePlan
from fgenv.agents.tracking.plan_clock import PlanExecution
from fgenv.agents.tracking.replan_problem import current_scenario, extrapolated
from fgenv.arrays import Flags, Floats, Floats32
from fgenv.envs import View
from fgenv.envs.recorder import scenario_of_episode
from fgenv.envs.state_readers import PARKED
from fgenv.planners import PlanningError

MIN_LOOK_AHEAD = 5  # certified steps
MAX_LOOK_AHEAD = 30  # certified steps
STRAY_STEPS = 8  # steps without progress toward its course after which a robot is a stray
REPLAN_STEPS = 10  # least steps between plans, unless a robot becomes a stray
RETURN_STEPS = 40  # steps after which a resting stray is planned for again
AT_REST = 1e-3  # m/s, rad/s


@dataclass
class Monitor:
    """State of an episode beside its plan.

    Attributes:
        strays: robots that do not follow their courses, (robots,).
        before: configurations at the last step, (robots, nq).
        planned: step of the episode of the last attempt to plan.
    """

    strays: Flags
    before: Floats
    planned: int = 0


class ReplanPolicy(PlanPolicy):
    """Drives a plan as `PlanPolicy` does, and looks ahead in the current world.

    Before each step, the next steps of the plan are certified from the robots' current
    configurations, as many steps as stopping takes. If a step is not free, all robots stop within
    the limits of their drives, and the rest of the episode is planned again. A robot without
    progress toward its course becomes a stray: it is assumed to continue its motion, the other
    robots are planned around it, and it is planned for again some steps later if it rests. If no
    plan is found, robots wait and the policy tries again.

    Args:
        method, planner, seed, time_limit, strict: see `PlanPolicy`.
        replan_time_limit: for planning again, s.

    Attributes:
        replans: number of new plans since the last reset.
    """

    def __init__(
        self,
        method: str | None = None,
        planner: str | None = None,
        *,
        replan_time_limit: float = 3.0,
        **options: Any,
    ) -> None:
        super().__init__(method, planner, **options)
        self.replan_time_limit, self.replans = replan_time_limit, 0

    def reset(self, view: View) -> None:
        """Plan new episodes."""
        self.replans = 0
        self._monitors: dict[int, tuple[PlanExecution, Monitor]] = {}
        super().reset(view)

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size)."""
        actions = super().act(observations)
        for k, (_, monitor) in self._monitors.items():
            monitor.before = self.view.configurations[k]
        return actions

    def _monitor(self, world: int, run: PlanExecution, q: Floats) -> Monitor:
        known = self._monitors.get(world)
        if known is None or known[0] is not run:
            known = run, Monitor(np.zeros(len(q), dtype=bool), q.copy(), run.steps)
            self._monitors[world] = known
        return known[1]

    def _advance_clock(
        self, world: int, run: PlanExecution, q: Floats, off_course: Flags, late: Flags
    ) -> None:
        assert run.course is not None
        monitor, moving = self._monitor(world, run, q), self.view.moving[world]
        ahead = [min(run.clock + j + 1, run.course.last) for j in range(self._steps)]
        blocked = not self._certified(world, run, q, *ahead)
        lagging = off_course & moving & ~monitor.strays
        new = lagging & (run.stuck >= STRAY_STEPS) & (late | blocked)
        monitor.strays = (monitor.strays | new) & moving
        since = 0 if (lagging & (run.stuck < STRAY_STEPS)).any() else run.steps - monitor.planned
        resting = self._resting_strays(monitor, q) & ~new & (since >= RETURN_STEPS)
        left = run.clock == run.course.last and (moving & ~monitor.strays).any()
        replan_due = new.any() or (since >= REPLAN_STEPS and (blocked or left or resting.any()))
        if replan_due and self._at_rest(world, monitor):
            monitor.strays &= ~resting
            self._replan(world, run, monitor, q)
            return
        stop = moving if blocked or replan_due else late & ~monitor.strays
        super()._advance_clock(world, run, q, off_course, stop)

    def _resting_strays(self, monitor: Monitor, q: Floats) -> Flags:
        """Strays that have not moved in the last step."""
        still: Flags = np.abs(q - monitor.before).max(axis=1) < AT_REST * self.view.dt
        return monitor.strays & still

    def _at_rest(self, world: int, monitor: Monitor) -> bool:
        on = self.view.moving[world] & ~monitor.strays
        return bool((np.abs(self.view.velocities[world][on]) < AT_REST).all())

    @property
    def _steps(self) -> int:
        """Number of steps to look ahead: the longest stop and a margin."""
        dt = self.view.dt
        longest = max(
            action.high / (action.rate * dt)
            for robot in self.view.robots
            for action in robot.actions
        )
        return min(MIN_LOOK_AHEAD + int(longest), MAX_LOOK_AHEAD)

    def _predicted(self, run: PlanExecution, q: Floats, i: int, clocks: Sequence[float]) -> Floats:
        for known, monitor in self._monitors.values():
            if known is run and monitor.strays[i]:
                model = self.view.robots[i]
                return extrapolated(
                    model, monitor.before[i, : model.nq], q[i, : model.nq], len(clocks)
                )
        return super()._predicted(run, q, i, clocks)

    def _replan(self, world: int, run: PlanExecution, monitor: Monitor, q: Floats) -> None:
        """Plan from the current state; without a plan all robots rest until the next attempt."""
        monitor.planned, moving = run.steps, self.view.moving[world]
        movers = np.flatnonzero(moving & ~monitor.strays).tolist()
        parked = self._simulator.status[world] == PARKED
        standing = np.flatnonzero(parked | monitor.strays).tolist()
        if not movers:
            return
        scenario = scenario_of_episode(self._simulator, world)
        problem, robots = current_scenario(scenario, self.view.robots, q, movers, standing)
        seed = self.seed + self.replans + 1
        try:
            course = self._plan_scenario(problem, seed, self.replan_time_limit)
            run.course = self._with_all_robots(course, robots, movers, q)
        except PlanningError as error:
            self.problems[world] = str(error)
            return
        self.problems.pop(world, None)
        self.replans += 1
        run.clock, run.rate, run.nearest = 0.0, 1.0, np.empty(0)

    def _with_all_robots(
        self, course: ExecutablePlan, robots: Sequence[int], movers: Sequence[int], q: Floats
    ) -> ExecutablePlan:
        """Extend a course of some robots to all; the other robots rest.

        Raises:
            PlanningError: the course moves a resting robot.
        """
        rows = [np.tile(q[i, : m.nq], (course.last + 1, 1)) for i, m in enumerate(self.view.robots)]
        for i, own in zip(robots, course.configurations, strict=True):
            if i not in movers and (own != own[0]).any():
                raise PlanningError(f"the plan moves {self.view.names[i]}, which rests")
            rows[i] = own
        return replace(course, configurations=tuple(rows), models=self.view.robots)


def replan(argument: str, seed: int) -> ReplanPolicy:
    """Make the policy named `replan[:METHOD[:PLANNER]]`."""
    return ReplanPolicy(*method_and_planner(argument), seed=seed)

"""A policy that drives a plan, and plans anew where the world is not as the plan took it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fgenv.agents.policies.plan import Planned
from fgenv.agents.tracking.executable_plan import Course
from fgenv.agents.tracking.plan_clock import Run
from fgenv.agents.tracking.replan_problem import from_here, onward
from fgenv.arrays import Flags, Floats, Floats32
from fgenv.envs import View
from fgenv.envs.recorder import scenario_of_episode
from fgenv.envs.state_readers import PARKED
from fgenv.planners import PlanningError

LOOK_AHEAD = 5  # steps that are proved, at least
STRAYED = 8  # steps after which a robot that comes no nearer to its course is not waited for
AGAIN = 10  # steps between plans at least, but where a robot strays
CHANCE = 40  # steps after which a stray that stands is counted on again
AT_REST = 1e-3  # m/s, rad/s
MOST_AHEAD = 30  # steps


@dataclass
class Watch:
    """What is watched of an episode beside its plan.

    Attributes:
        strays: robots that do not do as they are told, (robots,).
        before: configurations at the last step, (robots, nq).
        planned: step of the episode at which it was last planned, or tried.
    """

    strays: Flags
    before: Floats
    planned: int = 0


class Replanning(Planned):
    """Drives a plan as `Planned` does, and looks ahead in the world as it is.

    Before each step the next steps of the plan, as many as stopping takes, are proved from where
    robots are now. Where they are not, all stop as their drives can and are planned anew from
    there. A robot that comes no nearer to its course is not waited for: it is taken to go on as it
    does, the others plan around where it stands, and it is counted on again some steps later if it
    still stands there. Where no plan is found, robots wait and try again.

    Args:
        method, planner, seed, time_limit, strict: as `Planned`.
        again_limit: seconds for planning anew.

    Attributes:
        replans: plans made anew since the last reset.
    """

    def __init__(
        self,
        method: str | None = None,
        planner: str = "RRTConnect",
        *,
        again_limit: float = 3.0,
        **options: Any,
    ) -> None:
        super().__init__(method, planner, **options)
        self.again_limit, self.replans = again_limit, 0

    def reset(self, view: View) -> None:
        """Episodes begin: each is planned."""
        self.replans = 0
        self._watches: dict[int, tuple[Run, Watch]] = {}
        super().reset(view)

    def act(self, observations: Floats32) -> Floats:
        """Actions (worlds, robots, size)."""
        actions = super().act(observations)
        for k, (_, watch) in self._watches.items():
            watch.before = self.view.configurations[k]
        return actions

    def _watch(self, world: int, run: Run, q: Floats) -> Watch:
        known = self._watches.get(world)
        if known is None or known[0] is not run:
            known = run, Watch(np.zeros(len(q), dtype=bool), q.copy(), run.steps)
            self._watches[world] = known
        return known[1]

    def _tick(self, world: int, run: Run, q: Floats, out: Flags, late: Flags) -> None:
        assert run.course is not None
        watch, moving = self._watch(world, run, q), self.view.moving[world]
        ahead = [min(run.clock + j + 1, run.course.last) for j in range(self._steps)]
        blocked = not self._free(world, run, q, *ahead)
        awaited = out & moving & ~watch.strays
        new = awaited & (run.stuck >= STRAYED) & (late | blocked)
        watch.strays = (watch.strays | new) & moving
        since = 0 if (awaited & (run.stuck < STRAYED)).any() else run.steps - watch.planned
        back = self._back(watch, q) & ~new & (since >= CHANCE)
        left = run.clock == run.course.last and (moving & ~watch.strays).any()
        due = new.any() or (since >= AGAIN and (blocked or left or back.any()))
        if due and self._at_rest(world, watch):
            watch.strays &= ~back
            self._again(world, run, watch, q)
            return
        stop = moving if blocked or due else late & ~watch.strays
        super()._tick(world, run, q, out, stop)

    def _back(self, watch: Watch, q: Floats) -> Flags:
        """Strays that stand where they stood a step ago."""
        still: Flags = np.abs(q - watch.before).max(axis=1) < AT_REST * self.view.dt
        return watch.strays & still

    def _at_rest(self, world: int, watch: Watch) -> bool:
        on = self.view.moving[world] & ~watch.strays
        return bool((np.abs(self.view.velocities[world][on]) < AT_REST).all())

    @property
    def _steps(self) -> int:
        """Steps to look ahead: some more than stopping takes."""
        dt = self.view.dt
        longest = max(
            action.high / (action.rate * dt)
            for robot in self.view.robots
            for action in robot.actions
        )
        return min(LOOK_AHEAD + int(longest), MOST_AHEAD)

    def _expected(self, run: Run, q: Floats, i: int, clocks: Sequence[float]) -> Floats:
        for known, watch in self._watches.values():
            if known is run and watch.strays[i]:
                model = self.view.robots[i]
                return onward(model, watch.before[i, : model.nq], q[i, : model.nq], len(clocks))
        return super()._expected(run, q, i, clocks)

    def _again(self, world: int, run: Run, watch: Watch, q: Floats) -> None:
        """Plan anew from here; where there is no plan all stay, and it is tried again later."""
        watch.planned, moving = run.steps, self.view.moving[world]
        movers = np.flatnonzero(moving & ~watch.strays).tolist()
        parked = self._simulator.status[world] == PARKED
        standing = np.flatnonzero(parked | watch.strays).tolist()
        if not movers:
            return
        scenario = scenario_of_episode(self._simulator, world)
        now, places = from_here(scenario, self.view.robots, q, movers, standing)
        seed = self.seed + self.replans + 1
        try:
            found = self._find(now, seed, self.again_limit)
            run.course = self._whole(found, places, movers, q)
        except PlanningError as error:
            self.problems[world] = str(error)
            return
        self.problems.pop(world, None)
        self.replans += 1
        run.clock, run.rate, run.nearest = 0.0, 1.0, np.empty(0)

    def _whole(
        self, course: Course, places: Sequence[int], movers: Sequence[int], q: Floats
    ) -> Course:
        """A course of some robots as one of all: the others stand.

        Raises:
            PlanningError: it moves one that stands.
        """
        rows = [np.tile(q[i, : m.nq], (course.last + 1, 1)) for i, m in enumerate(self.view.robots)]
        for i, own in zip(places, course.configurations, strict=True):
            if i not in movers and (own != own[0]).any():
                raise PlanningError(f"the plan moves {self.view.names[i]}, which stands")
            rows[i] = own
        return replace(course, configurations=tuple(rows), models=self.view.robots)

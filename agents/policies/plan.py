"""A policy that plans each episode and drives the plan."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fgenv.agents.policies.observation import Seeing
from fgenv.agents.tracking.executable_plan import Course, find, slack
from fgenv.agents.tracking.executable_plan import late as late_from
from fgenv.agents.tracking.lookahead import free_steps
from fgenv.agents.tracking.plan_clock import Run, rates
from fgenv.agents.tracking.waypoint_tracking import can, drives, way_points
from fgenv.arrays import Flags, Floats, Floats32
from fgenv.envs import View
from fgenv.envs.recorder import scenario_of_episode
from fgenv.planners import Plan, PlanningError
from fgenv.scenarios import Scenario

LATE_BY_WAY_POINTS = 0.05  # meters: a way point 2 cm away is not driven at


class PlanWarning(UserWarning):
    """A world has no plan: its robots rest."""


class Planned(Seeing):
    """Plans every world's episode as it begins, and drives the plan.

    Robots are led from where they are to where the plan has them after the step, so that errors do
    not add up. If one is held up, the clock of the plan stops until it has caught up: the others
    wait for it, slowing down as their drives can, and each step off the clock is proved free
    before it is made. Nobody drives into anybody, but who never comes holds up all: `Replanning`
    does not wait for ever.

    With way points as actions, differential drives and cars take plans that do not back up only:
    who drives at way points turns round instead.

    Args:
        method, planner, time_limit: see `fgenv.planners.plan`.
        plan: to drive, in place of planning.
        seed: of what is random in planning.
        strict: a world without a plan is an error, else a warning, and its robots rest.

    Attributes:
        problems: why worlds have no plan, by their number.
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
        """Episodes begin: each is planned.

        Raises:
            PlanningError: if strict, where there is no plan.
        """
        super().reset(view)
        self._simulator = view._simulator  # a view has no scenario of its episodes
        self._runs: list[Run | None] = [None] * view.n_worlds
        self._worst = 0.0
        self._refresh()

    @property
    def tracking_error(self) -> float:
        """Meters by which any robot was farthest from its plan, from the last reset to now."""
        self._look(self.view.configurations)
        return self._worst

    @property
    def waited(self) -> float:
        """Seconds that the plans' clocks stood still for who was held up, in the worst world."""
        return (
            max((run.waited for run in self._runs if run is not None), default=0.0) * self.view.dt
        )

    def act(self, observations: Floats32) -> Floats:
        """Actions (worlds, robots, size)."""
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
        """Seed and number of each world's episode."""
        simulator = self._simulator
        return list(zip(simulator.seeds.tolist(), simulator.episodes.tolist(), strict=True))

    def _refresh(self) -> None:
        """Plan what has begun."""
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
            fit(course, self.view, world)
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
        """Meters: farther off its course each robot is late."""
        if self._simulator.actions == "way_points":
            return np.full(self.view.n_robots, LATE_BY_WAY_POINTS)
        return np.array([late_from(robot) for robot in self.view.robots])

    def _places(self, q: Floats) -> Floats:
        """Where the clocks have all robots, (worlds, robots, nq); where there is no plan, q."""
        places = q.copy()
        for k, run in enumerate(self._runs):
            if run is not None and run.course is not None:
                for i, row in enumerate(run.course.at(run.clock)):
                    places[k, i, : len(row)] = row
        return places

    def _look(self, q: Floats) -> Floats:
        """Meters that robots are off their courses, (worlds, robots); 0 of those who are there."""
        off, places, moving = np.zeros(q.shape[:2]), self._places(q), self.view.moving
        for i, robot in enumerate(self.view.robots):
            off[:, i] = robot.distance(q[:, i, : robot.nq], places[:, i, : robot.nq])
        keys = zip(self._simulator.seeds, self._simulator.episodes, strict=True)
        same = [
            run is not None and run.key == key for run, key in zip(self._runs, keys, strict=True)
        ]
        off = np.where(moving & np.array(same)[:, None], off, 0.0)
        self._worst = max(self._worst, float(off.max()))
        return off

    def _tick(self, world: int, run: Run, q: Floats, out: Flags, late: Flags) -> None:
        """The clock goes on, or waits for who is late; who is off its course is `out`."""
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
            clock, run.held = run.clock, True  # brake as hard as can be
        run.rate = 1.0 if clock == last else clock - run.clock
        run.waited, run.clock = run.waited + 1.0 - run.rate, clock

    def _can(self, world: int, run: Run, q: Floats, out: Flags, clock: float) -> bool:
        """Whether all that are on their courses can follow the clock."""
        assert run.course is not None
        before, on = self.view.velocities[world], self.view.moving[world] & ~out
        rows = run.course.at(clock)
        return all(
            can(self.view.robots[i], q[i, : len(rows[i])], rows[i], before[i], self.view.dt)
            for i in np.flatnonzero(on).tolist()
        )

    def _free(self, world: int, run: Run, q: Floats, *clocks: float) -> bool:
        """Whether the way to where clocks have all is proved, one after the other at once."""
        on = np.flatnonzero(self.view.moving[world]).tolist()
        if not on:
            return True
        names, models = [self.view.names[i] for i in on], [self.view.robots[i] for i in on]
        rows = [self._expected(run, q, i, clocks) for i in on]
        return bool(free_steps(self.view.world(world), names, models, rows).all())

    def _expected(self, run: Run, q: Floats, i: int, clocks: Sequence[float]) -> Floats:
        """Where a robot is now, and at clocks, (1 + len(clocks), nq)."""
        assert run.course is not None
        ahead = [run.course.at(clock)[i] for clock in clocks]
        return np.array([q[i, : self.view.robots[i].nq], *ahead])

    def _lead(self, q: Floats, places: Floats) -> Floats:
        """Actions to places: by the drives turned round, or by way points."""
        view, simulator = self.view, self._simulator
        backs = np.zeros(q.shape[:2], dtype=bool)
        asked = np.zeros((view.n_worlds, view.n_robots, view.action_size))
        for i, robot in enumerate(view.robots):
            ends = q[:, i, : robot.nq], places[:, i, : robot.nq]
            if simulator.actions == "way_points":
                own, led = way_points(robot, *ends, view.dt, simulator.way_point_seconds)
                backs[:, i] = ~led
            else:
                own = drives(robot, *ends, view.dt)
            asked[:, i, : own.shape[1]] = own
        if backs.any():
            asked[backs] = view.toward(places)[backs]
        return asked


def fit(course: Course, view: View, world: int) -> None:
    """PlanningError where a plan is not of a world's episode."""
    names = tuple(robot.name for robot in course.plan.scenario.robots)
    if names != view.names:
        raise PlanningError(f"plan: is of {', '.join(names)}, not of {', '.join(view.names)}")
    if course.plan.dt != view.dt:
        raise PlanningError(f"plan: has steps of {course.plan.dt} s, the simulator of {view.dt} s")
    for i, (name, model) in enumerate(zip(names, course.models, strict=True)):
        for told, row, q in (
            ("begins", course.plan.configurations[i][0], view.configurations),
            ("ends", course.plan.configurations[i][-1], view.goals),
        ):
            if model.nq != view.robots[i].nq or model.distance(
                row, q[world, i, : model.nq]
            ) > slack(model):
                raise PlanningError(
                    f"plan: {name!r} {told} elsewhere than in this episode;"
                    " run the scenario with the options that it was planned with"
                )

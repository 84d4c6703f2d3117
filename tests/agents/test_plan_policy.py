"""Policy `plan`: robots follow their plans, and wait for robots that are held up."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from support.episodes import alone
from support.plans import Held, driven

import fgenv
from fgenv.agents import PlanPolicy, PlanWarning, run_episode
from fgenv.agents.tracking.executable_plan import ExecutablePlan, at_goal
from fgenv.envs import FleetEnv, Simulator, View, policy_of
from fgenv.metrics import Results
from fgenv.planners import PlanningError
from fgenv.scenarios import Scenario

# Tracking


@pytest.mark.parametrize(
    ("name", "n", "policy", "most"),
    [
        ("swap", 4, "plan:prioritized", 1e-9),
        ("swap", 6, "plan:composite", 1e-9),
        ("doorway", 4, "plan", 1e-9),
        ("corridor", 2, "plan:conflict_based", 1e-9),
        ("warehouse", 4, "plan", 1e-9),
        ("forest", 2, "plan:composite", 1e-3),
        ("cell", 2, "plan", 1e-9),
        ("intersection", 3, "plan", 0.05),  # cars drive arcs, plans have chords
    ],
)
def test_robots_follow_their_plans(name: str, n: int, policy: str, most: float) -> None:
    results, made = driven(name, policy, n=n)
    assert results.success_rate == 1.0
    assert results.steps_in_contact == 0
    assert made.tracking_error <= most
    assert made.waited == 0.0


@pytest.mark.parametrize(
    ("name", "n", "policy"),
    [("forest", 2, "plan:composite"), ("cell", 2, "plan:composite"), ("swap", 3, "plan")],
)
def test_robots_follow_their_plans_by_way_points(name: str, n: int, policy: str) -> None:
    results, made = driven(name, policy, n=n, actions="way_points")
    assert results.success_rate == 1.0
    assert results.steps_in_contact == 0
    assert made.tracking_error < 1e-3


@pytest.mark.parametrize("kind", ["holonomic", "car", "drone", "joint_velocity"])
def test_a_way_point_gives_the_planned_velocity(kind: str) -> None:
    scenario = alone(kind, on_collision="pass")
    simulator = Simulator(scenario, actions="way_points", autoreset=False)
    simulator.reset(seed=0)
    rng, (robot,), moved = np.random.default_rng(0), simulator.robots, 0
    for _ in range(30):
        before = simulator.velocities[0, 0, : len(robot.actions)]
        low, high, rate = np.array([(a.low, a.high, a.rate) for a in robot.actions]).T
        room = np.minimum(rate * simulator.dt, 1.0)
        expected = np.clip(before + rng.uniform(-1, 1, len(low)) * room, 0.2 * high, 0.9 * high)
        if kind == "car":
            expected[1] = rng.uniform(-0.3, 0.3)
            expected[1] = np.clip(expected[1], before[1] - room[1], before[1] + room[1])
        drives = Simulator(scenario, autoreset=False)
        drives.reset(seed=0)
        drives.place(0, 0, simulator.configurations[0, 0], simulator.goals[0, 0])
        drives.step(((expected - (low + high) / 2) / ((high - low) / 2))[None, None])
        q, target = simulator.configurations[:, 0], drives.configurations[:, 0]
        asked = robot.required_drive.inverse(robot, q, target, simulator.dt)[0][0]
        actions, led = robot.required_drive.tracking_waypoint(robot, q, target, simulator.dt, 1.0)
        assert led.all()
        if (np.abs(asked - before) <= rate * simulator.dt + 1e-9).all():
            simulator.step(actions[:, None])
            np.testing.assert_allclose(simulator.velocities[0, 0, : len(low)], asked, atol=1e-6)
            moved += 1
        if simulator.status[0, 0]:
            break
    assert moved >= 3


def test_courses_end_at_the_goals() -> None:
    plan = fgenv.plan("swap", n=3, method="composite")
    course = ExecutablePlan.of(plan)
    for i, (model, spec) in enumerate(zip(course.models, plan.scenario.robots, strict=True)):
        q, goal = course.configurations[i], np.array(spec.goal)
        there = at_goal(model, spec, q, goal)
        stop = int(there.argmax())
        assert there[stop:].all()
        assert (q[stop:] == q[stop]).all()
        np.testing.assert_array_equal(q[: stop + 1], plan.configurations[i][: stop + 1])
        assert np.linalg.norm(q[-1][:2] - goal[:2]) <= spec.goal_tolerance.position


# Waiting


@pytest.mark.parametrize(
    ("name", "n", "span"),
    [("swap", 5, (15, 45)), ("warehouse", 4, (20, 50)), ("cell", 2, (3, 20))],
)
def test_robots_wait_for_a_robot_that_is_held_up(name: str, n: int, span: tuple[int, int]) -> None:
    simulator, policy = Simulator(name, n=n, autoreset=False), PlanPolicy("composite", strict=True)
    results = Results.of(run_episode(simulator, Held(policy, 0, *span)))
    assert results.success_rate == 1.0
    assert results.steps_in_contact == 0
    assert policy.waited > 0.5 * (span[1] - span[0]) * simulator.dt


def test_a_stopped_robot_blocks_all_others_without_collisions() -> None:
    simulator, policy = Simulator("swap", n=4, autoreset=False), PlanPolicy("composite")
    record = run_episode(simulator, Held(policy, 1, 10, 1000), steps=120)
    q = record["configurations"]
    assert (record["hits"] == -1).all()
    np.testing.assert_allclose(q[-60:], np.broadcast_to(q[-1], q[-60:].shape), atol=1e-9)


# Several worlds, and a learning robot


def test_worlds_are_planned_as_their_episodes_begin() -> None:
    simulator = Simulator("swap", worlds=3, n=2, starts="random", max_steps=200)
    policy = policy_of("plan:prioritized")
    observations = simulator.reset(seed=4)
    policy.reset(View(simulator))
    arrivals = np.zeros(3, dtype=int)
    for _ in range(250):
        step = simulator.step(policy.act(observations))
        observations = step.observations
        arrivals += step.terminated
        assert (simulator.hits == -1).all()
    assert (arrivals >= 1).all()
    assert (simulator.episodes >= 1).all()


def test_other_robots_can_follow_plans_in_a_training_loop() -> None:
    env = gymnasium.make("fgenv.envs:fgenv/swap-v0", n=3, others="plan:composite")
    assert isinstance(env.unwrapped, FleetEnv)
    for seed in range(2):
        env.reset(seed=seed)
        for _ in range(30):
            env.step(env.action_space.sample())


# Errors


def blocked(tmp_path: Path) -> Scenario:
    """Return a scenario without a solution."""
    wall = {"kind": "block", "size": [0.2, 30.0, 2.0]}
    scenario = alone("holonomic", 1)
    low, high = [-6.0, -6.0], [6.0, 6.0]
    spec = scenario.robots[0].model_copy(update={"start": (-3.0, 0, 0), "goal": (3.0, 0, 0)})
    shapes = {**{k: v.model_dump() for k, v in scenario.shapes.items()}, "wall": wall}
    plain = scenario.model_dump() | {"shapes": shapes, "workspace": {"low": low, "high": high}}
    plain |= {"robots": [spec.model_dump()], "bodies": [{"name": "wall", "shape": "wall"}]}
    return Scenario.model_validate(plain)


def test_a_world_without_a_plan_rests_with_a_warning_or_is_an_error(tmp_path: Path) -> None:
    simulator = Simulator(blocked(tmp_path), autoreset=False)
    simulator.reset(seed=0)
    policy = PlanPolicy(time_limit=0.3)
    with pytest.warns(PlanWarning, match="world 0: no path for robot"):
        policy.reset(View(simulator))
    assert "no path" in policy.problems[0]
    assert (policy.act(simulator.observe()) == 0).all()
    with pytest.raises(PlanningError, match="no path for robot"):
        PlanPolicy(time_limit=0.3, strict=True).reset(View(simulator))


def test_plans_with_reverse_motion_by_way_points_raise() -> None:
    with pytest.raises(
        PlanningError, match="backs up, which way points cannot express; use actions="
    ):
        driven("doorway", "plan:composite", n=2, actions="way_points")


def test_a_plan_of_another_episode_raises(tmp_path: Path) -> None:
    fgenv.plan("swap", n=2, method="composite").save(tmp_path / "p.npz")
    policy = policy_of(f"plan:{tmp_path / 'p.npz'}")
    assert isinstance(policy, PlanPolicy)
    policy.strict = True
    cases: tuple[tuple[dict[str, Any], str], ...] = (
        ({"n": 3}, "got robots robot 1, robot 2, expected robot 1, robot 2, robot 3"),
        ({"n": 2, "time_step": 0.05}, "got steps of 0.1 s, expected 0.05 s"),
        ({"n": 2, "size": 9.0}, "the start of 'robot 1' differs"),
    )
    for options, message in cases:
        simulator = Simulator("swap", **options)
        simulator.reset(seed=0)
        with pytest.raises(PlanningError, match=message):
            policy.reset(View(simulator))
    assert (
        Results.of(run_episode(Simulator("swap", n=2, autoreset=False), policy)).success_rate == 1
    )


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "plan:compsite",
            "method: got 'compsite', .*; did you mean 'composite'",
        ),
        (
            "replan:composite:RTT",
            "planner: got 'RTT', .*; did you mean 'RRT'",
        ),
        ("goto:composite", "got 'goto:composite', expected 'goto' without an argument"),
        ("orca:straight", "got 'orca:straight', expected orca or orca:shortest"),
        ("plann", "policy: got 'plann', .*; did you mean 'plan'"),
    ],
)
def test_unknown_names_raise(name: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        policy_of(name)

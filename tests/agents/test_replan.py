"""Policy `replan`: worlds that differ from the plan."""

from __future__ import annotations

import numpy as np
import pytest
from support.plans import Held, driven

from fgenv.agents import ReplanPolicy, run_episode
from fgenv.agents.tracking.replan_problem import current_scenario, extrapolated
from fgenv.envs import Policy, Simulator, View, policy_of
from fgenv.metrics import Results


class Mixed:
    """One robot follows another policy than the others."""

    def __init__(self, policy: Policy, other: Policy) -> None:
        self.both = policy, other

    def reset(self, view: View) -> None:
        for policy in self.both:
            policy.reset(view)

    def act(self, observations: np.ndarray) -> np.ndarray:
        actions, other = (policy.act(observations) for policy in self.both)
        actions[:, 0] = other[:, 0]
        return np.asarray(actions)


@pytest.mark.parametrize(("name", "n"), [("swap", 4), ("doorway", 3), ("cell", 2)])
def test_without_disturbance_robots_follow_the_plan(name: str, n: int) -> None:
    results, policy = driven(name, "replan:composite", n=n)
    assert isinstance(policy, ReplanPolicy)
    assert results.success_rate == 1.0
    assert (results.steps_in_contact, policy.replans) == (0, 0)
    assert policy.tracking_error < 1e-9


@pytest.mark.parametrize("name", ["swap", "warehouse"])
def test_robots_drive_around_a_stopped_robot(name: str) -> None:
    simulator, policy = (
        Simulator(name, n=4, autoreset=False),
        ReplanPolicy("prioritized", replan_time_limit=60.0),
    )
    record = run_episode(simulator, Held(policy, 1, 10, 10_000), steps=200)
    results = Results.of(record)
    assert (record["hits"] == -1).all()
    assert policy.replans >= 1
    assert sum(robot.success for robot in results.robots) == 3


def test_a_stray_that_rests_is_planned_for_again() -> None:
    simulator, policy = (
        Simulator("swap", n=4, autoreset=False),
        ReplanPolicy("prioritized", replan_time_limit=60.0),
    )
    results = Results.of(run_episode(simulator, Held(policy, 1, 10, 60)))
    assert results.success_rate == 1.0
    assert results.steps_in_contact == 0


@pytest.mark.parametrize("seed", range(3))
def test_no_robot_drives_into_one_of_another_policy(seed: int) -> None:
    simulator = Simulator("swap", n=4, seed=seed, jitter=0.3, autoreset=False)
    policy = ReplanPolicy("prioritized", seed=seed, replan_time_limit=60.0)
    record = run_episode(simulator, Mixed(policy, policy_of("random", seed)), steps=100)
    # Collisions involve that robot only, when it moves into the way of others.
    met = record["hit_robots"][:, 1:]
    assert np.isin(met, (-1, 0)).all()
    assert (record["hits"][:, 0] >= 0)[(met == 0).any(axis=1)].all()
    assert sum(robot.success for robot in Results.of(record).robots[1:]) >= 1


def test_the_problem_has_resting_robots_as_bodies() -> None:
    simulator = Simulator("swap", n=3)
    simulator.reset(seed=0)
    q = simulator.configurations[0]
    now, places = current_scenario(simulator.scenario, simulator.robots, q, [0], [2])
    assert places == (0,)
    assert [robot.name for robot in now.robots] == ["robot 1"]
    assert now.bodies[-1].name == "robot 3"
    world, like = now.build().world(), simulator.world()
    np.testing.assert_allclose(world.poses("robot 3"), like.poses("robot 3"), atol=1e-12)


def test_strays_continue_their_motion() -> None:
    (robot,) = Simulator("swap", n=1).robots
    rows = extrapolated(robot, np.array([0.0, 0.0, 3.0]), np.array([0.1, 0.2, -3.1]), 2)
    turn = 2 * np.pi - 6.1
    np.testing.assert_allclose(rows[:, :2], [[0.1, 0.2], [0.2, 0.4], [0.3, 0.6]])
    np.testing.assert_allclose(rows[:, 2], [-3.1, -3.1 + turn, -3.1 + 2 * turn])

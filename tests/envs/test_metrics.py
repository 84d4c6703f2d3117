"""Results of simple episodes against known values, and of records against simulators."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from support.episodes import alone

from fgenv.agents import GoToPolicy, run_episode
from fgenv.envs import Simulator, policy_of
from fgenv.metrics import Results, path_length
from fgenv.robots import Joint, Link, Robot
from fgenv.scenarios import Scenario


def lane(*goals: float, wall: float | None = None, **fields: Any) -> Scenario:
    """Cubes of 0.4 m in lanes 1 m apart drive at 1 m/s along x from 0 to their goals."""
    cube = {"kind": "box", "size": (0.4, 0.4, 0.4)}
    drive = {"kind": "holonomic", "speed": 1.0, "turn_rate": 1.0}
    robots = [
        {
            "name": f"robot {i + 1}",
            "model": "m",
            "start": (0.0, float(i), 0.0),
            "goal": (goal, float(i), 0.0),
            "goal_tolerance": {"position": 1e-6, "angle": 0.1},
        }
        for i, goal in enumerate(goals)
    ]
    bodies = [] if wall is None else [{"name": "wall", "shape": "cube", "position": (wall, 0, 0)}]
    document: dict[str, Any] = {
        "version": 1,
        "name": "lanes",
        "time_step": 0.1,
        "horizon": 5.0,
        "shapes": {"cube": cube},
        "models": {"m": {"shape": "cube", "drive": drive}},
        "robots": robots,
        "bodies": bodies,
    }
    return Scenario.model_validate(document | fields)


def driven(scenario: Scenario | str, policy: str = "goto", **options: Any) -> Results:
    """Return the results of a simulator, equal to those of its record."""
    simulator = Simulator(scenario, autoreset=False, clearance=True, **options)
    record = run_episode(simulator, policy_of(policy), steps=60)
    results = Results.of(simulator)
    assert Results.of(record) == results
    return results


def test_robots_that_arrive() -> None:
    results = driven(lane(2.0, 1.0))
    one, two = results.robots
    assert [one.arrival, two.arrival] == pytest.approx([2.0, 1.0])
    assert [one.path_length, two.path_length] == pytest.approx([2.0, 1.0])
    assert (one.unit, one.success, one.steps_in_contact) == ("m", True, 0)
    assert one.least_clearance == pytest.approx(0.6, abs=1e-6)
    assert results.makespan == pytest.approx(2.0)
    assert results.sum_of_costs == pytest.approx(3.0)
    assert results.steps == 20
    assert results.seconds == pytest.approx(2.0)
    assert (results.success_rate, results.arrived, results.steps_in_contact) == (1.0, 2, 0)


def test_robots_stopped_at_a_wall_do_not_arrive() -> None:
    results = driven(lane(3.0, 1.0, wall=1.85))
    one, two = results.robots
    assert (one.arrival, one.success, two.success) == (None, False, True)
    assert one.steps_in_contact == 50 - 14  # first contact 1.45 m from the start
    assert one.path_length == pytest.approx(1.45, abs=1e-4)
    assert one.least_clearance == pytest.approx(0.0, abs=1e-4)
    assert (results.makespan, results.sum_of_costs) == (None, None)
    assert (results.success_rate, results.steps_in_contact) == (0.5, 36)
    assert results.steps == 50


def test_robots_that_pass_through_a_wall_arrive_without_success() -> None:
    results = driven(lane(3.0, wall=1.85, on_collision="pass"))
    (robot,) = results.robots
    assert robot.arrival == pytest.approx(3.0)
    assert robot.steps_in_contact > 0
    assert (results.arrived, results.success_rate, results.makespan) == (1, 0.0, robot.arrival)
    assert results.least_clearance == 0.0


def test_clearance_without_bodies_is_none() -> None:
    results = driven(lane(1.0))
    assert results.least_clearance is None
    assert results.facts["least_clearance"] is None
    assert results.facts["robots"][0]["least_clearance"] is None


@pytest.mark.parametrize("policy", ["goto", "random"])
@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("swap", {"n": 5, "at_goal": "vanish"}),
        ("forest", {"n": 2, "on_collision": "pass"}),
        ("cell", {}),
        ("intersection", {"n": 3, "on_collision": "terminate"}),
        ("warehouse", {"n": 4, "actions": "way_points"}),
    ],
)
def test_results_of_a_record_equal_those_of_the_simulator(
    name: str, options: dict[str, Any], policy: str
) -> None:
    facts = driven(name, policy, **options).facts
    assert json.loads(json.dumps(facts, allow_nan=False)) == facts


def test_path_length_of_an_arm_is_in_radians() -> None:
    scenario = alone("joint_velocity", 3)
    (robot,) = driven(scenario).robots
    direct = np.subtract(scenario.robots[0].goal, scenario.robots[0].start)
    assert robot.unit == "rad"
    # Joints arrive one by one within the tolerance: the path is hardly longer than straight.
    assert np.linalg.norm(direct) - 0.5 < robot.path_length <= np.abs(direct).sum()


def test_continuous_joints_turn_the_shorter_way() -> None:
    joint = Joint("j", "continuous", "a", "b", velocity=1.0)
    robot = Robot("r", (Link("a"), Link("b")), (joint,))
    assert path_length(robot, np.array([[3.0], [-3.0]])) == pytest.approx(2 * math.pi - 6.0)
    assert path_length(robot, np.array([[3.0]])) == 0.0


def test_results_before_the_first_step() -> None:
    simulator = Simulator("cell", autoreset=False)
    results = Results.of(run_episode(simulator, GoToPolicy(), steps=0))
    assert (results.steps, results.steps_in_contact, results.arrived) == (0, 0, 0)


def test_results_per_world() -> None:
    simulator = Simulator("swap", 2, n=2, jitter=0.3, autoreset=False)
    simulator.reset(seed=0)
    actions = np.zeros((2, 2, 2))
    actions[1] = 1.0
    simulator.step(actions)
    at_rest, driving = (Results.of(simulator, k).robots[0] for k in (0, 1))
    assert at_rest.path_length == 0.0 < driving.path_length
    with pytest.raises(ValueError, match="world: got 2, expected 0 to 1"):
        Results.of(simulator, 2)

"""The batched simulator: drives, sensors, goals, contacts and rewards, by laws and by independent
computation."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fgenv.arrays import Floats, Ints
from fgenv.collision import distance
from fgenv.envs import Observation, Reward, Simulator
from fgenv.envs.simulator import StepResult
from fgenv.envs.spaces import observation_box
from fgenv.envs.state_readers import GONE, MOVING, PARKED
from fgenv.robots import DifferentialDrive
from fgenv.scenarios import Scenario, frozen
from fgenv.scenarios.drive_specs import DriveSpec

pytestmark = pytest.mark.native

QUIET = Observation(lidar=False, neighbors=0)


def arena(
    n: int = 2,
    *,
    drive: dict[str, Any] | None = None,
    shape: str = "cart",
    side: float = 20.0,
    gap: float = 1.5,
    base: str = "planar",
    bodies: Sequence[dict[str, Any]] = (),
    **fields: Any,
) -> Scenario:
    """Robots in a row along y, heading along x, their goals 8 m ahead."""
    drive = drive or {"kind": "holonomic", "speed": 1.0, "turn_rate": 2.0}
    row = [(-4.0, gap * (i - (n - 1) / 2)) for i in range(n)]
    tail = (0.0,) if base == "planar" else (1.0, 0.0, 0.0, 0.0, 1.0)
    robots = [
        {"name": f"r{i}", "model": "m", "start": (x, y, *tail), "goal": (x + 8.0, y, *tail)}
        for i, (x, y) in enumerate(row)
    ]
    z = () if base == "planar" else (0.0,), () if base == "planar" else (side,)
    half = side / 2
    return Scenario.model_validate(
        {
            "version": 1,
            "name": "arena",
            "workspace": {"low": (-half, -half, *z[0]), "high": (half, half, *z[1])},
            "shapes": {"s": {"kind": shape}, "wall": {"kind": "block", "size": (0.2, 4.0, 1.0)}},
            "models": {"m": {"shape": "s", "drive": drive, "base": base}},
            "robots": robots,
            "bodies": [{"name": f"wall {k}", "shape": "wall", **b} for k, b in enumerate(bodies)],
            **fields,
        }
    )


def still(simulator: Simulator) -> Floats:
    return np.zeros((simulator.n_worlds, simulator.n_robots, simulator.action_size))


def step_until(simulator: Simulator, action: Floats, condition: Callable[[], object]) -> StepResult:
    """Return the step after which a condition holds."""
    for _ in range(200):
        step = simulator.step(action)
        if condition():
            return step
    raise AssertionError("the condition never holds")


def step_until_arrival(simulator: Simulator) -> StepResult:
    """Return the step in which the first robot arrives."""
    for _ in range(200):
        step = simulator.step(simulator.toward(simulator.goals))
        if simulator.status[0, 0] != MOVING:
            return step
    raise AssertionError("the robot never arrives")


def test_a_holonomic_robot_moves_by_its_action() -> None:
    simulator = Simulator(arena(1), observation=QUIET)
    simulator.reset()
    action = still(simulator)
    action[0, 0] = 0.5, -0.25, 0.0  # m/s
    for _ in range(10):
        simulator.step(action)
    np.testing.assert_allclose(simulator.configurations[0, 0], [-3.5, -0.25, 0.0], atol=1e-12)
    np.testing.assert_allclose(simulator.velocities[0, 0], [0.5, -0.25, 0.0])


@pytest.mark.parametrize("kind", ["differential", "car"])
def test_wheels_drive_arcs(kind: str) -> None:
    more = {"wheelbase": 0.5, "min_turning_radius": 1.0} if kind == "car" else {"turn_rate": 1.0}
    simulator = Simulator(arena(1, drive={"kind": kind, "speed": 1.0, **more}), observation=QUIET)
    simulator.reset()
    action = still(simulator)
    action[...] = 1.0  # 1 m/s on a circle of 1 m to the left
    for step in range(1, 40):
        simulator.step(action)
        x, y, yaw = simulator.configurations[0, 0]
        angle = 0.1 * step
        np.testing.assert_allclose([x + 4, y], [np.sin(angle), 1 - np.cos(angle)], atol=1e-9)
        assert abs(np.angle(np.exp(1j * (yaw - angle)))) < 1e-9


def test_a_drone_stays_level_and_climbs() -> None:
    drive = {"kind": "drone", "speed": 1.0, "turn_rate": 1.0, "climb": 0.5}
    simulator = Simulator(arena(1, drive=drive, shape="quadcopter", base="free"), observation=QUIET)
    simulator.reset()
    action = still(simulator)
    action[0, 0] = 0.0, 0.0, 1.0, 1.0
    for _ in range(10):
        simulator.step(action)
    x, y, z, *turn = simulator.configurations[0, 0]
    np.testing.assert_allclose([x, y, z], [-4, 0, 1.5], atol=1e-12)
    np.testing.assert_allclose(turn, [0, 0, np.sin(0.5), np.cos(0.5)], atol=1e-12)


def test_accelerations_are_limited() -> None:
    drive = {"kind": "differential", "speed": 1.0, "turn_rate": 2.0, "acceleration": 0.5}
    simulator = Simulator(arena(1, drive=drive), observation=QUIET)
    simulator.reset()
    action = still(simulator)
    action[0, 0, 0] = 1.0
    speeds = []
    for _ in range(30):
        simulator.step(action)
        speeds.append(simulator.velocities[0, 0, 0])
    np.testing.assert_allclose(speeds, np.minimum(0.05 * np.arange(1, 31), 1.0))


def test_robots_stay_in_the_workspace() -> None:
    simulator = Simulator(arena(1, horizon=1e4), observation=QUIET)
    simulator.reset()
    action = still(simulator)
    action[0, 0, :2] = -1.0, 1.0
    for _ in range(300):
        simulator.step(action)
    np.testing.assert_array_equal(simulator.configurations[0, 0, :2], [-10.0, 10.0])


CROWDS = {
    "discs": lambda: Simulator("swap", 2, n=64, size=26.0, observation=QUIET, starts="random"),
    "l": lambda: Simulator("swap", 2, n=24, body="l", size=12.0, jitter=0.2, observation=QUIET),
    "warehouse": lambda: Simulator("warehouse", 1, n=64, observation=QUIET),
    "drones": lambda: Simulator("forest", 2, n=8, observation=QUIET, starts="random"),
    "arms": lambda: Simulator("cell", 2, n=3, observation=QUIET),
}


def crowded(n: int = 64) -> Scenario:
    """Carts packed so tightly that none can drive far."""
    scenario = arena(n, gap=1.0)
    robots = [
        r.model_copy(update={"start": (0.95 * (i % 8), 0.75 * (i // 8), 0.0)})
        for i, r in enumerate(scenario.robots)
    ]
    return scenario.replace(robots=tuple(robots))


@pytest.mark.parametrize("crowd", [*CROWDS, "packed"])
def test_no_robots_overlap_after_any_step(crowd: str) -> None:
    simulator = Simulator(crowded(), observation=QUIET) if crowd == "packed" else CROWDS[crowd]()
    simulator.reset(seed=3)
    rng = np.random.default_rng(0)
    hits = 0
    for step in range(40):
        simulator.step(simulator.sample(rng))
        hits += int((simulator.hits >= 0).sum())
        if step % 4 == 3:
            for k in range(simulator.n_worlds):
                assert len(simulator.world(k).contact_pairs()) == 0
    assert hits > (20 if crowd in ("packed", "arms", "warehouse") else 0)


@given(seed=st.integers(0, 2**32), body=st.sampled_from(["disc", "long", "l"]))
@settings(max_examples=15, deadline=None)
def test_no_robots_overlap_with_random_actions(seed: int, body: str) -> None:
    simulator = Simulator("swap", n=12, body=body, size=8.0, observation=QUIET)
    simulator.reset(seed=seed)
    rng = np.random.default_rng(seed)
    towards = simulator.toward(simulator.goals)
    for _ in range(25):
        noise = simulator.sample(rng)
        towards = np.clip(simulator.toward(simulator.goals) + noise, -1, 1)
        simulator.step(towards)
        assert len(simulator.world().contact_pairs()) == 0


def test_a_collision_reports_body_time_and_point() -> None:
    scenario = arena(1, bodies=[{"position": (0.0, 0.0, 0.0)}])
    simulator = Simulator(scenario, observation=QUIET)
    simulator.reset()
    action = still(simulator)
    action[0, 0, 0] = 1.0
    step_until(simulator, action, simulator.collisions)
    (collision,) = simulator.collisions()
    assert (collision.robot, collision.other, collision.with_robot) == ("r0", "wall 0", False)
    world = simulator.world()
    cart, wall = world.record("r0"), world.record("wall 0")
    gap = distance(cart.shape, cart.pose, wall.shape, wall.pose)
    assert 0 < gap <= simulator.settings.tolerance
    front = cart.shape.vertices[:, 0].max()
    assert abs(collision.point[0] + 0.1) < 2e-4  # the wall's side
    traveled = -0.1 - front - -4.0
    assert abs((simulator.steps[0] - 1) * 0.1 + collision.time - traveled) < 2e-4
    assert simulator.collision_counts.tolist() == [[1]]
    assert simulator.velocities[0, 0].tolist() == [0, 0, 0]
    simulator.step(action)  # it drives on, and stops at once
    (again,) = simulator.collisions()
    assert again.time < 1e-3
    assert simulator.collision_counts.tolist() == [[2]]


def test_both_robots_of_a_collision_stop_and_name_each_other() -> None:
    scenario = arena(2, gap=1.2)
    simulator = Simulator(scenario, observation=QUIET)
    simulator.reset()
    action = still(simulator)
    action[0, :, 1] = 1.0, -1.0
    step_until(simulator, action, simulator.collisions)
    first, second = simulator.collisions()
    assert (first.other, second.other) == ("r1", "r0")
    assert first.with_robot
    assert second.with_robot
    assert first.time == second.time
    np.testing.assert_allclose(first.point, second.point, atol=3e-4)


@pytest.mark.parametrize("response", ["stop", "terminate", "pass"])
def test_responses(response: str) -> None:
    scenario = arena(2, bodies=[{"position": (-2.0, -0.75, 0.0)}], on_collision=response)
    simulator = Simulator(scenario, observation=QUIET, autoreset=False)
    simulator.reset()
    action = still(simulator)
    action[0, :, 0] = 1.0
    step = step_until(simulator, action, simulator.collisions)
    assert step.terminated[0] == (response == "terminate")
    if response == "terminate":
        with pytest.raises(RuntimeError, match=r"world 0 is over, call reset\(\)"):
            simulator.step(action)
        return
    for _ in range(30):
        simulator.step(action)
    x = simulator.configurations[0, :, 0]
    assert (x > -1.5).tolist() == [response == "pass"] * 2


@pytest.mark.parametrize("at_goal", ["park", "vanish"])
def test_robots_park_or_vanish_at_the_goal(at_goal: str) -> None:
    simulator = Simulator(arena(2, at_goal=at_goal), observation=QUIET, autoreset=False)
    simulator.reset()
    simulator.place(0, 0, [-4.0, 0.0, 0.0], [-2.0, 0.0, 0.0])
    simulator.place(0, 1, [-6.0, 0.0, 0.0], [4.0, 0.0, 0.0])
    step = step_until_arrival(simulator)
    assert not step.terminated[0]
    assert simulator.status[0, 0] == (PARKED if at_goal == "park" else GONE)
    assert simulator.arrival_steps[0, 0] == simulator.steps[0]
    assert ("r0" in simulator.world().names) == (at_goal == "park")
    rest = simulator.configurations[0, 0].copy()
    for _ in range(150):
        step = simulator.step(simulator.toward(simulator.goals))
        if step.terminated[0]:
            break
    np.testing.assert_array_equal(simulator.configurations[0, 0], rest)
    assert step.terminated[0] == (at_goal == "vanish")
    assert (simulator.collision_counts[0, 1] > 0) == (at_goal == "park")


def test_the_horizon_truncates_and_worlds_reset() -> None:
    simulator = Simulator(arena(2, horizon=1.0), 3, observation=QUIET)
    first = simulator.reset(seed=5)
    for _ in range(9):
        assert not simulator.step(simulator.sample()).truncated.any()
    step = simulator.step(simulator.sample())
    assert step.truncated.all()
    assert not step.terminated.any()
    np.testing.assert_array_equal(step.observations, first)  # those of the next episode
    assert simulator.final_observations is not None
    assert (simulator.final_observations != first).any()
    np.testing.assert_array_equal(simulator.episodes, [1, 1, 1])
    np.testing.assert_array_equal(simulator.seeds, [5, 6, 7])


# Observations


def test_lidar_measures_exact_meshes() -> None:
    seen = Observation(goal=False, velocity=False, neighbors=0, rays=37, lidar_range=4.0)
    simulator = Simulator("warehouse", 1, n=12, observation=seen)
    rows = simulator.reset()
    angles = 2 * np.pi * np.arange(37) / 37
    for _ in range(3):
        rows = simulator.step(simulator.sample(np.random.default_rng(1))).observations
    world = simulator.world()
    (part,) = simulator.layouts[0]
    assert (part.name, part.slice, part.unit) == ("lidar", slice(0, 37), "m")
    for i, name in enumerate(simulator.names):
        x, y, yaw = simulator.configurations[0, i]
        c, s = np.cos(yaw), np.sin(yaw)
        lidar = simulator.scenario.models["cart"].lidar
        assert lidar is not None
        position = lidar.position
        at = np.array([x + c * position[0] - s * position[1], y, position[2]])
        at[1] += s * position[0] + c * position[1]
        rays = np.stack([np.cos(angles + yaw), np.sin(angles + yaw), 0 * angles], axis=-1)
        expected = world.raycast(at, rays, max_distance=4.0, ignore=[name]).distance
        np.testing.assert_allclose(rows[0, i], np.minimum(expected, 4.0), atol=1e-5)


def test_goal_velocity_and_neighbors_are_in_the_own_frame() -> None:
    seen = Observation(configuration=True, neighbors=3, lidar=False)
    simulator = Simulator("swap", n=6, body="l", jitter=0.2, observation=seen)
    simulator.reset(seed=1)
    rng = np.random.default_rng(2)
    for _ in range(12):
        rows = simulator.step(simulator.sample(rng)).observations[0].astype(float)
    q, goal, v = (a[0] for a in (simulator.configurations, simulator.goals, simulator.velocities))
    parts = {p.name: p.slice for p in simulator.layouts[0]}
    turn = np.array([[[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]] for a in q[:, 2]])
    for i in range(6):
        there = turn[i].T @ (goal[i, :2] - q[i, :2])
        off = goal[i, 2] - q[i, 2]
        np.testing.assert_allclose(
            rows[i, parts["goal"]], [*there, np.cos(off), np.sin(off)], atol=1e-6
        )
        np.testing.assert_allclose(rows[i, parts["velocity"]], v[i], atol=1e-6)
        np.testing.assert_allclose(rows[i, parts["configuration"]], q[i], atol=1e-6)
        far = np.linalg.norm(q[:, :2] - q[i, :2], axis=1)
        near = np.argsort(far, kind="stable")[1:4]
        expected = []
        for j in near:
            by = turn[i].T @ (q[j, :2] - q[i, :2])
            drift = turn[i].T @ (turn[j] @ v[j, :2] - turn[i] @ v[i, :2])
            off = q[j, 2] - q[i, 2]
            vertices = simulator.robots[j].parts[0].shape.vertices
            radius = np.linalg.norm(vertices, axis=1).max()
            expected += [*by, np.cos(off), np.sin(off), *drift, radius]
        np.testing.assert_allclose(rows[i, parts["neighbors"]], expected, atol=1e-5)


@pytest.mark.parametrize("name", ["swap", "forest"])
def test_neighbors_fade_with_the_distance_between_circles(name: str) -> None:
    plain = Observation(goal=False, velocity=False, lidar=False, neighbors=4)
    fading = dataclasses.replace(plain, neighbor_range=2.0)
    whole, faded = (Simulator(name, n=5, observation=seen) for seen in (plain, fading))
    rng = np.random.default_rng(0)
    actions = rng.uniform(-1, 1, (40, 1, 5, whole.action_size))
    for simulator in (whole, faded):
        simulator.reset(seed=3)
    shares, axes = [], 2 if name == "swap" else 3
    radii = [np.linalg.norm(r.parts[0].shape.vertices, axis=1).max() for r in whole.robots]
    for action in actions:
        rows = [simulator.step(action).observations[0] for simulator in (whole, faded)]
        plain, fading = (row.reshape(5, 4, -1).astype(float) for row in rows)
        far = np.linalg.norm(plain[..., :axes], axis=-1)
        share = np.maximum(0.0, 1.0 - (far - plain[..., -1] - np.array(radii)[:, None]) / 2.0)
        shares.append(share)
        expected = plain.copy()
        expected[..., :axes] /= far[..., None]
        np.testing.assert_allclose(fading, expected * share[..., None], atol=1e-5)
    assert (np.array(shares) == 0).any()
    assert (np.array(shares) > 0).any()


def test_with_priorities_those_who_go_first_come_first_and_stay_within_the_space() -> None:
    seen = Observation(lidar=False, neighbors=2, neighbor_range=2.0, priority=True, pad=True)
    scenario = Scenario.load("swap", n=4).model_copy(update={"on_collision": "pass"})
    rng = np.random.default_rng(0)
    simulator, every = (
        Simulator(scenario, 3, observation=each)
        for each in (seen, dataclasses.replace(seen, neighbors=3, priority=False))
    )
    part = next(p.slice for p in simulator.layouts[0] if p.name == "neighbors")
    space = observation_box(simulator, 0)
    simulator.reset()
    every.reset()
    for _ in range(60):  # through each other, where closeness is over 1
        actions = np.clip(simulator.toward(simulator.goals) + rng.normal(0, 0.2, (3, 4, 2)), -1, 1)
        rows = simulator.step(actions).observations
        assert all(space.contains(row) for row in rows.reshape(12, -1))
        others = rows[..., part].reshape(3, 4, 2, 2, 7)
        near = every.step(actions).observations[..., part.start :].reshape(3, 4, 3, 7)
        q = simulator.configurations[..., :2]
        for w, i in np.ndindex(3, 4):
            order = np.argsort(np.linalg.norm(q[w] - q[w, i], axis=-1), kind="stable")[1:]
            for group, which in enumerate((order < i, order > i)):
                expected = np.zeros((2, 7))
                expected[: min(2, which.sum())] = near[w, i, which][:2]
                np.testing.assert_array_equal(others[w, i, group], expected)


@pytest.mark.parametrize(("name", "axes"), [("swap", 2), ("forest", 3)])
def test_neighbors_include_their_goals_and_rows_are_in_the_space(name: str, axes: int) -> None:
    rng = np.random.default_rng(0)
    seen = Observation(lidar=False, goal=False, velocity=False, neighbors=3, intent=True)
    simulator = Simulator(Scenario.load(name, n=4), 2, observation=seen)
    space = observation_box(simulator, 0)
    rows = simulator.reset()
    for _ in range(10):
        rows = simulator.step(0.3 * simulator.sample(rng) + 0.5).observations
        assert all(space.contains(row) for row in rows.reshape(8, -1))
        at, goals = simulator.configurations[..., :axes], simulator.goals[..., :axes]
        for w, i in np.ndindex(2, 4):
            robot = simulator.robots[i]
            base = robot.forward(simulator.configurations[w, i, : robot.nq], 0)
            near = np.argsort(np.linalg.norm(at[w] - at[w, i], axis=-1), kind="stable")[1:]
            to_goals = rows[w, i].reshape(3, -1)[:, -axes:]
            np.testing.assert_allclose(
                to_goals, (goals[w, near] - at[w, near]) @ base[:axes, :axes], atol=1e-5
            )


def test_the_path_hint_is_a_point_ahead_on_the_path() -> None:
    seen = Observation(
        goal=False, velocity=False, neighbors=0, lidar=False, path_hint=True, look_ahead=2.0
    )
    simulator = Simulator(arena(1), observation=seen)
    np.testing.assert_allclose(simulator.reset()[0, 0], [2.0, 0.0], atol=1e-6)
    corner = [[-4.0, 0.0, 0.0], [-3.0, 0.0, 0.0], [-3.0, 5.0, 1.0]]
    simulator.set_path(0, 0, corner)
    np.testing.assert_allclose(simulator.observe()[0, 0], [1.0, 1.0], atol=1e-6)
    simulator.set_path(0, 0, [[-4.0, 0.0, 0.0], [-3.5, 0.0, 0.0]])
    np.testing.assert_allclose(simulator.observe()[0, 0], [0.5, 0.0], atol=1e-6)  # its end


def test_rows_of_different_robots_end_in_zeros() -> None:
    scenario = arena(2)
    mixed = scenario.model_copy(
        update={
            "models": {
                **scenario.models,
                "n": scenario.models["m"].model_copy(
                    update={"drive": DriveSpec.of(DifferentialDrive(speed=1.0, turn_rate=1.0))}
                ),
            },
            "robots": (scenario.robots[0], scenario.robots[1].model_copy(update={"model": "n"})),
        }
    )
    simulator = Simulator(mixed, observation=Observation(neighbors=1, lidar=False))
    assert simulator.action_sizes == (3, 2)
    assert simulator.observation_sizes == (4 + 3 + 7, 4 + 2 + 7)
    assert (simulator.reset()[0, 1, 13:] == 0).all()


# Rewards


def test_rewards_are_sums_of_terms() -> None:
    weights = {"progress": 2.0, "arrival": 7.0, "collision": -3.0, "time": -0.5, "effort": -1.0}
    simulator = Simulator(arena(2), observation=QUIET, reward=Reward(weights), autoreset=False)
    simulator.reset()
    simulator.place(0, 0, [-4.0, 0.0, 0.0], [-3.5, 0.0, 0.0])
    action = still(simulator)
    action[0, 0] = 1.0, 0.0, 0.5
    before = simulator.remaining.copy()
    step = simulator.step(action)
    expected = 2.0 * (before - simulator.remaining) - 0.5
    expected[0, 0] -= (1.0 + 0.25) / 3
    np.testing.assert_allclose(step.rewards, expected)
    step = step_until_arrival(simulator)
    assert step.rewards[0, 0] > 6.0
    assert simulator.step(simulator.toward(simulator.goals)).rewards[0, 0] == 0.0


@pytest.mark.parametrize(("goal", "reward"), [((-2.0, 5.0), -5.0), ((-4.0, 0.75), -1.0)])
def test_bodies_that_are_no_robots_may_cost_more(goal: tuple[float, float], reward: float) -> None:
    scenario = arena(2, bodies=[{"position": (-2.0, 5.0, 0.0)}])  # the wall's y: 3 to 7 m
    weights = Reward({"collision": -1.0, "obstacle": -4.0})
    simulator = Simulator(scenario, observation=QUIET, reward=weights, autoreset=False)
    simulator.reset()
    simulator.place(0, 0, [-5.0, goal[1], 0.0], [*goal, 0.0])
    action = still(simulator)
    action[0, 0, 0] = 1.0  # along x, into the wall or the other robot
    step = step_until(simulator, action, lambda: simulator.hits[0, 0] >= 0)
    assert (simulator.hit_robots[0, 0] >= 0) == (reward == -1.0)
    assert step.rewards.tolist() == [[reward, 0.0]]


def test_own_terms_see_the_batch_before_worlds_reset() -> None:
    seen: list[Ints] = []

    def crowding(simulator: Simulator) -> Floats:
        seen.append(simulator.steps.copy())
        return -simulator.remaining

    reward = Reward({}, own=((crowding, 0.1),))
    simulator = Simulator(arena(2, horizon=0.3), 2, observation=QUIET, reward=reward)
    simulator.reset()
    for _ in range(4):
        step = simulator.step(still(simulator))
    np.testing.assert_allclose(step.rewards, -0.8)
    np.testing.assert_array_equal(np.array(seen)[:, 0], [1, 2, 3, 1])
    bad = Reward({}, own=((lambda s: np.zeros(3), 1.0),))
    simulator = Simulator(arena(2), observation=QUIET, reward=bad)
    simulator.reset()
    with pytest.raises(ValueError, match=r"<lambda>: got shape \(3,\), expected \(1, 2\)"):
        simulator.step(still(simulator))


def test_closeness_and_clearance() -> None:
    scenario = arena(1, bodies=[{"position": (0.0, 0.0, 0.0)}])
    reward = Reward({"closeness": -1.0}, near=10.0)
    simulator = Simulator(scenario, observation=QUIET, reward=reward)
    simulator.reset()
    step = simulator.step(still(simulator))
    world = simulator.world()
    expected = world.clearance("r0", simulator.configurations[0, 0]).distance
    assert simulator.clearances[0, 0] == expected
    np.testing.assert_allclose(step.rewards, -(1 - expected / 10.0))


# Waypoints


def test_robots_drive_to_waypoints_which_set_masks() -> None:
    scenario = arena(2, bodies=[{"position": (0.0, 0.0, 0.0)}])
    simulator = Simulator(scenario, observation=QUIET, actions="way_points", way_point_seconds=2.0)
    simulator.reset()
    action = still(simulator)
    action[0, 0] = 0.5, 0.0, 0.0  # one meter ahead
    simulator.step(action)
    np.testing.assert_allclose(simulator.configurations[0, 0], [-3.9, -0.75, 0.0], atol=1e-12)
    assert simulator.action_sizes == (3, 3)
    assert simulator.masked.tolist() == [[0, 0]]


@pytest.mark.parametrize("name", ["swap", "intersection", "forest", "cell"])
def test_waypoints_work_with_every_drive(name: str) -> None:
    simulator = Simulator(name, 2, actions="way_points", observation=Observation(path_hint=True))
    simulator.reset(seed=0)
    rng = np.random.default_rng(0)
    for _ in range(20):
        rows = simulator.step(simulator.sample(rng)).observations
        assert np.isfinite(rows).all()
    for k in range(2):
        assert len(simulator.world(k).contact_pairs()) == 0


# Episodes


def test_random_starts_are_free_and_depend_on_seed_and_episode() -> None:
    simulator = Simulator("random", 4, starts="random", observation=QUIET)
    simulator.reset(seed=10)
    first = simulator.configurations.copy()
    for k in range(4):
        assert len(simulator.world(k).contact_pairs()) == 0
    simulator.reset()
    assert (simulator.configurations != first).any(axis=2).all()
    simulator.reset(seed=10)
    np.testing.assert_array_equal(simulator.configurations, first)
    one = Simulator("random", 1, starts="random", observation=QUIET)
    one.reset(seed=12)
    np.testing.assert_array_equal(one.configurations[0], first[2])


def test_a_frozen_set_gives_the_episodes() -> None:
    cases = frozen("random", cases=5, n=3)
    simulator = Simulator(cases, 6, observation=QUIET)
    simulator.reset(seed=0)
    seen: set[int] = set()
    for _ in range(4):
        for k in range(6):
            starts = simulator.configurations[k]
            (case,) = [i for i, s in enumerate(cases) if np.allclose(s.robots[0].start, starts[0])]
            seen.add(case)
            expected = cases[case].world()
            world = simulator.world(k)
            assert world.names == expected.names
            np.testing.assert_allclose(
                world.poses(world.ids), expected.poses(expected.ids), atol=1e-12
            )
        simulator.reset()
    assert len(seen) > 2


def test_copies_continue_identically() -> None:
    simulator = Simulator("warehouse", 2, n=8, starts="random", cases=None)
    simulator.reset(seed=4)
    rng = np.random.default_rng(0)
    for _ in range(7):
        simulator.step(simulator.sample(rng))
    others = [copy.deepcopy(simulator), pickle.loads(pickle.dumps(simulator))]
    for _ in range(20):
        action = simulator.sample(rng)
        expected = simulator.step(action)
        for other in others:
            for a, b in zip(expected, other.step(action), strict=True):
                np.testing.assert_array_equal(a, b)
    state = simulator.state()
    after = simulator.step(action)
    simulator.set_state(state)
    np.testing.assert_array_equal(simulator.step(action).observations, after.observations)


@given(st.binary(max_size=60), st.integers(0, 10_000))
@settings(max_examples=60, deadline=None)
def test_a_damaged_state_is_an_error(junk: bytes, at: int) -> None:
    simulator = Simulator(arena(2), observation=QUIET)
    simulator.reset()
    state = simulator.state()
    for bad in (junk, state[: at % len(state)], state + b"x"):
        with pytest.raises(ValueError, match="state: damaged, or of another simulator"):
            simulator.set_state(bad)
    simulator.reset()
    simulator.step(still(simulator))


# Invalid arguments

UNBOUNDED = arena(2).replace(workspace=None)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Simulator("swop"), "swop: is no built-in scenario"),
        (lambda: Simulator("swap", color=3), "color"),
        (lambda: Simulator("swap", 0), "worlds: got 0, expected an integer from 1 to"),
        (lambda: Simulator("swap", actions="jump"), "actions: got 'jump', expected drive or way"),
        (lambda: Simulator("swap", starts="any"), "starts: got 'any', expected scenario or random"),
        (lambda: Simulator(3), "scenario: got int, expected a name"),  # type: ignore[arg-type]
        (lambda: Simulator(arena(2), n=3), "overrides: got n, expected with the name"),
        (lambda: Simulator(arena(2).replace(robots=())), "got 'arena' without robots"),
        (lambda: Simulator(UNBOUNDED, starts="random"), "give the scenario a workspace"),
        (lambda: Reward({"glory": 1.0}), "got 'glory'; expected one of: progress"),
        (lambda: Reward({"time": np.nan}), "time: got nan, expected a finite number"),
        (lambda: Observation(neighbors=-1), "neighbors: got -1, expected 0 to 1000"),
        (lambda: Observation(neighbor_range=0.0), "neighbor_range: got 0.0, expected over 0"),
        (lambda: Observation(rays=0), "rays: got 0, expected 1 to 100000"),
    ],
)  # fmt: skip
def test_invalid_arguments_are_errors(make: Callable[[], object], message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=message):
        make()


def test_invalid_actions_are_errors_and_change_nothing() -> None:
    simulator = Simulator(arena(2), 2, observation=QUIET)
    with pytest.raises(RuntimeError, match="before the first reset"):
        simulator.step(np.zeros((2, 2, 3)))
    simulator.reset()
    simulator.step(np.full((2, 2, 3), 0.5))
    state = simulator.state()
    bad = np.zeros((2, 2, 3))
    bad[1, 0, 2] = np.nan
    with pytest.raises(
        ValueError, match=r"actions\[1, 0, 2\]: got nan, expected a number in \[-1, 1\]"
    ):
        simulator.step(bad)
    with pytest.raises(ValueError, match=r"actions: got shape \(2, 2\), expected .*\(2, 2, 3\)"):
        simulator.step(np.zeros((2, 2)))
    with pytest.raises(ValueError, match=r"world: got 2, expected 0 to 1"):
        simulator.set_path(2, 0, [[0.0, 0.0, 0.0]])
    with pytest.raises(ValueError, match=r"robot: got 5, expected 0 to 1"):
        simulator.place(0, 5, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0])
    with pytest.raises(ValueError, match="seed"):
        simulator.reset(seed=-1)
    assert simulator.state() == state
    far = simulator.step(np.full((2, 2, 3), 7.0))  # clipped
    simulator.set_state(state)
    np.testing.assert_array_equal(simulator.step(np.ones((2, 2, 3))).observations, far.observations)

"""Plans: timed within limits, certified as they are executed, and verified from their files."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
import trimesh

import fgenv
from fgenv.collision import Shape
from fgenv.planners import (
    Certificate,
    Plan,
    PlanError,
    PlanningError,
    Problem,
    certify,
    plan_composite,
    verify,
)
from fgenv.planners.limits import broken_limits
from fgenv.planners.methods import corners
from fgenv.planners.timing import steps_of, steps_together
from fgenv.robots import (
    Car,
    DifferentialDrive,
    Drone,
    Holonomic,
    Joint,
    JointVelocity,
    Link,
    LinkShape,
    MobileManipulator,
    Robot,
)
from fgenv.robots.drives.base import DrivePart
from fgenv.scenarios import Scenario
from fgenv.scenarios.drive_specs import DriveSpec

DT = 0.1
DRIVES: dict[str, DrivePart] = {
    "holonomic": Holonomic(speed=1.0, turn_rate=2.0),
    "slow to start": Holonomic(speed=1.0, turn_rate=2.0, acceleration=0.7, turn_acceleration=1.0),
    "differential": DifferentialDrive(speed=1.0, turn_rate=1.5, acceleration=1.0),
    "backing slowly": DifferentialDrive(speed=1.0, turn_rate=1.5, reverse=0.3),
    "car": Car(wheelbase=0.5, min_turning_radius=1.0, speed=1.2),
    "slow car": Car(wheelbase=0.5, min_turning_radius=1.0, speed=1.2, acceleration=0.8),
    "drone": Drone(speed=2.0, turn_rate=1.0, climb=0.5, acceleration=2.0),
}


def robot_with(drive: DrivePart) -> Robot:
    mesh = trimesh.creation.box((0.4, 0.4, 0.4))
    cube = Shape(mesh.vertices, mesh.faces)
    return Robot.from_mesh(cube, drive.base or "planar", drive=drive, name="r")


def path_for(robot: Robot, rng: np.random.Generator) -> np.ndarray:
    """Waypoints that the drive can go along, one after the other."""
    n = 5
    if robot.base == "free":
        half = 0.5 * rng.uniform(-np.pi, np.pi, n)
        flat = np.zeros(n)
        turn = np.stack([flat, flat, np.sin(half), np.cos(half)], axis=1)
        q = np.concatenate([rng.uniform(-2, 2, (n, 3)), turn], axis=1)
    else:
        q = rng.uniform([-2, -2, -np.pi], [2, 2, np.pi], (n, 3))
    rows = [robot.steer(a, b)[1:] for a, b in itertools.pairwise(q)]
    return np.concatenate([q[:1], *rows])


# Timing


@pytest.mark.parametrize("name", DRIVES)
def test_timed_paths_keep_the_limits_and_pass_the_waypoints(name: str) -> None:
    robot = robot_with(DRIVES[name])
    for seed in range(5):
        path = path_for(robot, np.random.default_rng(seed))
        q = steps_of(robot, path, DT)
        assert robot.displacement_bound(q[0], path[0]) < 1e-9
        assert robot.displacement_bound(q[-1], path[-1]) < 1e-9
        assert broken_limits(robot, q, DT) is None
        if "car" not in name:  # passes its chords' corners between steps
            fine = robot.interpolate(q[:-1, None], q[1:, None], np.linspace(0, 1, 20)).reshape(
                -1, robot.nq
            )
            gaps = [float(np.min(robot.displacement_bound(fine, corner))) for corner in path]
            assert max(gaps) < 5e-3


def test_without_acceleration_limits_the_duration_is_length_over_speed() -> None:
    robot = robot_with(DRIVES["holonomic"])
    q = steps_of(robot, np.array([[0.0, 0, 0], [0.95, 0, 0]]), DT)
    assert len(q) == 11
    assert np.allclose(np.diff(q[:, 0]), 0.095)
    assert len(steps_of(robot, np.array([[1.0, 2.0, 0.5]]), DT)) == 1


def test_robots_that_are_timed_together_reach_waypoints_together() -> None:
    robots = [robot_with(DRIVES["holonomic"]), robot_with(DRIVES["slow to start"])]
    paths = [
        np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]]),
        np.array([[5.0, 0, 0], [5, 2, 0], [6, 2, 0]]),
    ]
    timed = steps_together(robots, paths, DT)
    assert len(timed[0]) == len(timed[1])
    at = [
        int(np.argmin(r.displacement_bound(q, p[1])))
        for r, q, p in zip(robots, timed, paths, strict=True)
    ]
    assert at[0] == at[1]
    for robot, q in zip(robots, timed, strict=True):
        assert broken_limits(robot, q, DT) is None


def test_an_arm_on_a_car_keeps_all_limits() -> None:
    mesh = trimesh.creation.box((0.2, 0.2, 0.2))
    part = LinkShape(Shape(mesh.vertices, mesh.faces))
    joint = Joint(
        "j1", "revolute", "body", "arm", lower=-2, upper=2, velocity=1.0, acceleration=2.0
    )
    car = Car(wheelbase=0.5, min_turning_radius=1.0, speed=1.2, acceleration=1.0)
    robot = Robot(
        "r",
        [Link("body", part), Link("arm", part)],
        [joint],
        "planar",
        drive=MobileManipulator(car),
    )
    rng = np.random.default_rng(3)
    for _ in range(5):
        q = rng.uniform([-2, -2, -np.pi, -2], [2, 2, np.pi, 2], (4, 4))
        path = np.concatenate([q[:1], *[robot.steer(a, b)[1:] for a, b in itertools.pairwise(q)]])
        assert broken_limits(robot, steps_of(robot, path, DT), DT) is None


def test_motions_that_a_drive_cannot_make_are_reported() -> None:
    robot = robot_with(DRIVES["differential"])
    sideways = np.array([[0.0, 0, 0], [0, 0.05, 0]])
    assert broken_limits(robot, sideways, DT) == "goes where its drive cannot at step 0"
    car = robot_with(DRIVES["car"])
    on_the_spot = np.array([[0.0, 0, 0], [0, 0, 0.1]])
    assert broken_limits(car, on_the_spot, DT) == "goes where its drive cannot at step 0"
    drone = robot_with(DRIVES["drone"])
    tilted = np.array([[0, 0, 0, 0, 0, 0, 1.0], [0, 0, 0, 0.1, 0, 0, np.sqrt(0.99)]])
    assert broken_limits(drone, tilted, DT) == "goes where its drive cannot at step 0"
    with pytest.raises(PlanningError, match="got a tilted start or goal"):
        steps_of(drone, tilted, DT)
    rushing = np.array([[0.0, 0, 0], [0.005, 0, 0], [0.02, 0, 0], [0.045, 0, 0], [0.08, 0, 0]])
    assert broken_limits(robot, rushing, DT) == "changes v faster than it can at step 4"
    arm = JointVelocity(speed=1.0)
    built = Scenario.load("cell", n=1).build().robots[0]
    driven = built.replace(base="planar", drive=arm)
    way = np.stack([driven.rest, driven.rest])
    way[1, 0] = 1.0
    with pytest.raises(PlanningError, match="coordinates that the drive does not move"):
        steps_of(driven, way, DT)


def test_excess_speed_and_acceleration_are_reported() -> None:
    robot = robot_with(DRIVES["slow to start"])
    q = np.array([[0.0, 0, 0], [0.2, 0, 0], [0.2, 0, 0]])
    assert broken_limits(robot, q, DT) == "needs vx of 2 m/s at step 0"
    jerky = np.array([[0.0, 0, 0], [0.09, 0, 0], [0.09, 0, 0]])
    assert broken_limits(robot, jerky, DT) == "changes vx faster than it can at step 0"


@pytest.mark.parametrize("name", ["holonomic", "differential", "car", "drone"])
def test_actions_between_lead_there(name: str) -> None:
    """Against the simulator: driven by them, robots get to where the path says."""
    from fgenv.envs import Simulator

    scenario = {
        "holonomic": "random",
        "differential": "doorway",
        "car": "intersection",
        "drone": "forest",
    }
    made = Scenario.load(scenario[name], n=1)
    if name == "holonomic":
        drive = DriveSpec.of(Holonomic(speed=1.0, turn_rate=2.0))
        models = {k: m.model_copy(update={"drive": drive}) for k, m in made.models.items()}
        made = made.replace(models=models)
    simulator = Simulator(made, autoreset=False, tolerance=1e-6)
    simulator.reset(seed=0)
    robot = simulator.robots[0]
    rng = np.random.default_rng(1)
    low = np.array([a.low for a in robot.actions])
    high = np.array([a.high for a in robot.actions])
    for _ in range(20):
        before = simulator.configurations[0, 0, : robot.nq].copy()
        simulator.step(rng.uniform(-0.4, 0.4, (1, 1, simulator.action_size)))
        after = simulator.configurations[0, 0, : robot.nq].copy()
        if (simulator.hits >= 0).any():
            break
        found = robot.required_drive.inverse(robot, before, after, simulator.dt)[0]
        assert ((found > low - 1e-9) & (found < high + 1e-9)).all()
        driven = simulator.velocities[0, 0, : len(found)]
        assert np.allclose(found, driven, atol=1e-6)


# Plans


@pytest.mark.parametrize(
    ("name", "n", "method"),
    [
        ("swap", 4, "composite"),
        ("swap", 4, "prioritized"),
        ("doorway", 3, "conflict_based"),
        ("forest", 3, "prioritized"),
        ("intersection", 2, "prioritized"),
        ("cell", 2, "composite"),
    ],
)
def test_plans_are_free_at_sampled_times(name: str, n: int, method: str) -> None:
    """Oracle: contacts of a separate world, every 0.05 s."""
    plan = fgenv.plan(name, n=n, seed=1, method=method, time_limit=30.0)
    assert plan.certificate
    problem = Problem.from_scenario(plan.scenario)
    world = problem.world.copy()
    for time in np.arange(0.0, plan.makespan, 0.05):
        for robot, q in zip(problem.robot_ids, plan.at(time), strict=True):
            world.set_configuration(robot, q)
        assert len(world.contact_pairs()) == 0
    for i, q in enumerate(plan.configurations):
        assert problem.models[i].displacement_bound(q[0], problem.starts[i]) < 1e-9
        assert problem.models[i].displacement_bound(q[-1], problem.goals[i]) < 1e-9
        assert broken_limits(problem.models[i], q, problem.dt) is None
    assert plan.makespan == max(plan.arrivals)
    assert plan.sum_of_costs == pytest.approx(sum(plan.arrivals))
    assert len(plan.times) == plan.steps + 1


def test_the_same_seed_gives_the_same_plan() -> None:
    plans = [fgenv.plan("swap", n=3, body="long", seed=s, method="composite") for s in (2, 2, 3)]
    same, other = plans[0].configurations, plans[2].configurations
    assert all(np.array_equal(a, b) for a, b in zip(same, plans[1].configurations, strict=True))
    assert any(a.shape != b.shape or (a != b).any() for a, b in zip(same, other, strict=True))


def test_plans_keep_the_margin_and_the_certified_clearance_is_a_bound() -> None:
    plan = fgenv.plan("random", n=3, seed=4, margin=0.05, method="composite")
    proof = plan.certificate
    assert proof.margin == 0.05
    assert proof.clearance > 0.05
    problem = Problem.from_scenario(plan.scenario)
    world = problem.world.copy()
    gaps = []
    for row in range(plan.steps + 1):
        for i, q in enumerate(plan.configurations):
            world.set_configuration(problem.robot_ids[i], q[row])
        gaps += [
            float(world.clearance(r, q[row]).distance)
            for r, q in zip(problem.robot_ids, plan.configurations, strict=True)
        ]
    assert proof.clearance <= min(gaps)
    assert proof.clearance > min(gaps) - 5e-3
    assert proof.nearest is not None
    assert proof.nearest[1] in problem.names


def test_a_larger_margin_fails_where_robots_come_near() -> None:
    plan = fgenv.plan("doorway", n=2, method="composite")
    problem = Problem.from_scenario(plan.scenario)
    wide = certify(problem, plan.configurations, margin=plan.certificate.clearance + 0.01)
    assert not wide
    assert wide.failed_step is not None
    assert wide.clearance == 0.0


@pytest.mark.parametrize("objective", ["length", "clearance", "time"])
def test_objectives_that_deadlock_prm_are_rejected(objective: str) -> None:
    """Its second thread would compute costs in Python while the search holds the GIL."""
    if objective != "length":
        with pytest.raises(ValueError, match=f"objective: '{objective}' deadlocks PRM, "):
            fgenv.plan("doorway", "PRM", n=1, objective=objective)


@pytest.mark.parametrize("objective", ["length", "clearance", "time"])
def test_objectives(objective: str) -> None:
    plan = fgenv.plan(
        "random", "RRTstar", 1.0, 1, n=1, objective=objective, simplify=objective != "clearance"
    )
    assert plan.certificate


def test_corners_of_steps_are_the_waypoints() -> None:
    robot = robot_with(DRIVES["holonomic"])
    path = np.array([[0.0, 0, 0], [1, 0, 0], [1, 2, 0.5]])
    assert np.allclose(corners(steps_of(robot, path, DT)), path)


@pytest.mark.parametrize("planner", ["RRTConnect", "PRM"])
def test_the_planners_graph_is_returned_on_request(planner: str) -> None:
    problem = Problem.from_scenario("random", n=1, seed=1)
    route = plan_composite(problem, planner=planner, time_limit=0.5, graph=True)
    assert route.graph is not None
    assert route.graph.states.shape == (route.facts["vertices"], 3)
    assert route.graph.edges.shape == (route.facts["edges"], 2)
    assert route.facts["pairs_checked"] > 0
    starts, ends = (route.graph.states[route.graph.edges[:, k]] for k in (0, 1))
    checker = problem.world
    paths = [problem.models[0].steer(a, b) for a, b in zip(starts[:50], ends[:50], strict=True)]
    assert all(checker.check_motion(problem.robot_ids[0], p[:-1], p[1:]) for p in paths)


def test_robots_that_vanish_may_share_a_goal() -> None:
    scenario = Scenario.load("swap", n=2)
    robots = [r.model_copy(update={"goal": (0.0, 0.0, 0.0)}) for r in scenario.robots]
    shared = scenario.replace(robots=robots, at_goal="vanish")
    plan = fgenv.plan(shared, method="prioritized")
    assert plan.certificate
    assert verify(plan)
    assert plan.arrivals[0] != plan.arrivals[1]
    assert Problem.from_scenario(scenario).kinds == (0, 0)
    apart = scenario.replace(allowed=(("robot 1", "static"),))
    assert Problem.from_scenario(apart).kinds == (0, 1)


def test_a_robot_that_is_at_its_goal_vanishes_after_a_step() -> None:
    scenario = Scenario.load("swap", n=2)
    first, second = scenario.robots
    here = second.model_copy(update={"goal": second.start})
    near = tuple(np.array(second.start) - [0.65 * np.cos(second.start[2]), 0, 0])
    there = first.model_copy(update={"start": tuple(map(float, near))})
    made = scenario.replace(robots=[there, here], at_goal="vanish")
    problem = Problem.from_scenario(made)
    still = np.repeat(problem.starts[1][None], 2, axis=0)
    through = np.stack([problem.starts[0], problem.starts[1]])
    assert not certify(problem, [through, still])
    plan = fgenv.plan(made, method="prioritized")
    assert plan.certificate


def test_certify_needs_the_paths_of_all_robots() -> None:
    plan = fgenv.plan("doorway", n=2, method="composite")
    problem = Problem.from_scenario(plan.scenario)
    for wrong in (
        [],
        plan.configurations[:1],
        [plan.configurations[0], plan.configurations[1][:-1]],
    ):
        with pytest.raises(
            ValueError, match=r"configurations: got shapes .*, expected \(steps \+ 1, nq\)"
        ):
            certify(problem, wrong)
    with pytest.raises(ValueError, match="a Problem has its own"):
        fgenv.plan(problem, margin=0.2)


# Failures


def test_errors_name_the_cause() -> None:
    scenario = Scenario.load("swap", n=2)
    crowded = scenario.replace(
        robots=[r.model_copy(update={"goal": scenario.robots[0].goal}) for r in scenario.robots]
    )
    with pytest.raises(PlanningError, match="goal of 'robot 1': collides with robot 2"):
        fgenv.plan(crowded)
    vanishing = crowded.replace(at_goal="vanish")
    Problem.from_scenario(vanishing).check()
    with pytest.raises(ValueError, match="method: got 'magic', which is unknown"):
        fgenv.plan("swap", method="magic")
    with pytest.raises(ValueError, match=r"planner: got 'RTT', which is unknown; .*RRT"):
        fgenv.plan("doorway", "RTT", n=1)
    with pytest.raises(ValueError, match="time_limit: got 0"):
        fgenv.plan("doorway", n=1, time_limit=0)
    with pytest.raises(ValueError, match="objective: got 'beauty'; expected one of: length"):
        fgenv.plan("doorway", n=1, objective="beauty")
    with pytest.raises(ValueError, match="margin: got -1"):
        fgenv.plan("doorway", n=1, margin=-1)
    with pytest.raises(PlanningError, match=r"no path for robot 1, .* within .* allow more time"):
        fgenv.plan("swap", n=20, method="composite", time_limit=0.2)


# Files


@pytest.fixture(scope="module")
def plan() -> Plan:
    return fgenv.plan("doorway", n=2, seed=3, method="composite")


def test_a_plan_file_is_loaded_and_verified(plan: Plan, tmp_path: Path) -> None:
    file = tmp_path / "plan.npz"
    plan.save(file)
    again = Plan.load(file)
    assert again.certificate == plan.certificate
    assert again.facts == plan.facts
    for a, b in zip(again.configurations, plan.configurations, strict=True):
        assert np.array_equal(a, b)
    proof = verify(file)
    assert isinstance(proof, Certificate)
    assert proof == plan.certificate


def test_modified_plan_files_are_rejected(plan: Plan, tmp_path: Path) -> None:
    file = tmp_path / "plan.npz"
    plan.save(file)
    arrays = dict(np.load(file))
    arrays["configurations_0"] = arrays["configurations_0"] + 0.01
    np.savez_compressed(file, **arrays)
    with pytest.raises(PlanError, match="is damaged, or no plan; plan again"):
        Plan.load(file)
    file.write_bytes(b"nothing")
    with pytest.raises(PlanError, match="is damaged"):
        verify(file)
    with pytest.raises(FileNotFoundError):
        verify(tmp_path / "none.npz")
    with pytest.raises(ValueError, match=r"expected a name that ends in \.npz"):
        plan.save(tmp_path / "plan.json")


def test_verify_rejects_plans_beyond_limits_and_goals(plan: Plan) -> None:
    from dataclasses import replace

    q = [a.copy() for a in plan.configurations]
    fast = replace(
        plan,
        configurations=tuple(a[::2] if len(a) % 2 else a[[0, *range(1, len(a), 2)]] for a in q),
    )
    with pytest.raises(
        PlanError, match=r"needs (v|yaw_rate) of .* at step|goes where its drive cannot"
    ):
        verify(fast)
    away = [a.copy() for a in q]
    away[0] = away[0][:-5]
    away[1] = away[1][:-5]
    with pytest.raises(PlanError, match="does not end at its goal"):
        verify(replace(plan, configurations=tuple(away)))
    assert not verify(plan, margin=1.0)

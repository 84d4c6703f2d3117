"""The OMPL plug-in: its checks agree with the world's, under every planner."""

from __future__ import annotations

import gc
import resource
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable

import numpy as np
import pytest
import trimesh
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape, World
from fgenv.planners import (
    PLANNERS,
    MotionValidator,
    PlanningError,
    Problem,
    StateLayout,
    StateValidityChecker,
    plan_composite,
    setup,
    state_space,
)
from fgenv.planners.checker import joint_checker
from fgenv.planners.ompl.spaces import joint_space, subspaces
from fgenv.planners.ompl.states import StateBuffer, capsule, coordinate_serializer
from fgenv.robots import Car, DifferentialDrive, Robot
from fgenv.scenarios import Scenario

ou.setLogLevel(ou.LOG_NONE)
AT: Callable[[list[float]], Floats] = trimesh.transformations.translation_matrix


def box(*size: float) -> Shape:
    mesh = trimesh.creation.box(size)
    return Shape(mesh.vertices, mesh.faces)


def cart(drive: object = None) -> Robot:
    area = [[-3.0, -3.0], [3.0, 3.0]]
    return Robot.from_mesh(box(0.6, 0.3, 0.4), drive=drive, name="cart", workspace=area)  # type: ignore[arg-type]


def gap_world(robot: Robot) -> World:
    """World with a robot and a wall with a gap, at x = 0."""
    world = World()
    for side in (-1, 1):
        world.add(box(0.2, 2.4, 1.0), AT([0, 1.7 * side, 0]), name=f"wall {side}")
    world.add_robot(robot, np.array([-1.5, 0.0, 0.0])[: robot.nq])
    return world


def space_of(robot: Robot) -> ob.StateSpace:
    return state_space(StateLayout(robot, robot.steering()))


def simple_setup(robot: Robot, world: World, **options: object) -> og.SimpleSetup:
    """SimpleSetup as a user writes it, from one side of the wall to the other."""
    ss = og.SimpleSetup(space_of(robot))
    si = ss.getSpaceInformation()
    ss.setStateValidityChecker(StateValidityChecker(si, robot.name, world))
    si.setMotionValidator(MotionValidator(si, robot.name, world, **options))  # type: ignore[arg-type]
    buffer = StateBuffer(si)
    ends = [buffer.write(si.allocState(), q) for q in ([-1.5, 1.0, 0.3], [1.5, 1.0, 2.0])]
    ss.setStartAndGoalStates(*ends)
    return ss


# Steering


@pytest.mark.parametrize("way", ["dubins", "reeds_shepp"])
def test_a_cars_path_has_the_length_of_ompls_and_reaches_the_goal(way: str) -> None:
    rng = np.random.default_rng(5)
    radius = 0.7
    space = (ob.DubinsStateSpace if way == "dubins" else ob.ReedsSheppStateSpace)(radius)
    limits = ob.RealVectorBounds(2)
    limits.setLow(-9)
    limits.setHigh(9)
    space.setBounds(limits)
    si = ob.SpaceInformation(space)
    buffer = StateBuffer(si)
    robot = cart(Car(wheelbase=0.5, min_turning_radius=radius, speed=1.0))
    for _ in range(300):
        q0, q1 = rng.uniform([-3, -3, -np.pi], [3, 3, np.pi], (2, 3))
        a, b = (buffer.write(si.allocState(), q) for q in (q0, q1))
        rows = _core.legs(
            robot._core, q0, q1, way=2 if way == "dubins" else 3, radius=radius, reverse=True
        )
        assert np.array_equal(rows[[0, -1]], [q0, q1])
        steps = np.diff(rows, axis=0)
        turns = np.abs(np.remainder(steps[:, 2] + np.pi, 2 * np.pi) - np.pi)
        chords = np.hypot(steps[:, 0], steps[:, 1])
        arcs = np.where(turns > 1e-9, radius * turns, chords)
        assert arcs.sum() == pytest.approx(space.distance(a, b), abs=1e-6)
        assert turns.max() < 0.1 + 1e-9
        # Each chord has the mean direction of its two headings, forwards or backwards.
        headings = rows[:-1, 2] + (np.remainder(steps[:, 2] + np.pi, 2 * np.pi) - np.pi) / 2
        along = np.cos(headings) * steps[:, 0] + np.sin(headings) * steps[:, 1]
        assert np.allclose(np.abs(along), chords, atol=1e-7)
        if way == "dubins":
            assert (along > -1e-7).all()


def test_turn_drive_turn_chooses_the_direction_with_less_turning() -> None:
    robot = cart(DifferentialDrive(speed=1.0, turn_rate=1.0))
    forwards = robot.steer([0, 0, 0.2], [2, 0, -0.2])
    assert np.allclose(forwards, [[0, 0, 0.2], [0.0, 0, 0], [2.0, 0, 0], [2, 0, -0.2]])
    back = robot.steer([0, 0, 3.0], [2, 0, 3.0])
    assert np.allclose(np.abs(back[1:3, 2]), np.pi)
    assert len(robot.steer([0, 0, 0], [0, 0, 1])) == 2


# Spaces and states


def test_states_of_every_space_are_read_and_written() -> None:
    arms = Scenario.load("cell", n=2).build().robots
    drone = Scenario.load("forest", n=1).build().robots[0]
    car = Scenario.load("intersection", n=1).build().robots[0]
    free = Robot.from_mesh(box(1, 1, 1), "free", workspace=[[-1] * 3, [1] * 3])
    spaces = [space_of(robot) for robot in (cart(), arms[0], drone, car, free)]
    spaces.append(joint_space([space_of(robot) for robot in (cart(), free)]))
    rng = np.random.default_rng(0)
    for space in spaces:
        si = ob.SpaceInformation(space)
        buffer, state = StateBuffer(si), si.allocState()
        values = rng.uniform(-0.9, 0.9, buffer.size)
        buffer.write(state, values)
        slow = np.full(buffer.size, np.nan)
        coordinate_serializer(space)(capsule(slow), state)
        assert np.array_equal(buffer.read(state), values)
        assert np.array_equal(slow, values)


def test_drones_are_level_and_the_joint_space_of_arms_is_one_real_vector_space() -> None:
    drone = Scenario.load("forest", n=1).build().robots[0]
    layout = StateLayout(drone, drone.steering())
    assert subspaces(state_space(layout)) == [("RealVector", 3), ("SO2", 1)]
    q = np.array([1.0, 2.0, 3.0, 0.0, 0.0, np.sin(0.4), np.cos(0.4)])
    assert np.allclose(layout.configurations(layout.states(q)), q)
    assert subspaces(setup(Scenario.load("cell", n=2)).getStateSpace()) == [("RealVector", 12)]


def test_a_space_that_does_not_fit_is_an_error() -> None:
    robot = cart()
    world = gap_world(robot)
    si = ob.SpaceInformation(ob.SE3StateSpace())
    with pytest.raises(ValueError, match=r"si: got a space of SE3, expected SE2; .*state_space"):
        StateValidityChecker(si, "cart", world)
    si = ob.SpaceInformation(ob.SE2StateSpace())
    with pytest.raises(ValueError, match="got 'truck', expected the name of a body"):
        MotionValidator(si, "truck", world)
    with pytest.raises(ValueError, match="resolution: got 0"):
        MotionValidator(si, "cart", world, resolution=0.0)


# Checks


def test_checks_agree_with_the_world() -> None:
    robot = cart()
    world = gap_world(robot)
    ss = simple_setup(robot, world)
    si = ss.getSpaceInformation()
    buffer = StateBuffer(si)
    rng = np.random.default_rng(1)
    q = rng.uniform([-2, -2, -np.pi], [2, 2, np.pi], (400, 2, 3))
    a, b = si.allocState(), si.allocState()
    free = ~world.collides("cart", q)
    assert 100 < free.sum() < 700
    for ends, ok in zip(q, free, strict=True):
        buffer.write(a, ends[0])
        buffer.write(b, ends[1])
        assert [si.isValid(a), si.isValid(b)] == ok.tolist()
        if ok[0]:
            assert si.checkMotion(a, b) == bool(world.check_motion("cart", *ends))
    gap = world.clearance("cart", q[0, 0]).distance
    assert StateValidityChecker(si, "cart", world).clearance(buffer.write(a, q[0, 0])) == gap


def test_a_body_without_a_robot_model_has_se2_or_se3_states() -> None:
    world = World()
    body = world.add(box(0.5, 0.5, 0.5), AT([0, 0, 2.0]), name="mover")
    world.add(box(1, 1, 1), AT([2, 0, 2.0]))
    assert not joint_checker(world, [body], [7]).valid([2.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0])
    assert not joint_checker(world, [body], [3]).valid([2.0, 0.0, 0.0])
    assert joint_checker(world, [body], [3]).valid([0.0, 0.0, 0.0])


def test_joint_checks_agree_with_the_world() -> None:
    scenario = Scenario.load("random", n=3, seed=2)
    problem = Problem.from_scenario(scenario)
    checker = joint_checker(problem.world, problem.robot_ids, [3] * 3)
    rng = np.random.default_rng(3)
    box_ = problem.models[0].workspace
    assert box_ is not None
    seen = set()
    for _ in range(400):
        q = np.stack([m.random(rng) for m in problem.models])
        to = q + rng.uniform(-1, 1, q.shape)
        if checker.valid(q.ravel()):
            found = problem.world.check_motions(list(problem.robot_ids), q, to)
            seen.add(free := bool(checker.free(q.ravel(), to.ravel())))
            assert free == bool(found)
    assert seen == {True, False}


def test_meet_agrees_with_check_motions() -> None:
    problem = Problem.from_scenario("random", n=2, seed=1)
    rng = np.random.default_rng(4)
    q = rng.uniform(-1, 1, (300, 4, 3))
    met = problem.world.motions_collide(
        problem.robot_ids[0], q[:, 0], q[:, 1], problem.robot_ids[1], q[:, 2], q[:, 3]
    )
    empty = World()
    ids = [empty.add_robot(m, name=n) for m, n in zip(problem.models, problem.names, strict=True)]
    assert 30 < met.sum() < 270
    for (a0, a1, b0, b1), hit in zip(q, met, strict=True):
        assert hit == (not empty.check_motions(ids, [a0, b0], [a1, b1]))
    with pytest.raises(ValueError, match="the same robot"):
        problem.world.motions_collide(
            problem.robot_ids[0], q[0, 0], q[0, 1], problem.robot_ids[0], q[0, 2], q[0, 3]
        )


def test_nonfinite_states_are_invalid() -> None:
    robot = cart()
    checker = joint_checker(gap_world(robot), ["cart"], [3])
    good = [-1.5, 0.0, 0.0]
    assert checker.valid(good)
    assert not checker.valid([np.nan, 0.0, 0.0])
    assert not checker.free(good, [np.inf, 0.0, 0.0])
    assert checker.clearance([np.nan, 0.0, 0.0]) == 0.0


def test_only_discrete_checks_miss_a_thin_wall() -> None:
    robot = cart()
    world = World()
    world.add(box(1e-3, 6.0, 1.0))
    world.add_robot(robot, [-1.5, 0, 0])
    for resolution, free in ((None, False), (3.0, True), (0.01, False)):
        checker = joint_checker(world, ["cart"], [3], resolution=resolution)
        assert checker.free([-1.5, 0, 0], [1.3, 0, 0]) == free


# Planners


@pytest.mark.parametrize("name", PLANNERS)
def test_every_planner_finds_a_certified_path(name: str) -> None:
    robot = cart()
    world = gap_world(robot)
    ss = simple_setup(robot, world)
    ss.setPlanner(getattr(og, name)(ss.getSpaceInformation()))
    ou.RNG.setSeed(7)
    ss.solve(ob.timedPlannerTerminationCondition(1.0))
    assert ss.haveExactSolutionPath()
    buffer = StateBuffer(ss.getSpaceInformation())
    path = ss.getSolutionPath()
    q = np.array([buffer.read(path.getState(k)) for k in range(path.getStateCount())])
    assert world.check_motion("cart", q[:-1], q[1:])
    assert np.allclose(q[[0, -1], :2], [[-1.5, 1.0], [1.5, 1.0]])


def test_a_free_straight_motion_is_returned_for_aorrtc() -> None:
    """AORRTC of OMPL 2.0.1 returns the goal twice; it is replaced by start and goal."""
    problem = Problem.from_scenario("swap", n=1)
    path = plan_composite(problem, planner="AORRTC", time_limit=0.2).paths[0]
    ends = [problem.starts[0][:2], problem.goals[0][:2]]
    assert np.allclose(path[[0, -1], :2], ends)


def test_a_planner_that_does_not_support_the_space_is_an_error() -> None:
    with pytest.raises(PlanningError, match=r"BITstar does not support .*use another planner"):
        plan_composite(Problem.from_scenario("swap", n=2), planner="BITstar", time_limit=0.2)


@pytest.mark.parametrize("name", ["RRTConnect", "PRM", "PRMstar", "BITstar"])
def test_exceptions_in_checks_are_raised_after_the_search(name: str) -> None:
    made = setup(Scenario.load("doorway", n=1))
    made.setPlanner(getattr(og, name)(made.getSpaceInformation()))
    made.world.remove("robot 1")
    with pytest.raises(ValueError, match="removed, replaced or attached"):
        made.solve(20.0)


def test_ctrl_c_stops_a_search() -> None:
    script = """
        import signal
        from ompl import geometric as og
        from fgenv.planners import setup
        signal.signal(signal.SIGINT, signal.default_int_handler)  # unset in background jobs
        made = setup("doorway", 0)
        made.setPlanner(og.{name}(made.getSpaceInformation()))
        print("begins", flush=True)
        try:
            made.solve(60.0)
        except KeyboardInterrupt:
            print("stopped")
    """
    for name in ("PRMstar", "RRTstar"):
        code = textwrap.dedent(script).format(name=name)
        with subprocess.Popen(
            [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True
        ) as run:
            assert run.stdout is not None
            while "begins" not in run.stdout.readline():
                pass
            time.sleep(0.3)
            run.send_signal(signal.SIGINT)
            assert "stopped" in run.communicate(timeout=20)[0]


def test_setup_names_colliding_robots() -> None:
    scenario = Scenario.load("swap", n=2)
    crowded = scenario.replace(
        robots=[r.model_copy(update={"start": scenario.robots[0].start}) for r in scenario.robots]
    )
    with pytest.raises(PlanningError, match="start of 'robot 1': collides with robot 2"):
        setup(crowded, "robot 1")
    with pytest.raises(ValueError, match="robot: got 'robot 9', expected one of robot 1, robot 2"):
        setup(scenario, "robot 9")


def run_checks(n: int) -> None:
    robot = cart()
    ss = simple_setup(robot, gap_world(robot))
    si = ss.getSpaceInformation()
    sampler, a, b = si.allocStateSampler(), si.allocState(), si.allocState()
    for _ in range(n):
        sampler.sampleUniform(a)
        sampler.sampleUniform(b)
        if si.isValid(a):
            si.checkMotion(a, b)


@pytest.mark.parametrize("n", [50_000, pytest.param(1_000_000, marks=pytest.mark.nightly)])
def test_checks_do_not_leak_memory(n: int) -> None:
    run_checks(2000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    run_checks(n)
    gc.collect()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 8_000  # kB


def test_a_setup_without_references_is_freed() -> None:
    import weakref

    made = setup(Scenario.load("doorway", n=1))
    made.setPlanner(og.RRTConnect(made.getSpaceInformation()))
    assert made.solve(2.0)
    gone = weakref.ref(made.motions)
    del made
    gc.collect()
    assert gone() is None


def test_a_cars_arcs_stay_in_the_workspace() -> None:
    robot = cart(Car(wheelbase=0.5, min_turning_radius=1.5, speed=1.0))
    world = World()
    world.add_robot(robot, [0, 0, 0])
    ss = og.SimpleSetup(space_of(robot))
    validator = MotionValidator(ss.getSpaceInformation(), "cart", world)
    sides = [-2.0, 2.9, 1.0], [2.0, 2.9, -1.0]  # the arc between them leaves the workspace
    rows = robot.steer(*sides)
    assert rows[:, 1].max() > 3.0
    assert not validator._core.free(*sides)
    assert validator._core.free([-2.0, 0.0, 1.0], [2.0, 0.0, -1.0])


def test_free_bodies_are_planned_with_rounded_quaternions() -> None:
    """Scenarios store six digits; OMPL rejects norms that differ from 1 by over 1e-9."""
    problem = Problem.from_scenario("cubicles")
    q = plan_composite(problem, time_limit=30.0).paths[0]
    assert len(q) > 2
    assert problem.world.check_motion(problem.robot_ids[0], q[:-1], q[1:])

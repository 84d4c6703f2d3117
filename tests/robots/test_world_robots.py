"""Robots in a world: queries by configurations, against the robots' kinematics."""

from __future__ import annotations

import itertools
import pickle
from collections.abc import Callable
from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.robots import random_tree, real

from fgenv.arrays import Floats
from fgenv.bench.common.solids import at, ball, box, somewhere
from fgenv.collision import Shape, World, collide, distance
from fgenv.robots import Joint, Link, LinkShape, Robot

SEEDS = st.integers(0, 2**32 - 1)
CUBE = Shape(*box(0.3))
PANDA = "panda_description/urdf/panda.urdf"

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]

UP = np.array([0.0, 0.0, 1.0])


def arm(links: int = 3, length: float = 0.5, name: str = "arm") -> Robot:
    """A planar chain of bars, each of which turns about the end of its predecessor."""
    bar = Shape(*box(length * 0.9, 0.05, 0.05))
    middle = at(length / 2)
    bodies = [Link(f"link{i}", [LinkShape(bar, middle)]) for i in range(links)]
    joints = [
        Joint(f"joint{i}", "revolute", f"link{i}", f"link{i + 1}", at(length), UP, -3.0, 3.0)
        for i in range(links - 1)
    ]
    return Robot(name, bodies, joints)


class Scene:
    """A robot among cubes, with its expected collisions by forward kinematics, pair by pair."""

    def __init__(self, rng: np.random.Generator, robot: Robot, reach: float, count: int = 6):
        self.robot, self.world = robot, World()
        self.id = self.world.add_robot(robot, name="robot")
        self.poses = np.stack([somewhere(rng, reach) for _ in range(count)])
        self.cubes = [self.world.add(CUBE, pose) for pose in self.poses]
        skipped = set(robot.allowed_parts)
        self.own = [
            pair
            for pair in itertools.combinations(range(len(robot.parts)), 2)
            if pair not in skipped and robot.parts[pair[0]].link != robot.parts[pair[1]].link
        ]

    def parts_at(self, q: Floats) -> list[Floats]:
        poses = self.robot.forward(q)
        return [poses[..., part.link, :, :] @ part.origin for part in self.robot.parts]

    def hit(self, q: Floats) -> Any:
        """Whether the robot collides at configurations (..., nq)."""
        placed = self.parts_at(q)
        out = np.zeros(q.shape[:-1], bool)
        shapes = [part.shape for part in self.robot.parts]
        for shape, T in zip(shapes, placed, strict=True):
            for pose in self.poses:
                out |= collide(shape, T, CUBE, pose)
        for i, j in self.own:
            out |= collide(shapes[i], placed[i], shapes[j], placed[j])
        return out


def with_shapes(rng: np.random.Generator) -> Robot:
    while not (robot := random_tree(rng)).parts:
        pass
    return robot


@given(SEEDS)
def test_collides_agrees_with_kinematics(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scene = Scene(rng, with_shapes(rng), 1.0)
    q = scene.robot.random(rng, 40)
    assert (scene.world.collides("robot", q) == scene.hit(q)).all()
    scene.world.set_configuration("robot", q[0])
    assert (scene.world.configuration("robot") == q[0]).all()
    ids = scene.world.parts("robot")
    np.testing.assert_allclose(scene.world.poses(ids), scene.parts_at(q[0]), atol=1e-12)
    met = {frozenset(pair) for pair in scene.world.contact_pairs().tolist()}
    mine = {pair for pair in met if pair & set(ids.tolist())}
    assert bool(mine) == scene.hit(q[0])


@given(SEEDS)
def test_clearance_is_the_distance_of_the_nearest_part(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scene = Scene(rng, with_shapes(rng), 1.5)
    for q in scene.robot.random(rng, 5):
        placed = scene.parts_at(q)
        expected = min(
            distance(part.shape, T, CUBE, pose)
            for part, T in zip(scene.robot.parts, placed, strict=True)
            for pose in scene.poses
        )
        found = scene.world.clearance("robot", q)
        assert found.distance == pytest.approx(expected, abs=1e-9)
        assert found.body in scene.cubes


@given(SEEDS)
def test_a_motion_is_that_of_the_whole_tree(seed: int) -> None:
    """A free motion is free at all samples; a contact is at its fraction, and not before."""
    rng = np.random.default_rng(seed)
    scene = Scene(rng, with_shapes(rng), 1.2)
    robot = scene.robot
    for q0, q1 in robot.random(rng, (6, 2)):
        found = scene.world.check_motion("robot", q0, q1)
        assert not found.unresolved
        t = np.linspace(0.0, 1.0, 60)
        hit = scene.world.collides("robot", robot.interpolate(q0, q1, t))
        assert not hit[t < found.free_until].any()
        if found.free:
            assert not hit.any()
            continue
        assert found.free_until <= found.contact_by
        assert scene.world.collides("robot", robot.interpolate(q0, q1, found.contact_by))
        assert found.part in scene.world.parts("robot")
        any_contact = scene.world.check_motion("robot", q0, q1, first_contact=False)
        assert not any_contact.free


def test_a_link_runs_into_the_robot_itself() -> None:
    """Four bars that roll up: the last collides with the first at the closed triangle."""
    robot = arm(4)
    world = World()
    world.add_robot(robot)
    straight, curled = np.zeros(3), np.full(3, 2.2)
    found = world.check_motion("arm", straight, curled)
    assert not found.free
    names = [world.names[world.ids.tolist().index(i)] for i in (found.part, found.other)]
    assert names == ["arm", "arm/link3"]
    before, after = robot.interpolate(
        straight, curled, np.array([found.free_until, found.contact_by])
    )
    assert not world.collides("arm", before)
    assert world.collides("arm", after)
    world.allow(*names)
    assert world.check_motion("arm", straight, curled).free or (
        world.check_motion("arm", straight, curled).free_until > found.free_until
    )


@pytest.mark.parametrize("base", ["planar", "free"])
def test_a_robot_of_one_body_is_that_body(base: str) -> None:
    rng = np.random.default_rng(1)
    room = np.array([[-1.0] * 3, [1.0] * 3])[:, : 2 if base == "planar" else 3]
    robot = Robot.from_mesh(CUBE, base, workspace=room, name="cart")
    tree, plain = World(), World()
    cart, cube = tree.add_robot(robot), plain.add(CUBE)
    for world in (tree, plain):
        for seed in range(8):
            world.add(Shape(*ball(0.2, 1)), somewhere(np.random.default_rng(seed), 0.8))
    q0, q1 = robot.random(rng, (2, 200))
    poses = [robot.forward(q, 0) for q in (q0, q1)]
    assert (tree.collides(cart, q0) == plain.collides(cube, poses[0])).all()
    one, other = tree.check_motion(cart, q0, q1), plain.check_motion(cube, *poses)
    assert (one.free == other.free).all()
    assert 20 < one.free.sum() < 180
    np.testing.assert_allclose(one.free_until, other.free_until, atol=1e-5)
    np.testing.assert_allclose(
        tree.clearance(cart, q0).distance, plain.clearance(cube, poses[0]).distance, atol=1e-9
    )


def test_a_carried_body_moves_with_its_link() -> None:
    robot = arm(2)
    world = World()
    world.add_robot(robot)
    load = world.add(Shape(*box(0.1)), at(1.05))
    post = world.add(Shape(*box(0.1, 0.1, 1.0)), at(0.0, 1.2))
    assert world.check_motion("arm", [0.0], [1.5]).free  # the post is out of reach
    world.attach(load, "arm/link1")
    world.allow(load, "arm/link1")
    q = np.array([0.8])
    world.set_configuration("arm", q)
    hand = robot.forward(q, "link1")
    np.testing.assert_allclose(world.poses(load), hand @ at(0.55), atol=1e-12)
    assert world.parts("arm").tolist() == [0, 1, load]
    world.set_pose(post, hand @ at(0.62))  # beyond the hand, not beyond the load
    reached = world.check_motion("arm", [0.0], [1.5])
    assert not reached.free
    assert (reached.part, reached.other) == (load, post)
    world.detach(load)
    assert world.check_motion("arm", [0.0], [0.0]).other in (-1, load)
    world.attach(load, "arm/link1")
    world.remove("arm")
    assert world.ids.tolist() == [load, post]
    assert world.record(load).carrier is None
    np.testing.assert_allclose(world.poses(load), hand @ at(0.55), atol=1e-12)


def test_two_arms_move_at_once() -> None:
    """Motions of two robots, checked together or with one as a trajectory."""
    rng = np.random.default_rng(3)
    robot = arm(3)
    world = World()
    other = robot.replace(mount=at(1.9) @ np.diag([-1.0, -1.0, 1.0, 1.0]))
    one, two = world.add_robot(robot), world.add_robot(other)
    assert [world.record(i).name for i in (one, two)] == ["arm", "arm (2)"]
    t = np.linspace(0.0, 1.0, 400)
    met = 0
    for _ in range(40):
        (a0, a1), (b0, b1) = robot.random(rng, (2, 2)) / 2
        found = world.check_motions([one, two], [a0, b0], [a1, b1])
        alone = World()
        alone.add_robot(robot)
        alone.add_robot(other)
        alone.set_trajectory("arm (2)", [0.0, 2.0], [b0, b1])
        timed = alone.check_motion("arm", a0, a1, start_time=0.0, end_time=2.0)
        hit = alone.collides("arm", robot.interpolate(a0, a1, t), times=2.0 * t)
        assert timed.free == bool(found.free[0])
        assert not (timed.free and hit.any())
        assert not hit[t < timed.free_until].any()
        assert timed.free_until == pytest.approx(found.free_until[0], abs=1e-4)
        met += not timed.free
    assert 5 < met < 35


def test_masks_hide_no_collision_of_a_robot() -> None:
    for seed in range(20):
        rng = np.random.default_rng(seed)
        robot = with_shapes(rng)
        scene = Scene(rng, robot, 2.0, count=15)
        path = robot.random(rng, 4)
        q = np.concatenate(
            [robot.interpolate(path[i], path[i + 1], np.linspace(0, 1, 15)) for i in range(3)]
        )
        before = scene.world.collides("robot", q)
        candidates = scene.world.set_path("robot", path)
        assert not set(candidates.tolist()) & set(scene.world.parts("robot").tolist())
        assert (scene.world.collides("robot", q) == before).all()
        assert (before == scene.hit(q)).all()
        near = scene.world.clearance("robot", q)
        assert set(near.body[near.distance == 0].tolist()) <= set(candidates.tolist())
        scene.world.clear_path("robot")
        assert all(scene.world.mask(i) == 0 for i in scene.world.ids)


def test_a_real_arm_is_exact() -> None:
    """The Panda, its self-collisions and a table, against its links pair by pair."""
    robot = real(PANDA)
    robot = robot.with_allowed_collisions(robot.self_collisions())
    rng = np.random.default_rng(2)
    scene = Scene(rng, robot, 0.8, count=10)
    q = robot.random(rng, 60)
    hit = scene.hit(q)
    assert (scene.world.collides("robot", q) == hit).all()
    assert 5 < hit.sum() < 55
    for q0, q1 in zip(q[~hit][:-1], q[~hit][1:], strict=True):
        found = scene.world.check_motion("robot", q0, q1)
        assert not found.unresolved
        some = scene.world.collides("robot", robot.interpolate(q0, q1, np.linspace(0, 1, 40)))
        assert not (found.free and some.any())


@pytest.mark.parametrize("how", ["copy", "deepcopy", "pickle"])
def test_a_copy_has_the_same_robots(how: str) -> None:
    rng = np.random.default_rng(4)
    scene = Scene(rng, with_shapes(rng), 1.0)
    world, robot = scene.world, scene.robot
    q = robot.random(rng, (30, 2))
    world.set_configuration("robot", q[0, 0])
    load = world.add(CUBE, somewhere(rng, 0.3))
    world.attach(load, "robot")
    world.set_trajectory("robot", [0.0, 1.0], q[1])
    world.set_path("robot", q[2])
    copiers: dict[str, Callable[[World], World]] = {
        "copy": World.copy,
        "deepcopy": deepcopy,
        "pickle": lambda w: pickle.loads(pickle.dumps(w)),
    }
    twin = copiers[how](world)
    assert twin.names == world.names
    assert twin.masks == world.masks
    for w in (world, twin):
        w.set_configuration("robot", q[3, 0])
    assert (twin.poses(twin.ids) == world.poses(world.ids)).all()
    one, other = (w.check_motion("robot", q[:, 0], q[:, 1]) for w in (world, twin))
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)
    assert twin.record("robot").robot is not None
    assert (twin.record("robot").configuration == q[3, 0]).all()
    assert [twin.mask(i) for i in twin.ids] == [world.mask(i) for i in world.ids]


def test_invalid_calls_are_errors() -> None:
    world = World()
    robot = arm(2)
    world.add_robot(robot)
    cube = world.add(CUBE, at(5.0), name="cube")
    for ask, words in (
        (
            lambda: world.collides("arm", np.eye(4)),
            r"poses: got shape \(4, 4\), expected configurations \(\.\.\., 1\)",
        ),
        (
            lambda: world.collides("cube", [0.1]),
            r"poses: got shape \(1,\), expected homogeneous poses \(\.\.\., 4, 4\)",
        ),
        (lambda: world.check_motion("arm", [np.nan], [0.0]), "start.*joint0"),
        (
            lambda: world.set_pose("arm", np.eye(4)),
            "got robot 'arm', expected bodies; use set_configuration",
        ),
        (
            lambda: world.set_configuration("cube", [0.0]),
            "got body 'cube', expected a robot; use set_pose",
        ),
        (lambda: world.configuration(cube), "got body 'cube', expected a robot; use poses"),
        (lambda: world.set_configuration("arm", [[0.0]]), "q: .*expected one"),
        (lambda: world.add_robot(robot, [0.0, 1.0]), r"q: got shape \(2,\)"),
        (lambda: world.add_robot(robot, name="arm"), "name: got 'arm', taken by"),
        (lambda: world.add_robot(robot, name="cube"), "name: got 'cube', taken by"),
        (lambda: world.add_robot(Robot("empty", [Link("l")])), "no shapes"),
        (lambda: world.remove("arm/link1"), "part of robot 'arm'"),
        (lambda: world.detach("arm/link1"), "part of robot 'arm'"),
        (lambda: world.attach("arm", "cube"), "got robot 'arm', expected a body"),
        (lambda: world.collides("arm/link1", [0.1]), "carried by 'arm'"),
        (lambda: world.set_path("arm", [0.0]), r"expected \(K, nq\)"),
        (
            lambda: world.check_motions(["arm", "cube"], [[0.0]] * 2, [[0.0]] * 2),
            "got 'cube' and 'arm' with different coordinates",
        ),
    ):
        with pytest.raises(ValueError, match=words):
            ask()
    assert world.names == ["arm", "arm/link1", "cube"]  # nothing half done
    assert world.collides("arm", [0.0]) is False

"""Robots: poses and motions, against closed forms and other libraries."""

from __future__ import annotations

import copy
import math
import os
import pickle
import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio
import pytest
from hypothesis import given
from hypothesis import strategies as st
from ompl import base as ob
from support import TESTS
from support.robots import BOX, ROOM, URDFS, random_tree, real, urdf

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.robots import Joint, Link, LinkShape, Mimic, Robot

UNIT = np.array([[0.0, 0, 0], [1, 1, 1]])  # opposite corners of a cube
SEEDS = st.integers(0, 2**32 - 1)

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


def turn_z(angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def shift(x: float, y: float, z: float) -> Floats:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def configurations(robot: Robot, count: int, seed: int = 0) -> Floats:
    """Random configurations within the limits, and within 3 without limits."""
    low, high = np.maximum(robot.lower, -3.0), np.minimum(robot.upper, 3.0)
    return np.random.default_rng(seed).uniform(low, np.maximum(low, high), (count, robot.nq))


# Limits


@given(SEEDS)
def test_valid_configurations_keep_the_limits_of_all_joints(seed: int) -> None:
    """Also those of joints that mimic others, through other mimics too."""
    rng = np.random.default_rng(seed)
    tree = random_tree(rng, "fixed")
    inside = tree.random(rng)
    values = {
        name: multiplier * inside[tree.coordinates.index(source.name)] + offset
        for name, (source, multiplier, offset) in tree.mimic_sources.items()
    }
    joints = [
        replace(joint, lower=values[joint.name] - 0.3, upper=values[joint.name] + 0.2)
        if joint.mimic is not None
        else joint
        for joint in tree.joints
    ]
    robot = tree.replace(joints=joints)
    for q in (inside, *tree.random(rng, 20)):
        kept = [
            joint.lower
            <= multiplier * q[tree.coordinates.index(source.name)] + offset
            <= joint.upper
            for joint in joints
            if joint.moves and joint.kind != "continuous"
            for source, multiplier, offset in [tree.mimic_sources[joint.name]]
        ]
        assert robot.valid(q) == all(kept)


def test_limits_of_joints_that_exclude_each_other_are_an_error() -> None:
    mimic = joint("m", "prismatic", child="c", lower=2.0, upper=3.0, mimic=Mimic("j"))
    with pytest.raises(ValueError, match="joint 'm': got limits that no value of 'j'"):
        Robot("r", [Link("a"), Link("b"), Link("c")], [joint(lower=0.0, upper=1.0), mimic])


# Poses


class Pinocchio:
    """The same file in pinocchio, which gives mimic joints coordinates of their own."""

    def __init__(self, path: str, robot: Robot) -> None:
        self.model = pinocchio.buildModelFromUrdf(str(urdf(path)))
        self.data, self.robot = self.model.createData(), robot

    def forward(self, q: Floats) -> Floats:
        value = dict(zip(self.robot.coordinates, q, strict=True))
        joints = {joint.name: joint for joint in self.robot.joints}

        def of(joint: Joint) -> float:
            m = joint.mimic
            return value[joint.name] if m is None else m.multiplier * of(joints[m.joint]) + m.offset

        x = pinocchio.neutral(self.model)
        for joint in filter(lambda j: j.moves, self.robot.joints):
            known = self.model.joints[self.model.getJointId(joint.name)]
            angle = of(joint)
            part = (angle,) if known.nq == 1 else (math.cos(angle), math.sin(angle))
            x[known.idx_q : known.idx_q + known.nq] = part
        pinocchio.framesForwardKinematics(self.model, self.data, x)
        body = pinocchio.FrameType.BODY
        frames = [self.model.getFrameId(link.name, body) for link in self.robot.links]
        return np.array([self.data.oMf[frame].homogeneous for frame in frames])


@pytest.mark.parametrize("path", URDFS, ids=lambda path: path.split("/")[-1])
def test_links_of_real_robots_agree_with_pinocchio(path: str) -> None:
    robot = real(path)
    other = Pinocchio(path, robot)
    for q in configurations(robot, 10):
        np.testing.assert_allclose(robot.forward(q), other.forward(q), rtol=0, atol=1e-9)


@given(SEEDS)
def test_a_tree_is_the_product_of_its_joints(seed: int) -> None:
    """Forward kinematics agrees with a product of textbook matrices in NumPy."""
    rng = np.random.default_rng(seed)
    robot = random_tree(rng)
    q = robot.random(rng)
    value = dict(zip(robot.coordinates, q, strict=True))
    joints = {joint.name: joint for joint in robot.joints}
    poses = {robot.root: robot.mount @ base_pose(robot.base, q)}
    for link in robot.links[1:]:
        joint = next(j for j in robot.joints if j.child == link.name)
        m = joint.mimic
        x = 0.0
        if m is not None:
            x = m.multiplier * value[joints[m.joint].name] + m.offset
        elif joint.moves:
            x = value[joint.name]
        poses[link.name] = poses[joint.parent] @ joint.origin @ joint_pose(joint, x)
    expected = [poses[link.name] for link in robot.links]
    np.testing.assert_allclose(robot.forward(q), expected, rtol=0, atol=1e-12)


def joint_pose(joint: Joint, x: float) -> Floats:
    a = joint.axis / np.linalg.norm(joint.axis) if joint.moves else joint.axis
    pose = np.eye(4)
    if joint.kind == "prismatic":
        pose[:3, 3] = x * a
    elif joint.moves:  # Rodrigues
        k = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
        pose[:3, :3] += math.sin(x) * k + (1 - math.cos(x)) * k @ k
    return pose


def base_pose(base: str, q: Floats) -> Floats:
    if base == "fixed":
        return np.eye(4)
    if base == "planar":
        return shift(q[0], q[1], 0) @ turn_z(q[2])
    pose = shift(*q[:3])
    pose[:3, :3] = pinocchio.Quaternion(q[6], *q[3:6]).matrix()
    return pose


def test_planar_base_by_hand() -> None:
    robot = Robot("cart", [Link("body")], base="planar", mount=shift(0, 0, 0.1))
    assert robot.coordinates == ("x", "y", "yaw")
    assert (robot.nq, robot.dof) == (3, 3)
    expected = shift(1, 2, 0.1) @ turn_z(0.3)
    np.testing.assert_allclose(robot.forward([1, 2, 0.3], "body"), expected, atol=1e-15)


def test_free_base_by_hand() -> None:
    robot = Robot("drone", [Link("body")], base="free")
    assert (robot.nq, robot.dof) == (7, 6)
    h = math.sqrt(0.5)
    pose = robot.forward([1, 2, 3, 0, 0, h, h], "body")  # x, y, z, w: a quarter turn about z
    np.testing.assert_allclose(pose, shift(1, 2, 3) @ turn_z(math.pi / 2), atol=1e-15)
    with pytest.raises(ValueError, match=r"length 0\.5, expected length 1"):
        robot.forward([0, 0, 0, 0, 0, 0, 0.5])


def test_a_mobile_manipulator_is_a_base_with_joints() -> None:
    joints = [
        Joint("lift", "prismatic", "base", "mast", lower=0.0, upper=0.5),
        Joint("elbow", "revolute", "mast", "arm", shift(0.2, 0, 0), lower=-1.0, upper=1.0),
    ]
    robot = Robot("m", [Link("arm"), Link("base"), Link("mast")], joints, base="planar")
    assert [link.name for link in robot.links] == ["base", "mast", "arm"]
    assert robot.coordinates == ("x", "y", "yaw", "lift", "elbow")
    expected = shift(1, 0, 0) @ turn_z(0.5) @ shift(0, 0, 0.4) @ shift(0.2, 0, 0) @ turn_z(0.2)
    pose = robot.forward([1, 0, 0.5, 0.4, 0.2], "arm")
    np.testing.assert_allclose(pose, expected, atol=1e-15)


def test_mimic_follows_through_another_mimic() -> None:
    joints = [
        Joint("c", "prismatic", "l0", "l3", mimic=Mimic("b", -1.0, 0.5)),
        Joint("b", "revolute", "l0", "l2", mimic=Mimic("a", 2.0, 0.1)),
        Joint("a", "revolute", "l0", "l1", lower=-1.0, upper=1.0),
    ]
    robot = Robot("m", [Link(f"l{i}") for i in range(4)], joints)
    assert robot.coordinates == ("a",)
    poses = robot.forward([0.3])
    at = robot.link_index
    np.testing.assert_allclose(poses[at("l2")], turn_z(0.7), atol=1e-15)
    np.testing.assert_allclose(poses[at("l3")], shift(0, 0, -0.2), atol=1e-15)


# Between configurations


def states(space: ob.StateSpace, count: int) -> tuple[list[Any], Any]:
    information = ob.SpaceInformation(space)
    return [information.allocState() for _ in range(count)], information


def test_planar_interpolation_agrees_with_ompl() -> None:
    robot = Robot("cart", [Link("body")], base="planar")
    space = ob.SE2StateSpace()
    bounds = ob.RealVectorBounds(2)
    bounds.setLow(-10.0)
    bounds.setHigh(10.0)
    space.setBounds(bounds)
    (a, b, c), _keep = states(space, 3)
    rng = np.random.default_rng(1)
    for _ in range(300):
        q0, q1 = rng.uniform(-math.pi, math.pi, (2, 3))
        t = float(rng.random())
        for state, q in ((a, q0), (b, q1)):
            state.setX(q[0])
            state.setY(q[1])
            state.setYaw(q[2])
        space.interpolate(a, b, t, c)
        expected = [c.getX(), c.getY(), c.getYaw()]
        np.testing.assert_allclose(robot.interpolate(q0, q1, t), expected, rtol=0, atol=1e-9)


def test_free_interpolation_agrees_with_ompl() -> None:
    robot = Robot("drone", [Link("body")], base="free", workspace=ROOM["free"])
    space = ob.SE3StateSpace()
    (a, b, c), _keep = states(space, 3)
    rng = np.random.default_rng(2)
    for _ in range(300):
        q0, q1 = robot.random(rng, 2)
        t = float(rng.random())
        for state, q in ((a, q0), (b, q1)):
            state.setXYZ(*q[:3])
            for name, value in zip("xyzw", q[3:], strict=True):
                setattr(state.rotation(), name, value)
        space.interpolate(a, b, t, c)
        expected = [c.getX(), c.getY(), c.getZ(), *(getattr(c.rotation(), n) for n in "xyzw")]
        np.testing.assert_allclose(robot.interpolate(q0, q1, t), expected, rtol=0, atol=1e-9)


def test_joint_interpolation_agrees_with_ompl() -> None:
    """Bounded, continuous, bounded joints: a compound of RealVector, SO2, RealVector."""
    kinds = ("revolute", "continuous", "prismatic")
    joints = [
        Joint(f"j{i}", kind, f"l{i}", f"l{i + 1}", lower=-3.0, upper=3.0)
        for i, kind in enumerate(kinds)
    ]
    robot = Robot("arm", [Link(f"l{i}") for i in range(4)], joints)
    space = ob.CompoundStateSpace()
    for part in (ob.RealVectorStateSpace(1), ob.SO2StateSpace(), ob.RealVectorStateSpace(1)):
        space.addSubspace(part, 1.0)
    (a, b, c), _keep = states(space, 3)
    rng = np.random.default_rng(3)
    for _ in range(300):
        q0, q1 = rng.uniform(-3, 3, (2, 3))
        t = float(rng.random())
        for state, q in ((a, q0), (b, q1)):
            state[0][0] = q[0]
            state[1].value = q[1]
            state[2][0] = q[2]
        space.interpolate(a, b, t, c)
        expected = [c[0][0], c[1].value, c[2][0]]
        np.testing.assert_allclose(robot.interpolate(q0, q1, t), expected, rtol=0, atol=1e-9)


@given(SEEDS)
def test_interpolation_begins_and_ends_at_its_arguments(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = random_tree(rng)
    q0, q1 = robot.random(rng, 2)
    ends = robot.interpolate(q0, q1, [0.0, 1.0])
    np.testing.assert_allclose(robot.forward(ends), robot.forward([q0, q1]), atol=1e-14)
    assert robot.valid(robot.interpolate(q0, q1, np.linspace(0, 1, 9))).all()


@given(SEEDS)
def test_no_point_moves_beyond_the_displacement_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = random_tree(rng)
    q0, q1 = robot.random(rng, 2)
    far = robot.displacement_bound(q0, q1)
    assert far == pytest.approx(robot.displacement_bound(q1, q0))
    poses = robot.forward(robot.interpolate(q0, q1, np.linspace(0, 1, 20)))
    for part in robot.parts:
        at = poses[:, part.link] @ part.origin
        points = part.shape.vertices @ np.swapaxes(at[:, :3, :3], 1, 2) + at[:, None, :3, 3]
        path = np.linalg.norm(np.diff(points, axis=0), axis=-1).sum(axis=0)
        assert path.max() <= far + 1e-12


def test_small_turns_are_not_lost() -> None:
    """OMPL treats orientations closer than 9e-5 rad as equal; a certified motion must not."""
    robot = Robot("drone", [Link("body")], base="free")
    for angle in (1e-3, 1e-6, 1e-9, 1e-12):
        q1 = [0, 0, 0, math.sin(angle / 2), 0, 0, math.cos(angle / 2)]
        found = robot.interpolate(robot.rest, q1, 0.5)
        assert found[3] == pytest.approx(math.sin(angle / 4), rel=1e-9)


def test_the_short_way_around() -> None:
    robot = Robot("cart", [Link("body")], base="planar")
    way = robot.interpolate([0, 0, 3.0], [0, 0, -3.0], [0.25, 0.75])[:, 2]
    quarter = (2 * math.pi - 6) / 4
    np.testing.assert_allclose(way, [3 + quarter, -3 - quarter])
    beyond = robot.interpolate([0, 0, 7.0], [0, 0, 8.0], [0, 0.5, 1])[:, 2]
    np.testing.assert_allclose(beyond, np.array([7, 7.5, 8]) - 2 * math.pi)


# The model


def test_limits_random_valid_clip() -> None:
    robot = real(URDFS[0])
    rng = np.random.default_rng(0)
    q = robot.random(rng, (50, 4))
    assert q.shape == (50, 4, robot.nq)
    assert robot.valid(q).all()
    assert robot.valid(robot.rest) is True
    outside = q * 3 + 1
    assert not robot.valid(outside).any()
    clipped = robot.clip(outside)
    assert robot.valid(clipped).all()
    np.testing.assert_array_equal(clipped, np.clip(outside, robot.lower, robot.upper))
    again = robot.random(np.random.default_rng(0), (50, 4))
    np.testing.assert_array_equal(q, again)


def test_random_orientations_are_uniform() -> None:
    robot = Robot("drone", [Link("body")], base="free", workspace=UNIT)
    q = robot.random(np.random.default_rng(0), 20_000)
    np.testing.assert_allclose(np.linalg.norm(q[:, 3:], axis=1), 1, atol=1e-15)
    np.testing.assert_allclose(robot.forward(q)[:, 0, :3, :3].mean(axis=0), 0, atol=0.02)
    assert robot.valid(q).all()
    assert robot.valid(robot.clip(q * 2)).all()


def test_random_without_limits_is_an_error() -> None:
    with pytest.raises(
        ValueError, match="got no limits of 'x' of 'cart', expected finite ones; give workspace="
    ):
        Robot("cart", [Link("body")], base="planar").random(np.random.default_rng(0))


def test_weights_follow_from_reach() -> None:
    joints = [
        Joint("a", "revolute", "l0", "l1", shift(1, 0, 0), lower=-1, upper=1),
        Joint("b", "prismatic", "l1", "l2", shift(0.5, 0, 0), lower=-0.1, upper=0.2),
    ]
    links = [Link("l0"), Link("l1"), Link("l2", LinkShape(BOX))]
    robot = Robot("m", links, joints, base="planar")
    tip = float(np.linalg.norm([0.05, 0.1, 0.15]))
    np.testing.assert_allclose(robot.weights, [1, 1, 1.7 + tip, 0.7 + tip, 1])


def test_neighbors_are_allowed_to_touch() -> None:
    """Adjacent links, also through links without shapes, and rigidly connected links."""
    joints = [
        Joint("1", "revolute", "a", "empty"),
        Joint("2", "revolute", "empty", "b"),
        Joint("3", "fixed", "b", "c"),
        Joint("4", "fixed", "b", "d"),
        Joint("5", "revolute", "d", "e"),
    ]
    shaped = [Link(n, LinkShape(BOX)) for n in "abcde"]
    robot = Robot("m", [*shaped, Link("empty")], joints)
    expected = {("a", "b"), ("b", "c"), ("b", "d"), ("c", "d"), ("d", "e"), ("a", "empty")}
    assert set(robot.allowed) == expected
    names = [robot.links[part.link].name for part in robot.parts]
    assert {tuple(sorted((names[i], names[j]))) for i, j in robot.allowed_parts} == {
        pair for pair in expected if "empty" not in pair
    }
    assert robot.self_collisions() == (("a", "c"), ("a", "d"), ("a", "e"), ("b", "e"), ("c", "e"))
    assert robot.with_allowed_collisions(robot.self_collisions()).self_collisions() == ()


def test_pickle_copy_repr() -> None:
    robot = real(URDFS[0]).replace(base="planar", workspace=[[-1, -1], [1, 1]])
    other = pickle.loads(pickle.dumps(robot))
    q = robot.random(np.random.default_rng(0), 20)
    np.testing.assert_array_equal(robot.forward(q), other.forward(q))
    np.testing.assert_array_equal(robot.workspace, other.workspace)
    assert other.allowed == robot.allowed
    assert len(other.parts) == len(robot.parts)
    assert copy.deepcopy(robot) is robot
    assert repr(robot) == "Robot('panda': planar base, 11 dof, 13 links, 17 shapes)"
    with pytest.raises(AttributeError):
        robot.base = "free"  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        robot.lower[0] = 0


DIGEST = """
import hashlib, sys
import numpy as np
sys.path.insert(0, {tests!r})
from support.robots import random_tree
h = hashlib.sha256()
for seed in range(12):
    rng = np.random.default_rng(seed)
    robot = random_tree(rng)
    q0, q1 = robot.random(rng, (2, 300))
    t = rng.random(300)
    link = len(robot.links) - 1
    parts = robot.forward(q0), robot.interpolate(q0, q1, t), *robot.link_motion(link, q0, q1, t)
    for part in (*parts, robot.displacement_bound(q0, q1), robot.weights):
        h.update(np.ascontiguousarray(part).tobytes())
print(h.hexdigest())
"""


@pytest.mark.unsanitized
def test_same_bits_for_any_threads_and_instruction_set() -> None:
    code = DIGEST.format(tests=str(TESTS))
    seen = set()
    for threads, isa in (("1", "baseline"), ("3", _core.isa())):
        env = {**os.environ, "FGENV_THREADS": threads, "FGENV_ISA": isa}
        run = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, check=True)
        seen.add(run.stdout)
    assert len(seen) == 1


# Bad input


def joint(name: str = "j", kind: str = "revolute", **more: Any) -> Joint:
    return Joint(name, kind, more.pop("parent", "a"), more.pop("child", "b"), **more)


TWO = (Link("a"), Link("b"))
FAULTS: list[tuple[Any, str]] = [
    (lambda: Robot("r", []), "links: got none"),
    (lambda: Robot("", TWO), "name: got '', expected a name"),
    (lambda: Robot("r", TWO), "'a', 'b': got no joint to a parent"),
    (lambda: Robot("r", (Link("a"), Link("a"))), "link 'a': got two of this name"),
    (lambda: Robot("r", TWO, [joint(child="c")]), "got 'c', expected the name of a link"),
    (lambda: Robot("r", TWO, [joint(), joint()]), "joint 'j': got two of this name"),
    (lambda: Robot("r", TWO, [joint(), joint("k")]), "got two parent joints"),
    (
        lambda: Robot("r", (*TWO, Link("c")), [joint(), joint("k", parent="b", child="a")]),
        "got a loop of joints",
    ),
    (lambda: Robot("r", TWO, [joint()], base="floating"), "base: got 'floating', expected one of"),
    (lambda: Robot("r", TWO, [joint("x")], base="planar"), "name of a coordinate"),
    (lambda: Robot("r", TWO, [joint()], workspace=UNIT[:, :2]), "got bounds for a fixed base"),
    (
        lambda: Robot("r", TWO, [joint()], "planar", workspace=0 * UNIT),
        "expected .low, high.",
    ),
    (lambda: Robot("r", TWO, [joint()], allowed=[("a", "z")]), "got 'z', expected a link of 'r'"),
    (lambda: Robot("r", TWO, [joint()], mount=2 * np.eye(4)), "mount: got no rigid transform"),
    (lambda: Robot("r", TWO, [joint(mimic=Mimic("j"))]), "mimics itself"),
    (lambda: Robot("r", TWO, [joint(mimic=Mimic("k"))]), "no such joint"),
    (lambda: joint(kind="ball"), "kind: got 'ball', expected one of fixed, revolute"),
    (lambda: joint(axis=[0, 0, 0]), "axis: got .*, expected three numbers, not all 0"),
    (lambda: joint(lower=1.0, upper=0.0), "got lower 1 over upper 0"),
    (lambda: joint(velocity=-1.0), "velocity: got -1.0, expected a number, 0 or more"),
    (lambda: joint(origin=np.eye(3)), r"origin: got shape \(3, 3\), expected a pose"),
    (lambda: joint(kind="fixed", mimic=Mimic("k")), "got mimic of 'k' for a fixed joint"),
    (lambda: Mimic("k", math.nan), "multiplier: got nan"),
    (lambda: Link("a", [BOX, None]), "shape: got NoneType, expected a Shape"),  # type: ignore[list-item]
]


@pytest.mark.parametrize(("make", "message"), FAULTS, ids=[m for _, m in FAULTS])
def test_an_invalid_model_is_an_error(make: Any, message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=message):
        make()


def test_a_fraction_of_a_continuous_joint_is_no_pose() -> None:
    joints = [
        joint("wheel", "continuous"),
        joint("gear", parent="a", child="c", mimic=Mimic("wheel", 0.5)),
    ]
    links = [*TWO, Link("c")]
    with pytest.raises(ValueError, match=r"got 0\.5 times 'wheel', a continuous joint"):
        Robot("r", links, joints)
    joints[1] = joint("gear", parent="a", child="c", mimic=Mimic("wheel", -2.0))
    robot = Robot("r", links, joints)
    np.testing.assert_allclose(robot.forward([3.0], "c"), turn_z(-6.0), atol=1e-15)


@pytest.mark.parametrize(
    ("q", "message"),
    [
        ([0, 0], r"q: got shape \(2,\), expected configurations \(\.\.\., 3\)"),
        (1.0, r"q: got shape \(\), expected configurations \(\.\.\., 3\)"),
        ([0, math.nan, 0], r"q\[1\] \('y'\): got nan, expected a finite number"),
        ([[0, 0, 0], [0, 0, math.inf]], r"q\[1, 2\] \('yaw'\): got inf"),
        ([0, 0, 1e6], r"q\[2\] \('yaw'\): got 1e\+06, expected at most 100000"),
        ([1e13, 0, 0], r"q\[0\] \('x'\): got 1e\+13"),
        (["a", "b", "c"], "q: got dtype"),
        (None, "q: got dtype object"),
        ([[0, 0, 0], [0]], "q: got rows of different lengths"),
    ],
)
def test_an_invalid_configuration_is_an_error(q: Any, message: str) -> None:
    robot = Robot("cart", [Link("body")], base="planar")
    with pytest.raises((ValueError, TypeError), match=message):
        robot.forward(q)


def test_other_invalid_arguments() -> None:
    robot = Robot("cart", [Link("body")], base="planar")
    q = np.zeros(3)
    with pytest.raises(ValueError, match=r"t: got 1.5, expected a fraction from 0 to 1"):
        robot.interpolate(q, q, 1.5)
    with pytest.raises(
        ValueError, match=r"got q0 \(4,\), q1 \(3,\), t \(\), expected .* broadcast"
    ):
        robot.interpolate(np.zeros((4, 3)), np.zeros((3, 3)), 0.5)
    with pytest.raises(ValueError, match="link: got 'wheel', expected one of 'cart': body"):
        robot.forward(q, "wheel")
    with pytest.raises(ValueError, match="link: got 1, expected an index below 1 of 'cart'"):
        robot.forward(q, 1)
    with pytest.raises(ValueError, match=r"threads: got .*, expected an integer"):
        robot.forward(q, threads=0)


def test_empty_batches() -> None:
    robot = Robot("cart", [Link("body")], base="planar")
    assert robot.forward(np.zeros((0, 3))).shape == (0, 1, 4, 4)
    assert robot.interpolate(np.zeros((0, 3)), np.zeros(3), 0.5).shape == (0, 3)
    none = Robot("post", [Link("body")])
    assert none.forward(np.zeros((5, 0))).shape == (5, 1, 4, 4)
    np.testing.assert_array_equal(none.forward([]), np.eye(4)[None])


CORE: dict[str, Any] = {
    "kinds": [0, 1],
    "parents": [-1, 0],
    "origins": np.tile(np.eye(4), (2, 1, 1)),
    "axes": np.ones((2, 3)),
    "firsts": [0, 0],
    "multipliers": [1.0, 1.0],
    "offsets": [0.0, 0.0],
    "names": ["a"],
}


@pytest.mark.parametrize(
    "change",
    [
        {"kinds": [0, 6]},
        {"kinds": [0, -1]},
        {"kinds": [0, 4]},
        {"kinds": [5, 1]},
        {"parents": [-1, 1]},
        {"parents": [-1, -1]},
        {"parents": [0, 0]},
        {"parents": [-1]},
        {"firsts": [0, 1]},
        {"firsts": [0, -1]},
        {"names": []},
        {"multipliers": [1.0, math.nan]},
        {"offsets": [1.0, 1e300]},
        {"origins": np.zeros((2, 4, 4))},
        {"axes": np.full((2, 3), math.nan)},
        {
            "kinds": [],
            "parents": [],
            "origins": np.zeros((0, 4, 4)),
            "axes": np.zeros((0, 3)),
            "firsts": [],
            "multipliers": [],
            "offsets": [],
        },
    ],
)
def test_the_native_model_rejects_invalid_arguments(change: dict[str, Any]) -> None:
    _core.Robot(**CORE).forward([0.5], None)
    with pytest.raises(ValueError, match=r"expected|parents|firsts|singular|finite"):
        _core.Robot(**{**CORE, **change})

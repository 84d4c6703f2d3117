"""Motions of links: their bounds, which certified checks use, hold."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.robots import URDFS, place, random_tree, real

from fgenv.arrays import Floats
from fgenv.robots import Joint, Link, LinkMotion, Robot

SEEDS = st.integers(0, 2**32 - 1)

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


class Way:
    """A random motion of a random robot; some joints rest."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.robot = random_tree(self.rng)
        self.q0, self.q1 = self.robot.random(self.rng, 2)
        still = self.rng.random(self.robot.nq) < 0.2
        if self.robot.base == "free":
            still[3:7] = still[3]
        self.q1[still] = self.q0[still]
        self.link = int(self.rng.integers(len(self.robot.links)))
        self.offset = place(self.rng) if self.rng.random() < 0.5 else None

    def at(self, t: float | Floats) -> LinkMotion:
        return self.robot.link_motion(self.link, self.q0, self.q1, t, offset=self.offset)

    def bound(self, radius: float) -> float:
        """Upper bound of the acceleration of a point at this distance from the origin."""
        motion = self.at(0.0)
        at_origin, by_radius = motion.acceleration_at_origin, motion.acceleration_by_radius
        return float(at_origin + radius * by_radius)


@given(SEEDS)
def test_pose_is_that_of_the_interpolated_configuration_bit_for_bit(seed: int) -> None:
    way = Way(seed)
    t = np.array([0.0, 0.1, 0.5, 1 / 3, 1.0])
    q = way.robot.interpolate(way.q0, way.q1, t)
    poses = way.robot.forward(q, way.link)
    found = way.at(t).pose
    if way.offset is None:
        np.testing.assert_array_equal(found, poses)
    else:
        np.testing.assert_allclose(found, poses @ way.offset, atol=1e-14)


@given(SEEDS)
def test_velocity_is_the_derivative_of_the_pose(seed: int) -> None:
    way = Way(seed)
    h = 1e-5
    for t in way.rng.uniform(h, 1 - h, 3):
        motion = way.at(t)
        before, after = way.at(t - h).pose, way.at(t + h).pose
        v = (after[:3, 3] - before[:3, 3]) / (2 * h)
        spin = (after[:3, :3] - before[:3, :3]) / (2 * h) @ motion.pose[:3, :3].T
        w = [spin[2, 1], spin[0, 2], spin[1, 0]]
        np.testing.assert_allclose(motion.velocity, v, rtol=1e-5, atol=1e-6)
        np.testing.assert_allclose(motion.angular_velocity, w, rtol=1e-5, atol=1e-6)


@given(SEEDS)
def test_no_point_accelerates_beyond_the_bound(seed: int) -> None:
    """A second difference is a mean of the acceleration, so that the bound holds for it."""
    way = Way(seed)
    h = 1e-3
    t = way.rng.uniform(h, 1 - h, 40)
    poses = [way.at(t + s).pose for s in (-h, 0, h)]
    for radius in (0.0, 0.3, 3.0):
        for d in (*np.eye(3), *way.rng.normal(size=(3, 3))):
            point = radius * d / np.linalg.norm(d)
            x = [p[:, :3, :3] @ point + p[:, :3, 3] for p in poses]
            acceleration = np.linalg.norm(x[0] - 2 * x[1] + x[2], axis=-1) / h**2
            assert acceleration.max() <= way.bound(radius) + 1e-7


@given(SEEDS)
def test_no_link_turns_beyond_the_bound(seed: int) -> None:
    way = Way(seed)
    motion = way.at(np.linspace(0, 1, 30))
    assert (np.linalg.norm(motion.angular_velocity, axis=-1) <= motion.turn + 1e-12).all()


@given(SEEDS)
def test_a_part_of_a_motion_is_that_part(seed: int) -> None:
    way = Way(seed)
    begin = way.rng.random()
    rate = way.rng.random() * (1 - begin)
    t = np.linspace(0, 1, 5)
    part = LinkMotion(
        *way.robot._core.link_motion(
            way.link, way.q0, way.q1, t=t, offset=way.offset, begin=begin, rate=rate, threads=None
        )
    )
    whole = way.at(np.minimum(begin + rate * t, 1))
    np.testing.assert_array_equal(part.pose, whole.pose)
    np.testing.assert_allclose(part.velocity, rate * whole.velocity, atol=1e-12)
    np.testing.assert_allclose(part.angular_velocity, rate * whole.angular_velocity, atol=1e-12)
    np.testing.assert_allclose(part.turn, rate * whole.turn)
    for name in ("acceleration_at_origin", "acceleration_by_radius"):
        np.testing.assert_allclose(getattr(part, name), rate**2 * getattr(whole, name))


def chain(*joints: Joint) -> Robot:
    """A chain of links l0, l1, ..."""
    return Robot("chain", [Link(f"l{i}") for i in range(len(joints) + 1)], joints)


def step(i: int, kind: str, x: float, y: float, z: float, axis: str = "z") -> Joint:
    """Joint i of a chain, at (x, y, z) from the one before it."""
    origin = np.eye(4)
    origin[:3, 3] = x, y, z
    which = np.eye(3)["xyz".index(axis)]
    return Joint(f"j{i}", kind, f"l{i}", f"l{i + 1}", origin, which, -3, 3)


def bounds(robot: Robot, q1: list[float]) -> tuple[float, float, float]:
    """Bounds of the last link: acceleration at the origin, by radius, turn."""
    motion = robot.link_motion(len(robot.links) - 1, robot.rest, q1)
    out = motion.acceleration_at_origin, motion.acceleration_by_radius, motion.turn
    return tuple(map(float, out))  # type: ignore[return-value]


def test_the_bound_is_exact_where_it_can_be() -> None:
    tight = partial(pytest.approx, rel=2e-4)
    # One joint turns, the link 2 m beside its axis, 5 m along it.
    robot = chain(step(0, "revolute", 0, 0, 0), step(1, "fixed", 2, 0, 5))
    assert bounds(robot, [1.5]) == tight((2 * 1.5**2, 1.5**2, 1.5))
    # Two parallel axes: rates add up with their signs.
    robot = chain(step(0, "revolute", 0, 0, 0), step(1, "revolute", 1, 0, 0))
    assert bounds(robot, [1.0, -1.0]) == tight((1.0, 0.0, 0.0), abs=1e-9)
    assert bounds(robot, [1.0, 0.5]) == tight((1.0, 1.5**2, 1.5))
    # Two axes across: |w| is their hypotenuse; A = r r' as well.
    robot = chain(step(0, "revolute", 0, 0, 0), step(1, "revolute", 0, 0, 1, "x"))
    assert bounds(robot, [1.0, 1.0]) == tight((0.0, 3.0, math.sqrt(2)), abs=1e-9)
    # A slide on a turntable, out to 0.5 m: centripetal and Coriolis.
    robot = chain(step(0, "revolute", 0, 0, 0), step(1, "prismatic", 0, 0, 0, "x"))
    assert bounds(robot, [1.0, 0.5]) == tight((1.5, 1.0, 1.0))
    # And along the axis: none.
    robot = chain(step(0, "revolute", 0, 0, 0), step(1, "prismatic", 0, 0, 0, "z"))
    assert bounds(robot, [1.0, 0.5]) == tight((0.0, 1.0, 1.0), abs=1e-9)
    # Only a shift.
    assert bounds(robot, [0.0, 0.5]) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("base", ["planar", "free"])
def test_a_base_moves_as_a_rigid_motion(base: str) -> None:
    robot = Robot("body", [Link("body")], base=base)
    q1 = robot.rest.copy()
    q1[:2] = 3.0, -1.0
    if base == "planar":
        q1[2] = 0.8
    else:
        q1[3:] = math.sin(0.4), 0, 0, math.cos(0.4)
    motion = robot.link_motion("body", robot.rest, q1, 0.3)
    np.testing.assert_allclose(motion.velocity, [3, -1, 0], atol=1e-15)
    w = [0, 0, 0.8] if base == "planar" else [0.8, 0, 0]
    np.testing.assert_allclose(motion.angular_velocity, w, atol=1e-14)
    assert motion.acceleration_at_origin == 0
    assert motion.acceleration_by_radius == pytest.approx(0.64, rel=2e-4)
    assert motion.turn == pytest.approx(0.8)


@pytest.mark.parametrize("path", URDFS[:3], ids=lambda path: path.split("/")[-1])
def test_the_bound_is_close_for_real_arms(path: str) -> None:
    robot = real(path)
    rng = np.random.default_rng(0)
    low, high = np.maximum(robot.lower, -3), np.minimum(robot.upper, 3)
    q0, q1 = rng.uniform(low, high, (2, 100, robot.nq))
    h, t = 1e-3, np.linspace(0.01, 0.99, 50)[:, None]
    last = max(range(len(robot.links)), key=lambda i: robot.link_motion(i, q0, q1).turn.max())
    x = [robot.link_motion(last, q0, q1, t + s).pose[..., :3, 3] for s in (-h, 0, h)]
    real_ones = (np.linalg.norm(x[0] - 2 * x[1] + x[2], axis=-1) / h**2).max(axis=0)
    told = robot.link_motion(last, q0, q1).acceleration_at_origin
    assert (real_ones <= told + 1e-7).all()
    assert np.median(told / real_ones) < 5

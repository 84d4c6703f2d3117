"""Movers that stop at their first contact, in chronological order and without overlaps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.world_model import along, nudged
from support.robots import random_tree

from fgenv.arrays import Floats
from fgenv.bench.common.solids import angle_iron, at, ball, box, turned
from fgenv.collision import Shape, World, collide
from fgenv.collision.world import MotionResult

pytestmark = pytest.mark.native

HERE = np.eye(4)
PITCH = 1.1  # meters between 64 bodies of up to 0.9
SEEDS = st.integers(0, 2**32 - 1)
SHAPES = [Shape(*s) for s in (box(0.5), angle_iron(0.6, 0.15, 0.4), ball(0.3), box(0.9, 0.1, 0.2))]


def line(*places: float) -> tuple[World, list[int]]:
    """Cubes of one meter along x."""
    world = World()
    cube = Shape(*box(1.0))
    return world, [world.add(cube, at(x)) for x in places]


def move(world: World, ids: list[int], ends: list[Floats]) -> MotionResult:
    """Move all bodies up to their first contacts."""
    starts = world.poses(ids)
    found = world.advance(ids, ends)
    assert (found.free_until >= 0).all()
    assert (found.free_until <= 1).all()
    there = along(starts, np.array(ends), found.free_until)
    np.testing.assert_allclose(world.poses(ids), there, atol=1e-12)
    return found


def test_a_queue_stops_one_after_the_other() -> None:
    """The first body hits a wall, the second hits the first, the third the second."""
    world, ids = line(0.0, 2.0, 4.0)
    wall = world.add(Shape(*box(1.0)), at(6.5))
    found = move(world, ids, [at(6.0), at(8.0), at(10.0)])
    np.testing.assert_allclose(world.poses(ids)[:, 0, 3], [3.5, 4.5, 5.5], atol=1e-5)
    assert found.other.tolist() == [ids[1], ids[2], wall]
    assert world.contact_pairs().tolist() == []


def test_a_stopped_body_has_no_contact_beyond_its_stop() -> None:
    """Stopped by a wall, the second does not reach the place of its contact with the third."""
    world, ids = line(0.0, 6.0)
    world.add(Shape(*box(1.0)), at(2.0))
    both = world.check_motions(ids, world.poses(ids), [at(5.0), at(4.0)])
    assert not both.free.any()
    stopped = move(world, ids, [at(5.0), at(4.0)])
    assert stopped.free.tolist() == [False, True]
    assert stopped.free_until[1] == 1.0


def test_a_stopped_body_is_hit_at_its_place() -> None:
    """A follower at constant distance hits a body that a wall has stopped."""
    world, ids = line(0.0, 2.0)
    world.add(Shape(*box(1.0)), at(3.5))
    assert world.check_motions(ids, world.poses(ids), [at(8.0), at(10.0)]).free.tolist() == [
        False,  # the wall, in the end
        False,
    ]
    found = move(world, ids, [at(8.0), at(10.0)])
    np.testing.assert_allclose(world.poses(ids)[:, 0, 3], [1.5, 2.5], atol=1e-5)
    assert found.other.tolist()[0] == ids[1]


def test_a_body_that_leaves_in_time_is_not_hit() -> None:
    world, ids = line(0.0, 2.0)
    found = move(world, ids, [at(3.0), at(5.0)])
    assert found.free.all()


@given(SEEDS)
@settings(max_examples=30)
def test_no_bodies_overlap_after_any_step(seed: int) -> None:
    """64 bodies of all forms in a dense scene; stopped bodies may move on or stay."""
    rng = np.random.default_rng(seed)
    world, ids = World(), []
    grid = [(x, y, z) for x in range(4) for y in range(4) for z in range(4)]
    for place in grid:
        pose = at(*(PITCH * np.array(place)))
        ids.append(world.add(SHAPES[rng.integers(len(SHAPES))], pose))
    assert world.contact_pairs().tolist() == []
    stopped = unresolved = 0
    for _ in range(8):
        starts = world.poses(ids)
        ends = [nudged(rng, pose, 0.3, 0.5) for pose in starts]
        found = move(world, ids, ends)
        assert world.contact_pairs().tolist() == []
        unresolved += np.isnan(found.contact_by).sum()
        stopped += (~found.free).sum()
        justified(world, ids, starts, np.array(ends), found)
    assert stopped > 20
    assert unresolved == 0


def justified(
    world: World, ids: list[int], starts: Floats, ends: Floats, found: MotionResult
) -> None:
    """A stopped body would hit the other one within a micrometer, where that is at the time."""
    for i in np.flatnonzero(np.isfinite(found.contact_by))[::3]:
        shown = found.contact_by[i]
        j = ids.index(found.other[i])
        mine = along(starts[[i]], ends[[i]], np.array([shown]))[0]
        until = shown if found.other[j] == ids[i] else found.free_until[j]
        theirs = along(starts[[j]], ends[[j]], np.array([until]))[0]
        a, b = (world.record(ids[k]).shape for k in (i, j))
        assert collide(a, mine, b, theirs, margin=1e-9)


@given(SEEDS)
@settings(max_examples=10)
def test_robots_stop_too(seed: int) -> None:
    rng = np.random.default_rng(seed)
    while not (robot := random_tree(rng, "planar", 5)).parts:
        pass
    world = World()
    ids: list[int] = []
    placed: list[Floats] = []
    for _ in range(8):
        me = world.add_robot(robot)
        for _ in range(40):
            here = robot.random(rng)
            if not world.collides(me, here):
                break
        else:
            world.remove(me)
            continue
        world.set_configuration(me, here)
        ids.append(me)
        placed.append(here)
    q = np.array(placed).reshape(len(ids), robot.nq)
    assert world.contact_pairs().tolist() == []
    for _ in range(5):
        ends = robot.random(rng, len(ids))
        found = world.advance(ids, ends)
        q = robot.interpolate(q, ends, found.free_until)
        assert (q == np.array([world.configuration(me) for me in ids])).all()
        assert world.contact_pairs().tolist() == []


def test_the_order_of_names_changes_nothing() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        world = World()
        ids = [world.add(SHAPES[i % 4], at(0.8 * (i % 4), 0.8 * (i // 4))) for i in range(12)]
        starts = world.poses(ids)
        ends = np.array([nudged(rng, pose, 0.5, 0.5) for pose in starts])
        twin = world.copy()
        one = world.advance(ids, ends)
        order = rng.permutation(12)
        other = twin.advance(np.array(ids)[order], ends[order])
        np.testing.assert_allclose(one.free_until[order], other.free_until, atol=2e-6)
        assert (one.free[order] == other.free).all()


def test_turning_on_the_spot_in_a_crowd() -> None:
    """Bars that turn like clock hands into each other: each stops just before the other."""
    world = World()
    bar = Shape(*box(1.9, 0.1, 0.1))
    ids = [world.add(bar, at(1.0 * i)) for i in range(2)]
    world.set_pose(ids, [turned(np.pi / 2), at(1.0) @ turned(np.pi / 2)])
    found = move(world, ids, [turned(0.0), at(1.0) @ turned(np.pi)])
    assert not found.free.any()
    assert found.free_until == pytest.approx(found.free_until[::-1])
    assert world.contact_pairs().tolist() == []


def test_invalid_arguments_raise() -> None:
    world, ids = line(0.0, 2.0)
    one: Any = 0
    cases: list[tuple[Callable[[], object], str]] = [
        (lambda: world.advance([0, 0], [HERE, HERE]), "robots: got body 0 twice"),
        (lambda: world.advance(one, HERE), r"robots, end: .*expected \(n,\) and \(n, 4, 4\)"),
        (lambda: world.advance(ids, HERE), r"robots, end: .*expected \(n,\) and \(n, 4, 4\)"),
        (lambda: world.advance([0, 7], [HERE, HERE]), "robots: got 7, expected the id of a body"),
        (lambda: world.advance(ids, [HERE, 2 * HERE]), r"end\[1\]"),
        (lambda: world.advance(ids, [HERE, HERE], tolerance=0.0), "tolerance"),
    ]
    for ask, words in cases:
        with pytest.raises(ValueError, match=words):
            ask()
    assert world.poses(ids)[:, 0, 3].tolist() == [0.0, 2.0]
    assert world.advance([], np.empty((0, 4, 4))).free.shape == (0,)

"""Motions at the limit of rounding: bounded work, few unresolved, and no contact missed."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from oracles.world_model import along

from fgenv.bench.common.solids import angle_iron, at, bowl, box, moved, opened, turned
from fgenv.bench.limits.flush_motions import KINDS, FlushMotion, flush_motion, flush_motions
from fgenv.collision import MeshWarning, Shape
from fgenv.collision.world import MotionResult, World

HERE = np.eye(4)
SMALLEST_LIMIT = 1 << 13  # steps of one search, for small bodies
PARTS = {
    "box": moved(box(), 0, 0, 0.5),
    "angle iron": angle_iron(),
    "bowl": bowl(0.5, 0.1, 6),
    "open box": opened(moved(box(), 0, 0, 0.5)),
}

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


def scene(motion: FlushMotion) -> tuple[World, int]:
    world = World()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)
        world.add(Shape(*motion.table), motion.table_pose)
        return world, world.add(Shape(*motion.part), motion.start)


def check(motion: FlushMotion) -> tuple[World, int, MotionResult]:
    world, part = scene(motion)
    found = world.check_motion(part, motion.start, motion.end, tolerance=motion.tolerance)
    return world, part, found


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("gap", [1e-4, 1e-7, 1e-9, 1e-11, 1e-13, 3e-16])
@pytest.mark.parametrize("angle", [0.0, 2.0, -3.0])
def test_a_part_that_slides_flush_is_free_after_a_few_steps(
    name: str, gap: float, angle: float
) -> None:
    """A million steps before planes at rest: acceleration counted as if it led to the table."""
    world = World()
    world.add(Shape(*moved(box(3.0), 0, 0, -1.5)))
    part = world.add(Shape(*PARTS[name]), at(z=gap))
    found = world.check_motion(part, at(-0.5, 0, gap), at(0.5, 0.1, gap) @ turned(angle))
    assert found.free
    assert world.motion_steps < 300


def test_a_part_that_slides_along_two_walls_is_free() -> None:
    """No plane separates the bodies: each pair of faces has its own."""
    for gap in (1e-12, 1e-9, 1e-5):
        world = World()
        world.add(Shape(*angle_iron(2.0, 0.25)))
        part = world.add(Shape(*moved(box(0.3), 0.4, 0.4, 0.5)))
        assert world.check_motion(part, at(gap, gap), at(0.7, gap, 0.2)).free
        assert not world.check_motion(part, at(gap, gap), at(0.7, -1e-5, 0.2)).free


def test_nearly_all_are_resolved_with_bounded_work() -> None:
    """A free motion has no colliding sample."""
    unresolved, count = 0, 1000
    for motion in flush_motions(3, count):
        world, part, found = check(motion)
        unresolved += bool(found.unresolved)
        faces = len(motion.table[1]) + len(motion.part[1])
        assert world.motion_steps <= 2 * (SMALLEST_LIMIT + faces**2 // 16) + 1000
        if found.free:
            poses = along(motion.start, motion.end, np.linspace(0.01, 0.99, 7))
            assert not world.collides(part, poses).any()
        else:
            assert found.unresolved or found.free_until <= found.contact_by
    assert unresolved < 0.01 * count


@pytest.mark.parametrize("kind", ["apart", "together"])
def test_parts_that_lift_off_or_land_are_free(kind: str) -> None:
    """Also from or to a gap below rounding, where the pose that is tested is free."""
    rng = np.random.default_rng(4)
    for _ in range(100):
        motion = flush_motion(rng, kind)
        world, part, found = check(motion)
        ends = np.stack([motion.start, motion.end])
        if not world.collides(part, ends).any() and kind == "apart":
            assert found.free


def test_bodies_that_touch_while_they_slide_are_in_contact() -> None:
    """A chip that slides over a step of exactly its own height meets it, however short the step."""
    step = moved(box(0.001, 1.0, 1.0), 0, 0, -0.5)
    for turn in (HERE, turned(0.5)):
        for path in (1.0, 30.0):
            world = World()
            world.add(Shape(*step), turn)
            chip = world.add(Shape(*moved(box(0.01), 0, 0, 0.005)), at(-5))
            start, end = at(-path, 0.123), at(path + 0.1234, 0.123)
            assert world.check_motion(
                chip, turn @ at(0, 0, 1e-3) @ start, turn @ at(0, 0, 1e-3) @ end
            ).free
            if turn is HERE:
                assert not world.check_motion(chip, start, end).free


def unresolved_motion() -> FlushMotion:
    for motion in flush_motions(2, 2000)[4::10]:
        if check(motion)[2].unresolved:
            return motion
    raise AssertionError("no motion is unresolved")


def test_a_search_that_reaches_its_limit_is_unresolved_and_not_free() -> None:
    """Unless an overlap follows, which is reported: with the same body, or with another."""
    motion = unresolved_motion()
    world, part, found = check(motion)
    assert not found
    assert not found.free
    assert np.isnan(found.contact_by)
    assert (found.other, found.part) == (0, part)
    both = world.check_motion(part, motion.start, np.stack([motion.end, motion.start]))
    assert both.unresolved.tolist() == (~both.free).tolist()
    post = world.add(Shape(*box(0.1)), motion.end @ at(*motion.part[0][0]))
    later = world.check_motion(part, motion.start, motion.end)
    assert (later.free_until, later.other) == (found.free_until, post)
    assert later.free_until < later.contact_by <= 1.0


def test_far_from_the_origin_the_tolerance_is_the_rounding_of_coordinates() -> None:
    """At 1e8 m coordinates are 1.5e-8 m apart, more than the tolerance."""
    for corner in (at(1e8), at(1e8, -1e8, 1e8), at(-1e6, 1e8)):
        world = World()
        world.add(Shape(*box()), corner)
        part = world.add(Shape(*box()), corner @ at(-3.0))
        for end in (at(1.0), at(1.0) @ turned(1.0)):
            found = world.check_motion(part, corner @ at(-3.0), corner @ end, tolerance=1e-9)
            assert not found.unresolved
            assert found.contact_by - found.free_until < 1e-5


def test_the_mix_has_every_kind() -> None:
    assert {motion.kind for motion in flush_motions(0, len(KINDS))} == set(KINDS)

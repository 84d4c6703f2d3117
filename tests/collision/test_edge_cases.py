"""Edge cases: containment, flush faces, touching, slivers, and thin, tiny and far bodies."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from oracles.independent import truth

from fgenv.arrays import Floats
from fgenv.bench.common.solids import (
    Solid,
    angle_iron,
    at,
    ball,
    bowl,
    box,
    inverted,
    moved,
    opened,
    scaled,
    somewhere,
    together,
)
from fgenv.collision import Shape, collide, contact_point, distance

HERE = np.eye(4)
PLACES = [HERE, *(somewhere(np.random.default_rng(seed)) for seed in range(5))]

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


def shape(solid: Solid) -> Shape:
    return Shape(*solid)


def verdicts(a: Shape, b: Shape, apart: Floats) -> set[bool]:
    """Results for b at `apart` in a's frame, at several places and in both orders."""
    found = set()
    for place in PLACES:
        found.add(bool(collide(a, place, b, place @ apart)))
        found.add(bool(collide(b, place @ apart, a, place)))
    return found


# Containment


def test_a_body_inside_another_collides() -> None:
    cube, pebble = shape(box(1.0)), shape(ball(0.1))
    assert verdicts(cube, pebble, at(0.1, 0.2, -0.1)) == {True}
    assert verdicts(cube, pebble, at(0.75, 0.0, 0.0)) == {False}
    assert distance(cube, HERE, pebble, HERE) == 0.0
    found = contact_point(cube, HERE, pebble, HERE)
    assert found is not None
    assert found.edge is None


def test_a_body_in_a_pocket_is_free() -> None:
    iron, pebble = shape(angle_iron()), shape(ball(0.1))
    assert verdicts(iron, pebble, at(0.6, 0.6, 0.5)) == {False}  # within the hull and the box
    assert verdicts(iron, pebble, at(0.125, 0.6, 0.5)) == {True}  # within the arm


def test_a_body_in_a_bowl_is_free() -> None:
    pot, pebble = shape(bowl()), shape(ball(0.2))
    assert verdicts(pot, pebble, at(0.0, 0.0, 0.5)) == {False}
    assert verdicts(pot, pebble, at(0.0, 0.0, 0.25)) == {True}
    wall = shape(ball(0.02))
    assert verdicts(pot, wall, at(0.95, 0.0, 0.5)) == {True}  # inside the wall


def test_a_body_between_shells_is_free_and_inside_one_it_collides() -> None:
    pair = shape(together(moved(box(1.0), x=-2.0), moved(box(1.0), x=2.0)))
    pebble = shape(ball(0.1))
    assert verdicts(pair, pebble, HERE) == {False}
    assert verdicts(pair, pebble, at(2.0)) == {True}
    assert verdicts(pair, pebble, at(-2.0)) == {True}


def test_one_shell_of_several_inside_is_enough() -> None:
    crumbs = shape(together(moved(ball(0.1), x=-9.0), moved(ball(0.1), x=9.0)))
    cube = shape(box(1.0))
    assert verdicts(cube, crumbs, HERE) == {False}
    assert verdicts(cube, crumbs, at(9.1)) == {True}
    assert verdicts(cube, crumbs, at(-9.1)) == {True}


@pytest.mark.parametrize(("pebbles", "cubes"), [(40, 3), (3, 40)])
def test_the_one_part_inside_is_found_among_many(pebbles: int, cubes: int) -> None:
    """The smaller set of parts and solids is searched in the larger one."""
    dust = shape(together(*(moved(ball(0.1), 3.0 * i, 0.0, 0.0) for i in range(pebbles))))
    crates = shape(together(*(moved(box(1.0), 0.0, 3.0 * i, 0.0) for i in range(cubes))))
    # the pebble at the end of its row, beside the crate at the end of its column or in it
    x, y = 3.0 * (pebbles - 1), 3.0 * (cubes - 1)
    assert verdicts(dust, crates, at(x + 1.0, -y, 0.0)) == {False}
    assert verdicts(dust, crates, at(x + 0.3, -y, 0.1)) == {True}


def test_a_cavity_is_free_and_the_wall_around_it_solid() -> None:
    hollow = shape(together(ball(1.0), inverted(ball(0.6))))
    assert hollow.watertight
    pebble = shape(ball(0.1))
    assert verdicts(hollow, pebble, at(0.3, 0.1, 0.0)) == {False}
    assert verdicts(hollow, pebble, at(0.78, 0.0, 0.0)) == {True}
    assert verdicts(hollow, pebble, at(0.0, 0.58, 0.0)) == {True}


def test_shells_that_overlap_are_solid_where_they_do() -> None:
    """The common part of two balls has winding number 2; parity would count it as outside."""
    lens = shape(together(moved(ball(1.0), x=-0.4), moved(ball(1.0), x=0.4)))
    assert verdicts(lens, shape(ball(0.05)), HERE) == {True}


@pytest.mark.parametrize("solid", [box(1.0), ball(0.6), angle_iron()], ids=["box", "ball", "iron"])
def test_an_inverted_mesh_is_the_same_solid(solid: Solid) -> None:
    inside_out, pebble = shape(inverted(solid)), shape(ball(0.03))
    for where in (at(0.2, 0.1, 0.1), at(0.3, 0.3, 0.3), at(2.0)):
        assert verdicts(inside_out, pebble, where) == verdicts(shape(solid), pebble, where)


def test_an_open_mesh_is_a_surface() -> None:
    tray, pebble = shape(opened(box(1.0))), shape(ball(0.1))
    assert not tray.watertight
    assert verdicts(tray, pebble, HERE) == {False}
    sides = [
        bool(collide(tray, HERE, pebble, at(*p))) for p in 0.5 * np.vstack([np.eye(3), -np.eye(3)])
    ]
    assert sum(sides) == 5


def test_a_surface_inside_a_solid_collides() -> None:
    cube, sheet = shape(box(1.0)), shape(opened(box(0.2)))
    assert verdicts(cube, sheet, at(0.1, 0.1, 0.1)) == {True}


# Touching


def test_touching_counts() -> None:
    a, b = shape(box(1.0)), shape(box(0.5))
    for direction in np.eye(3):
        for shift in ((0, 0, 0), (0.25, 0.125, 0.0625), (0.75, 0.75, 0.75)):
            offset = np.where(direction == 1, 0.75, shift)
            assert collide(a, HERE, b, at(*offset)), "face, edge and corner contact"
            assert not collide(a, HERE, b, at(*(offset + 1e-9 * direction)))
            assert collide(a, HERE, b, at(*(offset - 1e-9 * direction)))


def test_edges_and_corners_that_cross_in_a_point_touch() -> None:
    roof = Shape([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    spike = Shape([[1, 0.25, 0], [0.5, 0.25, 1], [1.5, 0.25, 1]], [[0, 1, 2]])
    assert collide(roof, HERE, spike, HERE)  # a corner on a face
    assert collide(roof, HERE, spike, at(0, 0.25, 0))  # a corner on the inner diagonal
    assert collide(roof, HERE, spike, at(0, -0.25, 0))  # on the border
    assert collide(roof, HERE, spike, at(1, 0.75, 0))  # on a corner
    assert not collide(roof, HERE, spike, at(0, 0, 1e-12))
    assert not collide(roof, HERE, spike, at(1 + 1e-12, 0, 0))


@pytest.mark.parametrize(
    "solid",
    [box(1.0), ball(0.5), angle_iron(), bowl(), opened(ball(1.0)), scaled(box(1.0), 1e-5)],
    ids=["box", "ball", "iron", "bowl", "open ball", "tiny box"],
)
def test_a_shape_collides_with_itself(solid: Solid) -> None:
    a, b = shape(solid), shape(solid)
    for place in PLACES:
        assert collide(a, place, a, place)
        assert collide(a, place, b, place)


def test_touching_stays_touching_when_both_take_one_pose() -> None:
    """The same pose for both keeps the relative pose, independent of its digits."""
    rng = np.random.default_rng(7)
    places = np.stack([somewhere(rng) for _ in range(300)])
    cube, beside = shape(box(1.0)), shape(moved(box(0.5), x=0.75))
    assert collide(cube, places, beside, places).all()
    sheet = shape(opened(ball(1.0)))  # no interior, hence only a touch can be found
    assert collide(sheet, places, sheet, places).all()
    assert not collide(cube, places, shape(moved(box(0.5), x=0.75 + 1e-9)), places).any()


# Flush faces: FCL misses some of these


def flush_boxes() -> list[tuple[Floats, Floats]]:
    """Sides and center of boxes inside the unit cube, flush with one to six of its faces."""
    made = []
    for sides in itertools.product((0.25, 0.5, 1.0), repeat=3):
        for push in itertools.product((-1, 0, 1), repeat=3):
            size = np.array(sides)
            made.append((size, np.array(push) * (1.0 - size) / 2))
    return made


def test_flush_boxes_inside_collide_in_every_pose() -> None:
    cube = shape(box(1.0))
    rng = np.random.default_rng(1)
    for size, center in flush_boxes():
        inner = shape(box(*size))
        place = np.stack([HERE, *(somewhere(rng) for _ in range(3))])
        assert np.all(collide(cube, place, inner, place @ at(*center))), (size, center)


def test_flush_faces_outside_touch_where_they_are_exact() -> None:
    cube = shape(box(1.0))
    for size, center in flush_boxes():
        inner = shape(box(*size))
        for axis, sign in itertools.product(range(3), (-1, 1)):
            offset = center.copy()
            offset[axis] = sign * (1.0 + size[axis]) / 2
            assert collide(cube, HERE, inner, at(*offset))
            offset[axis] += sign * 1e-9
            assert not collide(cube, HERE, inner, at(*offset))


def test_flush_coplanar_sheets() -> None:
    sheet = Shape([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    small = Shape([[0.4, 0.2, 0], [0.6, 0.2, 0], [0.6, 0.3, 0]], [[0, 1, 2]])
    assert collide(sheet, HERE, small, HERE)  # no pair of edges crosses
    assert collide(small, HERE, sheet, HERE)
    assert collide(sheet, HERE, sheet, at(1.0, 0.0, 0.0))  # a shared edge
    assert collide(sheet, HERE, sheet, at(1.0, 1.0, 0.0))  # a shared corner
    assert not collide(sheet, HERE, sheet, at(np.nextafter(1.0, 2.0), 0.0, 0.0))
    assert not collide(sheet, HERE, sheet, at(0.0, 0.0, 1e-300))


# Thin, tiny, huge, far


def test_slivers_agree_with_whole_numbers() -> None:
    rng = np.random.default_rng(2)
    hits = 0
    for _ in range(300):
        needle = rng.normal(size=(3, 3))
        needle[2] = needle[0] + (needle[1] - needle[0]) * rng.random()
        needle[2] += rng.normal(size=3) * 10.0 ** rng.uniform(-15, -3)
        blade = rng.normal(size=(3, 3)) + needle.mean(axis=0)
        try:
            a, b = Shape(needle, [[0, 1, 2]]), Shape(blade, [[0, 1, 2]])
        except ValueError:  # exactly in line
            continue
        expected = truth(a, HERE, b, HERE)
        assert collide(a, HERE, b, HERE) == expected
        assert collide(b, HERE, a, HERE) == expected
        hits += expected
    assert hits > 20


def test_plates_a_hundredth_of_a_millimeter_thick() -> None:
    plate = shape(box(1.0, 1.0, 1e-5))
    pebble, needle = shape(ball(0.1)), shape(box(1e-6, 1e-6, 1.0))
    assert verdicts(plate, pebble, at(0.2, 0.3, 0.1)) == {True}
    assert verdicts(plate, pebble, at(0.2, 0.3, 0.1001)) == {False}
    assert verdicts(plate, needle, at(0.123, 0.0456, 0.3)) == {True}
    assert verdicts(plate, needle, at(0.123, 0.0456, 0.501)) == {False}
    assert verdicts(plate, plate, at(0.1, 0.1, 1.1e-5)) == {False}
    assert verdicts(plate, plate, at(0.1, 0.1, 0.9e-5)) == {True}
    grain = shape(ball(1e-6))
    assert verdicts(plate, grain, at(0.21, 0.3, 0.0)) == {True}  # inside the plate
    assert verdicts(plate, grain, at(0.21, 0.3, 7e-6)) == {False}


@pytest.mark.parametrize("exponent", range(-5, 5))
def test_bodies_of_every_size(exponent: int) -> None:
    unit = 10.0**exponent
    a, b = shape(scaled(angle_iron(), unit)), shape(scaled(box(0.3), unit))
    for seed in range(5):
        place = somewhere(np.random.default_rng(seed), 3.0 * unit)
        for x, expected in ((1.15 - 2e-9, True), (1.15 + 2e-9, False)):  # beside the end of an arm
            pose = place @ at(x * unit, 0.1 * unit, 0.5 * unit)
            assert collide(a, place, b, pose) == expected
        assert not collide(a, place, b, place @ at(*np.full(3, 0.6 * unit)))


@pytest.mark.parametrize("large", [1e1, 1e3, 1e4])
def test_a_tiny_body_beside_a_huge_one(large: float) -> None:
    hall, grain = shape(box(large)), shape(box(1e-5))
    for x, expected in ((-0.25e-5, True), (0.25e-5, True), (0.75e-5, False)):
        assert collide(hall, HERE, grain, at(large / 2 + x, 0.1, 0.2)) == expected
    assert collide(hall, HERE, grain, at(0.1, 0.2, 0.3))  # in the middle
    wall = shape(together(box(large), inverted(box(large * 0.9))))
    assert not collide(wall, HERE, grain, at(0.1, 0.2, 0.3))


def test_poses_a_thousand_kilometers_away() -> None:
    """Results for the given doubles, computed in integers: at 1e6 m a double resolves 1e-10 m."""
    a, b = shape(box(1.0)), shape(angle_iron(0.5, 0.1, 0.3))
    hits = 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        place = somewhere(rng)
        place[:3, 3] = rng.choice([-1e6, 1e6], size=3)
        apart = somewhere(rng, 0.5)
        expected = truth(a, place, b, place @ apart)
        assert collide(a, place, b, place @ apart) == expected
        hits += expected
    assert 10 < hits < 50


@pytest.mark.parametrize("overlap", [2e-9, -2e-9])
def test_a_nanometer_of_overlap_far_away(overlap: float) -> None:
    cube = shape(box(1.0))
    for axis, sign in itertools.product(range(3), (-1, 1)):
        place = at(1e6, -1e6, 1e6)
        pose = place.copy()
        pose[axis, 3] += sign * (1.0 - overlap)
        assert collide(cube, place, cube, pose) == (overlap > 0)


@pytest.mark.parametrize("depth", [1e-9, 3e-9, 1e-8, 1e-6])
def test_overlaps_of_a_billionth_of_the_size_are_seen(depth: float) -> None:
    """Faces, edges and corners that penetrate by `depth`, or are separated by it, at any place."""
    cube = shape(box(1.0))
    turned = at()
    turned[:3, :3] = np.array([[1, -1, 0], [1, 1, 0], [0, 0, math.sqrt(2)]]) / math.sqrt(2)
    to_edge = 0.5 + math.sqrt(0.5)
    for seed in range(40):
        place = somewhere(np.random.default_rng(seed))
        for sign, expected in ((1.0, True), (-1.0, False)):
            gap = sign * 1.5 * depth
            face = place @ at(1.0 - gap, 0.3, 0.2)
            edge = place @ (at(to_edge - gap, 0.3, 0.2) @ turned)
            assert collide(cube, place, cube, face) == expected
            assert collide(cube, place, cube, edge) == expected


def test_a_ball_clamped_in_a_slot_is_free_by_a_hair() -> None:
    slot = shape(together(moved(box(1.0), x=-1.0), moved(box(1.0), x=1.0)))
    round_ = ball(0.5)
    width = np.ptp(round_[0][:, 0])
    snug = shape(scaled(round_, (1.0 - 4e-9) / width))
    tight = shape(scaled(round_, (1.0 + 4e-9) / width))
    assert verdicts(slot, snug, HERE) == {False}
    assert verdicts(slot, tight, HERE) == {True}


# Beyond the range of floats and of their squares; found by fuzzing


@pytest.mark.parametrize("size", [1e9, 1e14])
def test_faces_as_large_as_the_limit_collide(size: float) -> None:
    """Or the mesh raises an error."""
    corners = size * np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
    try:
        wall, tray = Shape(corners, [[0, 1, 2]]), shape(opened(box(size)))
    except ValueError:
        return
    rng = np.random.default_rng(0)
    for _ in range(20):
        place = somewhere(rng)
        assert collide(wall, HERE, tray, place)
        assert collide(tray, place, wall, HERE)


@pytest.mark.parametrize("far", [1e9, 1.1e15, 1e20, 1e150])
def test_distances_of_what_is_very_far_are_finite(far: float) -> None:
    """Or the pose raises an error."""
    cube = shape(box(1.0))
    try:
        gap = distance(cube, HERE, cube, at(far))
    except ValueError:
        return
    assert gap == pytest.approx(far)
    assert collide(cube, HERE, cube, at(far), margin=2 * far)


@pytest.mark.parametrize("width", [1e-170, 5e-324])
def test_a_needle_too_thin_for_a_normal_counts_as_flat(width: float) -> None:
    """Regression: its boxes had no axes, and most of its contacts were missed."""
    needle = [[0.0, 0, 0], [0, 0, width], [0.0, 1, -4]]
    with pytest.raises(ValueError, match="zero area"):
        Shape(needle, [[0, 2, 1]])
    vertices, faces = box(1.0)
    crate = Shape(np.vstack([vertices, needle]), np.vstack([faces, [[8, 10, 9]]]))
    assert crate.repairs["degenerate_faces"] == 1

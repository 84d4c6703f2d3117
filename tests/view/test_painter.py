"""The painter against its oracle and against analytic results."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from oracles.shader import render
from support import TESTS

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.view import Camera, Floor, Light, Mark, Painter, Solid
from fgenv.view.figures.palette import (
    BLACK,
    BLUE,
    ORANGE,
    STEEL,
    VERMILION,
    WHITE,
    to_linear,
    to_srgb,
)

pytestmark = pytest.mark.native

Bytes = NDArray[np.uint8]
FRONT = Camera(eye=(0.0, -4.0, 0.0), target=(0.0, 0.0, 0.0), fov=0.6, width=201, height=161)
ABOVE = Camera((0.01, 0.0, 9.0), (0.0, 0.0, 0.0), 0.6, 200, 200)
SUN = Light(to=(0.0, -0.6, 0.8), sun=0.5, above=(0.2, 0.2, 0.2), below=(0.1, 0.1, 0.1))
PLAIN = Floor(color=WHITE, grid=1e9, fade=1e9)
ON_PLAIN = 0.7  # brightness: all visible points are on one grid line
HERE = np.eye(4)[None]


def shape(mesh: trimesh.Trimesh) -> Shape:
    return Shape(mesh.vertices, mesh.faces)


def ball(radius: float = 1.0) -> Shape:
    return shape(trimesh.creation.icosphere(subdivisions=4, radius=radius))


def at(x: float, y: float, z: float, turn: float = 0.0) -> Floats:
    pose = trimesh.transformations.rotation_matrix(turn, (1, 2, 3))
    pose[:3, 3] = x, y, z
    return np.asarray(pose)


def scene() -> tuple[list[Shape], list[tuple[float, float, float]], Floats]:
    """Round and sharp bodies that hide and shade each other, two of one shape."""
    ring = shape(trimesh.creation.annulus(0.3, 0.5, 0.4))
    shapes = [ring, ring, ball(0.4), shape(trimesh.creation.box((3.0, 0.1, 0.8)))]
    poses = [at(-0.8, 0, 0.4, 0.5), at(0.6, -0.3, 0.5, 1.0), at(0, 0.5, 0.4), at(0.2, 1.5, 0.4)]
    return shapes, [ORANGE, BLUE, VERMILION, STEEL], np.array(poses)


def digest() -> str:
    """Hash of a small picture with all kinds of elements, at any number of threads."""
    shapes, colors, poses = scene()
    opacities = [1.0, 0.4, 1.0, 1.0]
    floor = Floor(fade=6.0)
    painter = Painter(shapes, colors, opacities=opacities, floor=floor, width=150, height=101)
    marks = [Mark(0.3, -0.6, 0.5, BLUE)]
    pictures = [painter.paint(poses, marks, threads=t) for t in (1, 2, 3)]
    assert all(np.array_equal(pictures[0], picture) for picture in pictures)
    return hashlib.sha256(pictures[0].tobytes()).hexdigest()


def bytes_of(linear: Any) -> Floats:
    return np.asarray(to_srgb(linear) * 255)


# Against the oracle ------------------------------------------------------------------------------


@pytest.mark.parametrize("floor", [Floor(fade=6.0), Floor(height=-0.3, grid=0.25), None])
@pytest.mark.parametrize("eye", [(2.0, -4.0, 3.0), (-1.0, -3.0, 0.5), (0.3, -3.0, -0.5)])
def test_pictures_equal_those_of_the_oracle(
    floor: Floor | None, eye: tuple[float, float, float]
) -> None:
    shapes, colors, poses = scene()
    camera = Camera(eye, (0.0, 0.3, 0.3), 0.8, 160, 120)
    solids = [Solid(s, T, c) for s, T, c in zip(shapes, poses, colors, strict=True)]
    truth, _ = render(camera, solids, floor=floor)
    seen = Painter(shapes, colors, camera, floor=floor, samples=1).paint(poses)
    off = np.abs(bytes_of(truth) - seen).max(axis=2)
    assert (off > 1.0).mean() < 0.002  # a shadow's edge on a mesh is ragged
    smooth, _ = render(camera, solids, floor=floor, samples=3)
    fine = Painter(shapes, colors, camera, floor=floor, samples=3).paint(poses)
    off = np.abs(bytes_of(smooth) - fine).max(axis=2)
    assert (off > 1.0).mean() < 0.02  # rays are cast only on the side of an edge
    assert off.max() < 60.0
    assert (fine != seen).any()


def test_translucent_bodies_are_blended_like_those_of_the_oracle() -> None:
    shapes, colors, poses = scene()
    opacities, floor = [1.0, 0.4, 0.7, 1.0], Floor(fade=6.0)
    camera = Camera((2.0, -4.0, 3.0), (0.0, 0.3, 0.3), 0.8, 160, 120)
    bodies = zip(shapes, poses, colors, opacities, strict=True)
    truth, depths = render(camera, [Solid(*body) for body in bodies], floor=floor)
    painter = Painter(shapes, colors, camera, opacities=opacities, floor=floor, samples=1)
    seen, depth = painter.paint_with_depth(poses)
    off = np.abs(bytes_of(truth) - seen).max(axis=2)
    assert (off > 1.0).mean() < 0.002
    np.testing.assert_array_equal(np.isinf(depth), np.isinf(depths))
    sky = np.isinf(depths)
    np.testing.assert_allclose(depth[~sky], depths[~sky], rtol=1e-6)
    np.testing.assert_array_equal(seen, painter.paint(poses))


def test_an_opacity_is_over_0_at_most_1() -> None:
    for opacities, message in (([0.0], r"opacities\[0\]: got 0"), ([1.0, 1.0], "opacities: got 2")):
        with pytest.raises(ValueError, match=message):
            Painter([ball()], [WHITE], opacities=opacities)


def test_flat_faces_have_one_color_each() -> None:
    box = shape(trimesh.creation.box((1.0, 1.0, 1.0)))
    poses = at(0, 0, 0, 0.7)[None]
    pictures = [
        Painter([box], [ORANGE], FRONT, floor=None, samples=1, smooth=s).paint(poses)
        for s in (0.0, 0.6)
    ]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    flat = Painter([ball()], [ORANGE], FRONT, floor=None, samples=1, smooth=0.0).paint(HERE)
    round_ = Painter([ball()], [ORANGE], FRONT, floor=None, samples=1).paint(HERE)
    assert len(np.unique(flat.reshape(-1, 3), axis=0)) < len(
        np.unique(round_.reshape(-1, 3), axis=0)
    )


# Analytic ----------------------------------------------------------------------------------------


def test_the_middle_of_a_sphere_is_lambert_and_sky() -> None:
    seen = Painter([ball()], [WHITE], FRONT, floor=None, light=SUN).paint(HERE)
    truth = 0.5 * (0.2 + 0.1) + 0.5 * 0.6  # it faces the eye: half the sky, and 0.6 of the sun
    np.testing.assert_allclose(seen[80, 100], bytes_of([truth] * 3), atol=1.5)
    radius = np.tan(np.arcsin(1 / 4)) * FRONT.pixels_per_slope
    sky = Painter([], [], FRONT, floor=None, light=SUN).paint(HERE[:0])
    assert (seen != sky).any(axis=2)[80].sum() == pytest.approx(2 * radius, abs=3)


def test_a_shadow_is_opposite_the_sun() -> None:
    plate = shape(trimesh.creation.box((1.0, 1.0, 0.002)))
    seen = Painter([plate], [BLACK], ABOVE, floor=PLAIN, light=SUN).paint(at(0, 0, 1.0)[None])
    # One up, 0.6 / 0.8 away from the sun; only the part that the plate does not cover.
    spots, _ = ABOVE.project([(0.0, 1.15, 0.0), (0.4, 1.2, 0.0), (0.0, -0.9, 0.0), (0.0, 1.35, 0)])
    shade, sunny = (bytes_of([ON_PLAIN * light] * 3) for light in (0.2, 0.2 + 0.5 * 0.8))
    for (x, y), expected in zip(spots, [shade, shade, sunny, sunny], strict=True):
        np.testing.assert_allclose(seen[int(y), int(x)], expected, atol=1)


def test_marks_are_rings_on_the_floor_below_bodies() -> None:
    cube = shape(trimesh.creation.box((0.4, 0.4, 0.01)))
    painter = Painter([cube], [BLACK], ABOVE, floor=PLAIN, light=SUN)
    bare, marked = (painter.paint(HERE, marks) for marks in ([], [Mark(0.5, 0.0, 1.0, BLUE)]))
    rays = ABOVE.rays(ABOVE.pixel_middles())
    points = ABOVE.eye - rays * (9.0 / rays[..., 2:])
    far = np.hypot(points[..., 0] - 0.5, points[..., 1])
    changed = (bare != marked).any(axis=2)
    assert not changed[far > 1.05].any()
    assert not changed[np.abs(points[..., :2]).max(axis=2) < 0.18].any()  # the cube
    light = 0.2 + 0.5 * 0.8
    ring = bytes_of(light * (0.1 * ON_PLAIN + 0.9 * to_linear(BLUE)))
    disc = bytes_of(light * (0.75 * ON_PLAIN + 0.25 * to_linear(BLUE)))
    np.testing.assert_allclose(marked[np.abs(far - 0.93) < 0.03].mean(axis=0), ring, atol=2)
    np.testing.assert_allclose(marked[np.abs(far - 0.75) < 0.03].mean(axis=0), disc, atol=2)


def test_bodies_behind_the_eye_are_invisible() -> None:
    empty = Painter([], [], FRONT).paint(HERE[:0])
    assert empty.shape == (161, 201, 3)
    assert empty.dtype == np.uint8
    behind = Painter([ball()], [BLACK], FRONT).paint(at(0, -9, 5.0)[None])
    np.testing.assert_array_equal(behind[:80], empty[:80])
    inside = Painter([ball(9.0)], [WHITE], FRONT, floor=None).paint(HERE)
    assert len(np.unique(inside.reshape(-1, 3), axis=0)) > 50  # from inside


def test_a_body_that_extends_behind_the_eye_is_visible() -> None:
    beam = shape(trimesh.creation.box((0.5, 40.0, 0.5)))
    pose = at(0.0, 0.0, -0.6)[None]
    camera = Camera((0.0, -4.0, 0.0), (0.0, 0.0, -0.2), 0.8, 160, 120)
    truth, _ = render(camera, [Solid(beam, pose[0], ORANGE)])
    seen = Painter([beam], [ORANGE], camera, floor=None, samples=1).paint(pose)
    assert (np.abs(bytes_of(truth) - seen).max(axis=2) > 1.0).mean() < 0.001


def test_the_overview_sees_the_whole_first_picture_and_stays() -> None:
    shapes, colors, poses = scene()
    painter = Painter(shapes, colors, width=120, height=90)
    first = painter.paint(poses, [Mark(3.0, 0.0, 0.5, BLUE)])
    assert first.shape == (90, 120, 3)
    camera = painter.camera
    assert camera is not None
    points = np.concatenate(
        [s.vertices @ T[:3, :3].T + T[:3, 3] for s, T in zip(shapes, poses, strict=True)]
    )
    pixels, depth = camera.project(np.concatenate([points, [(3.5, 0.5, 0.0)]]))
    assert ((pixels > 0) & (pixels < (120, 90))).all()
    assert (depth > 0).all()
    painter.paint(poses + at(9.0, 0.0, 0.0) - np.eye(4))
    assert painter.camera is camera
    assert Painter([], [], width=30, height=20).paint(HERE[:0]).shape == (20, 30, 3)


def test_a_floor_extends_to_the_target_of_a_far_camera() -> None:
    far = Camera((0.0, -200.0, 100.0), (0.0, 0.0, 0.0), 0.6, 40, 30)
    near = Camera((0.0, -4.0, 2.0), (0.0, 0.0, 0.0), 0.6, 40, 30)
    plain = Floor(color=BLACK)
    there, here = (Painter([], [], c, floor=plain).paint(HERE[:0]) for c in (far, near))
    assert (here[15] < 40).all()
    assert (there[15] < 130).all()
    explicit = Painter([], [], far, floor=Floor(color=BLACK, fade=41.0)).paint(HERE[:0])
    assert (explicit[15] > 200).all()


# The same everywhere -----------------------------------------------------------------------------


@pytest.mark.unsanitized
@pytest.mark.parametrize("isa", sorted({"baseline", _core.isa()}))
def test_pictures_do_not_depend_on_the_instruction_set(isa: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", "from view.test_painter import digest; print(digest())"],
        capture_output=True,
        text=True,
        env={**os.environ, "FGENV_ISA": isa, "PYTHONPATH": str(TESTS)},
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == digest()


# Errors ---------------------------------------------------------------------------

BAD_POSES: dict[str, tuple[Any, str]] = {
    "one": (np.eye(4), r"poses: got shape \(4, 4\), expected \(1, 4, 4\)"),
    "two": (np.tile(np.eye(4), (2, 1, 1)), r"poses: got shape \(2, 4, 4\), expected \(1, 4, 4\)"),
    "positions": (np.zeros((1, 3)), "poses"),
    "NaN": (np.where(HERE == 1, np.nan, HERE), r"poses\[0\]: got an entry that is not finite"),
    "scaled": (HERE * (2, 2, 2, 1), r"poses\[0\]: got a scaled"),
}


@pytest.mark.parametrize("camera", [FRONT, None])
@pytest.mark.parametrize("bad", BAD_POSES)
def test_bad_poses_are_errors(bad: str, camera: Camera | None) -> None:
    poses, message = BAD_POSES[bad]
    with pytest.raises(ValueError, match=message):
        Painter([ball()], [WHITE], camera).paint(poses)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"colors": []}, "colors: got 0, expected 1"),
        ({"colors": [(1.0, 2.0, 0.0)]}, "colors: got a color with 2.0"),
        ({"colors": [(np.nan, 0.0, 0.0)]}, "colors: got a color with nan"),
        ({"colors": [(1.0, 0.0)]}, "colors: got 2 numbers"),
        ({"width": 0}, "width"),
        ({"height": -3}, "height"),
        ({"samples": 0}, "samples: got 0, expected 1"),
        ({"samples": 1000}, "samples: got 1000"),
        ({"floor": Floor(grid=0.0)}, "floor: grid"),
        ({"floor": Floor(fade=np.nan)}, "floor: fade"),
        ({"floor": Floor(height=np.inf)}, "floor: got height"),
        ({"light": Light(to=(0.0, np.nan, 0.0))}, "sun"),
        ({"camera": Camera((1e13, 0.0, 0.0), (0.0, 0.0, 0.0))}, "eye"),
        ({"camera": Camera(FRONT.eye, FRONT.target, width=10**9)}, "width, height: got 1000000000"),
    ],
)
def test_bad_settings_are_errors(change: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {"shapes": [ball()], "colors": [WHITE]}
    with pytest.raises(ValueError, match=message):
        Painter(**{**good, **change}).paint(HERE)


def test_other_types_than_shapes_are_errors() -> None:
    with pytest.raises(TypeError, match=r"shapes\[0\]: got int, expected a Shape"):
        Painter([3], [WHITE])  # type: ignore[list-item]


@pytest.mark.parametrize(
    ("mark", "message"),
    [
        (Mark(0.0, 0.0, 0.0, BLUE), r"marks\[0\]: got radius 0"),
        (Mark(np.nan, 0.0, 1.0, BLUE), r"marks\[0\]: got nan"),
        (Mark(0.0, 0.0, 1.0, (9.0, 0.0, 0.0)), "marks: got a color with 9.0"),
    ],
)
def test_bad_marks_are_errors(mark: Mark, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Painter([], [], FRONT).paint(HERE[:0], [mark])
    with pytest.raises(ValueError, match="without floor"):
        Painter([], [], FRONT, floor=None).paint(HERE[:0], [mark])

"""The oracle of the painter against analytic results."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from oracles.shader import render

from fgenv.collision import Shape
from fgenv.view import Camera, Floor, Light, Solid
from fgenv.view.figures.palette import ORANGE, WHITE

FRONT = Camera(eye=(0.0, -4.0, 0.0), target=(0.0, 0.0, 0.0), fov=0.6, width=200, height=160)
SUN = Light(to=(0.0, -0.6, 0.8), sun=0.5, above=(0.2, 0.2, 0.2), below=(0.1, 0.1, 0.1))


def ball(radius: float = 1.0, opacity: float = 1.0) -> Solid:
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    return Solid(Shape(mesh.vertices, mesh.faces), np.eye(4), WHITE, opacity)


def plate(size: float, height: float) -> Solid:
    mesh, pose = trimesh.creation.box((size, size, 0.002)), np.eye(4)
    pose[2, 3] = height
    return Solid(Shape(mesh.vertices, mesh.faces), pose, WHITE)


def test_silhouette_and_depth_of_a_sphere() -> None:
    _, depth = render(FRONT, [ball()])
    radius = np.tan(np.arcsin(1 / 4)) * FRONT.pixels_per_slope
    area = np.isfinite(depth).sum()
    assert area == pytest.approx(np.pi * radius**2, rel=0.01)
    rays = FRONT.rays(FRONT.pixel_middles())
    along = -rays @ np.array(FRONT.eye)
    root = along**2 - (16 - 1)
    inside = root > 0.05
    truth = (along - np.sqrt(np.where(inside, root, 0.0))) * rays[..., 1]
    np.testing.assert_allclose(depth[inside], truth[inside], atol=0.01)


def test_light_on_a_sphere_is_lambert_and_sky() -> None:
    color, depth = render(FRONT, [ball()], light=SUN)
    points = (
        np.array(FRONT.eye)
        + FRONT.rays(FRONT.pixel_middles())
        * (depth / FRONT.rays(FRONT.pixel_middles())[..., 1])[..., None]
    )
    seen = np.isfinite(depth)
    normals = points[seen] / np.linalg.norm(points[seen], axis=-1, keepdims=True)
    slope = normals @ SUN.direction
    up = 0.5 + 0.5 * normals[:, 2]
    truth = 0.2 * up + 0.1 * (1 - up) + 0.5 * np.maximum(slope, 0)
    off = np.abs(color[seen, 0] - truth)[
        np.abs(slope) > 0.1
    ]  # the edge of a shadow on a mesh is ragged
    assert off.max() < 0.02


def test_shadow_of_a_plate_is_opposite_the_sun() -> None:
    above = Camera((0.01, 0.0, 9.0), (0.0, 0.0, 0.0), 0.6, 200, 200)
    floor = Floor(color=WHITE, grid=1e9, fade=1e9)
    lit, _ = render(above, [], floor=floor, light=SUN)
    shaded, depth = render(above, [plate(1.0, 1.0)], floor=floor, light=SUN)
    rays = above.rays(above.pixel_middles())
    points = np.array(above.eye) + rays * (depth / (rays @ above.axes[2]))[..., None]
    on_floor = points[..., 2] < 0.5
    x, y = points[..., 0], points[..., 1] - 0.75  # one up, 0.6 / 0.8 away from the sun
    inside = np.minimum(0.5 - np.abs(x), 0.5 - np.abs(y))
    dark = shaded[..., 0] < 0.9 * lit[..., 0]
    assert dark[on_floor & (inside > 0.01)].all()
    assert not dark[on_floor & (inside < -0.01)].any()
    none, _ = render(above, [plate(1.0, 1.0)], floor=floor, light=SUN, shadows=False)
    np.testing.assert_allclose(none[on_floor], lit[on_floor])


def test_the_floor_has_the_depth_of_a_plane() -> None:
    camera = Camera((0.0, 0.0, 2.0), (5.0, 0.0, 0.0))
    _, depth = render(camera, [], floor=Floor())
    rays = camera.rays(camera.pixel_middles())
    truth = 2.0 / -rays[..., 2] * (rays @ camera.axes[2])
    seen = np.isfinite(depth)
    np.testing.assert_allclose(depth[seen], truth[seen])
    assert seen[rays[..., 2] < -0.1].all()
    assert not seen[rays[..., 2] >= 0].any()


def test_a_translucent_solid_is_blended_and_casts_no_shadow() -> None:
    floor = Floor(height=-1.0)
    without, floor_depth = render(FRONT, [], floor=floor)
    blended, depth = render(FRONT, [ball(0.5, opacity=0.25)], floor=floor)
    solid, _ = render(FRONT, [ball(0.5)], floor=floor, shadows=False)
    np.testing.assert_array_equal(depth, floor_depth)
    np.testing.assert_allclose(blended, 0.75 * without + 0.25 * solid, atol=1e-12)


def test_solids_are_rendered_at_their_poses() -> None:
    turn = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))
    turn[:3, 3] = 0.3, 0.5, -0.2
    mesh = trimesh.creation.torus(0.5, 0.2)
    moved = mesh.copy().apply_transform(turn)
    a = Solid(Shape(mesh.vertices, mesh.faces), turn, ORANGE)
    b = Solid(Shape(moved.vertices, moved.faces), np.eye(4), ORANGE)
    (color_a, depth_a), (color_b, depth_b) = render(FRONT, [a]), render(FRONT, [b])
    same = np.isclose(depth_a, depth_b, atol=1e-9)
    assert same.mean() > 0.999
    assert np.isclose(color_a, color_b, atol=1e-6).mean() > 0.995


def test_samples_smooth_only_edges() -> None:
    rough, depth = render(FRONT, [ball()], samples=1)
    smooth, same_depth = render(FRONT, [ball()], samples=4)
    np.testing.assert_array_equal(depth, same_depth)
    changed = np.abs(rough - smooth).max(axis=2) > 0.05
    assert 0.002 < changed.mean() < 0.05
    with pytest.raises(ValueError, match="samples"):
        render(FRONT, [], samples=0)

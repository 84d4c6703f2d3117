"""The shader against pictures that are known on paper."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from PIL import Image

from fgenv.collision import Shape
from fgenv.view import Camera, Floor, Light, Picture, Solid, render
from fgenv.view.figures.layout import beside, captioned
from fgenv.view.figures.normals import corner_normals, normal_maps
from fgenv.view.figures.palette import BLACK, ORANGE, VERMILION, WHITE, to_linear, to_srgb

FRONT = Camera(eye=(0.0, -4.0, 0.0), target=(0.0, 0.0, 0.0), fov=0.6, width=200, height=160)
SUN = Light(to=(0.0, -0.6, 0.8), sun=0.5, above=(0.2, 0.2, 0.2), below=(0.1, 0.1, 0.1))


def ball(radius: float = 1.0, opacity: float = 1.0) -> Solid:
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    return Solid(Shape(mesh.vertices, mesh.faces), np.eye(4), WHITE, opacity)


def plate(size: float, height: float) -> Solid:
    mesh, pose = trimesh.creation.box((size, size, 0.002)), np.eye(4)
    pose[2, 3] = height
    return Solid(Shape(mesh.vertices, mesh.faces), pose, WHITE)


# The camera --------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_projection_undoes_the_rays(seed: int) -> None:
    rng = np.random.default_rng(seed)
    camera = Camera(tuple(rng.normal(size=3)), tuple(rng.normal(size=3)), rng.uniform(0.2, 2.0))
    pixels = rng.uniform((0, 0), (camera.width, camera.height), size=(100, 2))
    points = camera.eye + camera.rays(pixels) * rng.uniform(1, 9, size=(100, 1))
    back, depth = camera.project(points)
    np.testing.assert_allclose(back, pixels, atol=1e-8)
    assert (depth > 0).all()


def test_axes_are_a_right_handed_frame_with_up_on_top() -> None:
    right, down, ahead = Camera((1.0, 2.0, 3.0), (4.0, 4.0, 0.0)).axes
    np.testing.assert_allclose(np.cross(right, down), ahead, atol=1e-12)
    assert down[2] < 0
    assert right[2] == pytest.approx(0.0, abs=1e-12)
    pixels, _ = FRONT.project([(0, 0, 0), (0.5, 0, 0), (0, 0, 0.5)])
    np.testing.assert_allclose(pixels[0], (100, 80))
    assert pixels[1, 0] > 100  # x to the right, seen from -y
    assert pixels[2, 1] < 80  # z up


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"target": (0.0, -4.0, 9.0)}, "straight above"),
        ({"fov": 0.0}, "fov"),
        ({"width": 0}, "width"),
        ({"eye": (0.0, np.nan, 0.0)}, "eye"),
    ],
)
def test_cameras_that_see_nothing_are_errors(change: dict[str, object], message: str) -> None:
    good: dict[str, object] = {"eye": (0.0, -4.0, 0.0), "target": (0.0, 0.0, 0.0)}
    with pytest.raises(ValueError, match=message):
        Camera(**{**good, **change})  # type: ignore[arg-type]


# Surfaces ----------------------------------------------------------------------------------------


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
    off = np.abs(color[seen, 0] - truth)[np.abs(slope) > 0.1]  # a mesh's shadow edge is ragged
    assert off.max() < 0.02


def test_shadow_of_a_plate_lies_where_the_sun_puts_it() -> None:
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


def test_a_ghost_is_seen_through_and_throws_no_shadow() -> None:
    floor = Floor(height=-1.0)
    without, floor_depth = render(FRONT, [], floor=floor)
    with_ghost, depth = render(FRONT, [ball(0.5, opacity=0.25)], floor=floor)
    solid, _ = render(FRONT, [ball(0.5)], floor=floor, shadows=False)
    np.testing.assert_array_equal(depth, floor_depth)
    np.testing.assert_allclose(with_ghost, 0.75 * without + 0.25 * solid, atol=1e-12)


def test_moved_solids_are_where_their_pose_says() -> None:
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


def test_samples_smooth_the_edges_and_nothing_else() -> None:
    rough, depth = render(FRONT, [ball()], samples=1)
    smooth, same_depth = render(FRONT, [ball()], samples=4)
    np.testing.assert_array_equal(depth, same_depth)
    changed = np.abs(rough - smooth).max(axis=2) > 0.05
    assert 0.002 < changed.mean() < 0.05
    with pytest.raises(ValueError, match="samples"):
        render(FRONT, [], samples=0)


def test_same_picture_for_any_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    pictures = []
    for threads in ("1", "3"):
        monkeypatch.setenv("FGENV_THREADS", threads)
        pictures.append(Picture(FRONT, [ball(), plate(2.0, -1.0)], floor=Floor(-1.5)).pixels())
    np.testing.assert_array_equal(*pictures)


# Normals and colors -----------------------------------------------------------------------------


def test_normals_of_a_box_are_its_sides_and_of_a_ball_its_radii() -> None:
    box = trimesh.creation.box((1, 2, 3))
    sharp = corner_normals(box.vertices, box.faces, 0.6)
    np.testing.assert_allclose(sharp, np.repeat(box.face_normals[:, None], 3, axis=1), atol=1e-12)
    mesh = trimesh.creation.icosphere(subdivisions=3)
    smooth = corner_normals(mesh.vertices, mesh.faces, 0.6)
    assert np.einsum("mki,mki->mk", smooth, mesh.vertices[mesh.faces]).min() > 0.999


def test_normal_maps_meet_the_corner_normals_at_the_corners() -> None:
    mesh = trimesh.creation.torus(1.0, 0.3)
    corners = mesh.vertices[mesh.faces]
    maps = normal_maps(mesh.vertices, mesh.faces, 0.6)
    at_corners = np.einsum("mij,mkj->mki", maps[:, :, :3], corners) + maps[:, None, :, 3]
    truth = corner_normals(mesh.vertices, mesh.faces, 0.6)
    np.testing.assert_allclose(at_corners, truth, atol=1e-9)


def test_srgb_there_and_back() -> None:
    values = np.linspace(0, 1, 101)
    np.testing.assert_allclose(to_srgb(to_linear(values)), values, atol=1e-6)


# What is drawn over ------------------------------------------------------------------------------


def drawn(picture: Picture) -> NDArray[np.bool_]:
    """Pixels that are nearly vermilion."""
    return np.abs(picture.pixels() - 255.0 * np.array(VERMILION)).max(axis=2) < 40


def test_lines_behind_a_solid_are_hidden() -> None:
    across = [[(-3.0, 2.0, 0.0), (3.0, 2.0, 0.0)]]  # behind the ball, seen beside it
    rows, columns = FRONT.height, FRONT.width
    for hidden, seen_inside in ((0.0, False), (1.0, True)):
        picture = Picture(FRONT, [ball()])
        picture.segments(across, VERMILION, width=3, hidden=hidden)
        line = drawn(picture)[rows // 2]
        assert line[:20].all()
        assert line[-20:].all()
        assert bool(line[columns // 2 - 20 : columns // 2 + 20].all()) is seen_inside
        assert bool(line[columns // 2 - 20 : columns // 2 + 20].any()) is seen_inside


def test_lines_on_and_before_a_solid_are_seen() -> None:
    picture = Picture(FRONT, [ball()])
    picture.segments([[(-0.5, -1.2, 0.0), (0.5, -1.2, 0.0)]], VERMILION, width=3)
    ends, _ = FRONT.project([(-0.5, -1.2, 0.0), (0.5, -1.2, 0.0)])
    assert drawn(picture)[80, int(ends[0, 0]) + 1 : int(ends[1, 0]) - 1].all()


def test_a_line_that_runs_past_the_eye_is_cut() -> None:
    picture = Picture(FRONT, [])
    picture.segments([[(0.3, -9.0, 0.0), (0.3, 5.0, 0.0)]], VERMILION, width=3)
    line = drawn(picture)[80]
    assert line[115:].all()  # from where it points to, to the picture's right border
    assert not line[:100].any()
    behind = Picture(FRONT, [])
    behind.segments([[(0.0, -9.0, 0.0), (1.0, -5.0, 0.0)]], VERMILION, width=3)
    assert not drawn(behind).any()


def test_points_are_discs() -> None:
    picture = Picture(FRONT, [ball()])
    picture.points([(0, -1, 0), (0, 1, 0), (0, -9, 0)], VERMILION, radius=6)  # seen, hidden, behind
    assert drawn(picture).sum() == pytest.approx(np.pi * 36, rel=0.15)


def test_labels_are_written_and_pictures_saved(tmp_path: object) -> None:
    plain, marked = Picture(FRONT, []), Picture(FRONT, [])
    marked.label((0, 0, 0), "tank 2", color=BLACK)
    marked.label((0, -9, 0), "behind")
    changed = (plain.pixels() != marked.pixels()).any(axis=2)
    rows, columns = np.nonzero(changed)
    assert 5 < np.ptp(rows) < 25
    assert 30 < np.ptp(columns) < 80
    assert columns.mean() == pytest.approx(100, abs=4)
    path = f"{tmp_path}/label.png"
    marked.save(path)
    np.testing.assert_array_equal(np.asarray(Image.open(path)), marked.pixels())


def test_a_page_has_its_pictures_and_a_caption() -> None:
    red, blue = Image.new("RGB", (30, 20), (255, 0, 0)), Image.new("RGB", (40, 20), (0, 0, 255))
    page = captioned(beside([red, blue]), "Figure", "text")
    assert page.size[0] == 30 + 12 + 40
    assert page.getpixel((5, 5)) == (255, 0, 0)
    assert page.getpixel((60, 5)) == (0, 0, 255)
    assert np.asarray(page)[20:].min() < 100

"""Pictures: lines, points and labels over a painted scene."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from PIL import Image

from fgenv.arrays import Flags
from fgenv.collision import Shape
from fgenv.view import Camera, Floor, Picture, Solid
from fgenv.view.figures.layout import beside, captioned
from fgenv.view.figures.palette import BLACK, VERMILION, WHITE

FRONT = Camera(eye=(0.0, -4.0, 0.0), target=(0.0, 0.0, 0.0), fov=0.6, width=200, height=160)


def ball(radius: float = 1.0, opacity: float = 1.0) -> Solid:
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    return Solid(Shape(mesh.vertices, mesh.faces), np.eye(4), WHITE, opacity)


def plate(size: float, height: float) -> Solid:
    mesh, pose = trimesh.creation.box((size, size, 0.002)), np.eye(4)
    pose[2, 3] = height
    return Solid(Shape(mesh.vertices, mesh.faces), pose, WHITE)


def test_same_picture_for_any_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    pictures = []
    for threads in ("1", "3"):
        monkeypatch.setenv("FGENV_THREADS", threads)
        pictures.append(Picture(FRONT, [ball(), plate(2.0, -1.0)], floor=Floor(-1.5)).pixels())
    np.testing.assert_array_equal(pictures[0], pictures[1])


def drawn(picture: Picture) -> Flags:
    """Return the pixels that are nearly vermilion."""
    return np.asarray(np.abs(picture.pixels() - 255.0 * np.array(VERMILION)).max(axis=2) < 40)


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


def test_lines_on_and_before_a_solid_are_visible() -> None:
    picture = Picture(FRONT, [ball()])
    picture.segments([[(-0.5, -1.2, 0.0), (0.5, -1.2, 0.0)]], VERMILION, width=3)
    ends, _ = FRONT.project([(-0.5, -1.2, 0.0), (0.5, -1.2, 0.0)])
    assert drawn(picture)[80, int(ends[0, 0]) + 1 : int(ends[1, 0]) - 1].all()


def test_a_line_that_runs_past_the_eye_is_cut() -> None:
    picture = Picture(FRONT, [])
    picture.segments([[(0.3, -9.0, 0.0), (0.3, 5.0, 0.0)]], VERMILION, width=3)
    line = drawn(picture)[80]
    assert line[115:].all()  # from its vanishing point to the right border
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


def test_a_page_has_its_pictures_and_its_caption() -> None:
    red, blue = Image.new("RGB", (30, 20), (255, 0, 0)), Image.new("RGB", (40, 20), (0, 0, 255))
    page = captioned(beside([red, blue]), "Figure", "text")
    assert page.size[0] == 30 + 12 + 40
    assert page.getpixel((5, 5)) == (255, 0, 0)
    assert page.getpixel((60, 5)) == (0, 0, 255)
    assert np.asarray(page)[20:].min() < 100

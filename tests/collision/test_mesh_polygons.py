"""Polygons of mesh files as triangles: same area, same sides, same winding."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fgenv.arrays import Faces, Floats, Ints
from fgenv.collision.mesh_files.polygons import (
    fan_faces,
    strip_faces,
    triangulated,
    triangulated_with_holes,
)

ELL = np.array([(2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 0)], dtype=float)  # area 3
COMB = np.array([(0, 0), (9, 0), (9, 5), (7, 5), (6, 1), (5, 5), (3, 5), (2, 1), (1, 5), (0, 5)])


def in_space(flat: Floats, seed: int = 0) -> Floats:
    """Points of a plane (n, 2) in a plane of space; with seed 0 in the xy plane."""
    points = np.column_stack([flat, np.zeros(len(flat))])
    if seed == 0:
        return points
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    turned: Floats = points @ (turn * np.linalg.det(turn)).T + [3.0, -2.0, 1.0]
    return turned


def area_vectors(vertices: Floats, faces: Faces) -> Floats:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    vectors: Floats = 0.5 * np.cross(b - a, c - a)
    return vectors


def shoelace(flat: Floats) -> float:
    x, y = flat.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def cut(vertices: Floats, polygon: Ints) -> tuple[Faces, int, int]:
    result = triangulated(vertices, np.array([len(polygon)]), polygon)
    assert result.polygons == 1
    return result.faces, result.nonplanar, result.crossing


def covers(vertices: Floats, polygon: Ints, faces: Faces, area: float) -> None:
    """The triangles have the polygon's area, all on its side, and each of its sides once."""
    vectors = area_vectors(vertices, faces)
    normal = vectors.sum(axis=0)
    assert np.linalg.norm(normal) == pytest.approx(area)
    assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(area)
    edges = {(int(f[k]), int(f[k - 2])) for f in faces for k in range(3)}
    sides = set(zip(polygon.tolist(), np.roll(polygon, -1).tolist(), strict=True))
    assert {(a, b) for a, b in edges if (b, a) not in edges} == sides


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("first", range(10))
@pytest.mark.parametrize("flat", [ELL, COMB.astype(float)], ids=["ell", "comb"])
def test_concave_polygons(flat: Floats, first: int, turn: int, seed: int) -> None:
    """A fan from a wrong corner would fill the notches."""
    vertices = in_space(flat, seed)
    polygon = np.roll(np.arange(len(flat)), first)[::turn]
    faces, nonplanar, crossing = cut(vertices, polygon)
    covers(vertices, polygon, faces, shoelace(flat))
    assert (nonplanar, crossing) == (0, 0)


@pytest.mark.parametrize("first", range(4))
@pytest.mark.parametrize("turn", [1, -1])
def test_a_dart_is_cut_from_its_reflex_corner(first: int, turn: int) -> None:
    dart = np.array([(0, 0), (2, 0), (0.5, 0.5), (0, 2)], dtype=float)
    vertices = in_space(dart, 3)
    polygon = np.roll(np.arange(4), first)[::turn]
    faces, nonplanar, crossing = cut(vertices, polygon)
    covers(vertices, polygon, faces, 1.0)
    assert (nonplanar, crossing) == (0, 0)


@pytest.mark.parametrize("first", range(7))
@pytest.mark.parametrize("seed", [0, 1])
def test_corners_on_a_straight_side_stay(first: int, seed: int) -> None:
    """Neighbors have them too: without them the surface would have a slit."""
    flat = np.array([(0, 0), (1, 0), (2, 0), (3, 0), (3, 2), (3, 3), (0, 3)], dtype=float)
    vertices = in_space(flat, seed)
    polygon = np.roll(np.arange(7), first)
    faces, nonplanar, crossing = cut(vertices, polygon)
    covers(vertices, polygon, faces, 9.0)
    assert (nonplanar, crossing) == (0, 0)


def test_a_polygon_that_is_a_triangle_with_extra_corners() -> None:
    flat = np.array([(0, 0), (1, 0), (2, 0), (3, 0), (2, 1), (1, 2), (0, 3), (0, 1)], dtype=float)
    vertices = in_space(flat)
    faces, _, crossing = cut(vertices, np.arange(8))
    covers(vertices, np.arange(8), faces, 4.5)
    assert crossing == 0


@given(st.data())
def test_polygons_around_a_point(data: st.DataObject) -> None:
    """Star-shaped polygons: any radii at increasing angles."""
    n = data.draw(st.integers(4, 14))
    radius = st.floats(0.2, 5.0)
    radii = np.array(data.draw(st.lists(radius, min_size=n, max_size=n)))
    angles = np.arange(n) * (2 * np.pi / n)
    flat = radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    vertices = in_space(flat, data.draw(st.integers(0, 5)))
    faces, nonplanar, crossing = cut(vertices, np.arange(n))
    covers(vertices, np.arange(n), faces, shoelace(flat))
    assert (nonplanar, crossing) == (0, 0)


def test_polygons_of_all_sizes_keep_their_order() -> None:
    """Triangles, quadrilaterals and larger polygons of one file, side by side."""
    rng = np.random.default_rng(0)
    counts = rng.integers(3, 9, size=300)
    vertices, expected = [], []
    for i, n in enumerate(counts):
        angles = np.sort(rng.uniform(0, 2 * np.pi, n))
        flat = np.column_stack([np.cos(angles), np.sin(angles)])
        vertices.append(in_space(flat) + [3.0 * i, 0, 0])
        expected.append(shoelace(flat))
    points = np.vstack(vertices)
    result = triangulated(points, counts, np.arange(counts.sum()))
    areas = np.linalg.norm(area_vectors(points, result.faces), axis=1)
    owner = np.repeat(np.arange(300), counts - 2)
    assert (np.repeat(np.arange(300), counts)[result.faces] == owner[:, None]).all()
    assert np.bincount(owner, areas) == pytest.approx(np.array(expected))
    assert result.polygons == (counts > 3).sum()


def test_nonplanar_polygons_are_counted() -> None:
    """A quadrilateral keeps the cut from its first corner; rounding to float32 is not counted."""
    bent = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0.2), (0, 1, 0)], dtype=float)
    faces, nonplanar, crossing = cut(bent, np.arange(4))
    assert faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert (nonplanar, crossing) == (1, 0)
    rounded = in_space(ELL, 2).astype(np.float32).astype(float)
    assert cut(rounded, np.arange(6))[1:] == (0, 0)


@pytest.mark.parametrize(
    "flat",
    [
        [(0, 0), (1, 1), (1, 0), (0, 1)],
        [(0, 0), (2, 2), (2, 0), (0, 1)],
        [(np.cos(a), np.sin(a)) for a in 0.8 * np.pi * np.arange(5)],
        [(0, 0), (4, 0), (4, 4), (1, -1), (0, 4)],
    ],
    ids=["bow tie", "uneven bow tie", "pentagram", "crossed"],
)
def test_crossing_polygons_are_counted(flat: list[tuple[float, float]]) -> None:
    vertices = in_space(np.array(flat, dtype=float))
    faces, _, crossing = cut(vertices, np.arange(len(flat)))
    assert crossing == 1
    assert faces.tolist() == [[0, i, i + 1] for i in range(1, len(flat) - 1)]


@pytest.mark.parametrize("polygon", [[0, 1, 2, 2], [0, 0, 1, 2], [0, 1, 1, 2, 2]])
def test_repeated_corners_add_no_area(polygon: list[int]) -> None:
    """Exporters write a triangle as a quadrilateral with one corner twice."""
    vertices = in_space(np.array([(0, 0), (2, 0), (0, 1)], dtype=float))
    faces, nonplanar, crossing = cut(vertices, np.array(polygon))
    assert np.linalg.norm(area_vectors(vertices, faces), axis=1).sum() == pytest.approx(1.0)
    assert (nonplanar, crossing) == (0, 0)


def test_a_line_is_degenerate_and_not_crossing() -> None:
    vertices = in_space(np.array([(0, 0), (1, 0), (2, 0), (3, 0), (1.5, 0)], dtype=float))
    assert cut(vertices, np.arange(5))[1:] == (0, 0)


@pytest.mark.parametrize("factor", [1e-9, 1e9])
def test_small_and_large_polygons(factor: float) -> None:
    vertices = factor * in_space(ELL, 1)
    polygon = np.arange(6)
    faces, nonplanar, crossing = cut(vertices, polygon)
    areas = np.linalg.norm(area_vectors(vertices, faces), axis=1)
    assert areas.sum() == pytest.approx(3 * factor**2)
    assert (nonplanar, crossing) == (0, 0)


def test_polygons_with_holes() -> None:
    outline = np.array([(0, 0), (9, 0), (9, 9), (0, 9)], dtype=float)
    holes = [np.array([(1, 1), (3, 1), (3, 3), (1, 3)], dtype=float) + 4 * k for k in range(2)]
    vertices = in_space(np.vstack([outline, *holes]), 1)
    rings = [np.arange(4), np.arange(4, 8), np.arange(8, 12)[::-1]]
    for turn in (1, -1):
        faces = triangulated_with_holes(vertices, [rings[0][::turn], *rings[1:]])
        vectors = area_vectors(vertices, faces)
        whole = area_vectors(vertices, fan_faces(rings[0][::turn])).sum(axis=0)
        assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(81 - 8)
        assert vectors.sum(axis=0) == pytest.approx(whole * (81 - 8) / 81)


def test_strips_turn_every_second_triangle() -> None:
    assert strip_faces(np.arange(5)).tolist() == [[0, 1, 2], [2, 1, 3], [2, 3, 4]]
    assert strip_faces(np.arange(2)).shape == (0, 3)
    assert fan_faces(np.arange(5)).tolist() == [[0, 1, 2], [0, 2, 3], [0, 3, 4]]


def test_corners_that_are_not_finite_do_not_hang() -> None:
    vertices = in_space(ELL)
    vertices[2] = np.nan
    assert len(cut(vertices, np.arange(6))[0]) == 4

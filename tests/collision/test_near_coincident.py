"""Distances of shapes whose faces nearly coincide: work grows with the size, not its square."""

from __future__ import annotations

import numpy as np
import pytest

from fgenv.arrays import Floats
from fgenv.bench.limits.run import APART, JITTER, triangle_soup
from fgenv.collision import Shape, distance

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


def soup(name: str, count: int, seed: int = 0) -> tuple[Floats, Shape]:
    vertices = triangle_soup(name, count, np.random.default_rng(seed)).reshape(-1, 3)
    return vertices, Shape(vertices, np.arange(len(vertices)).reshape(-1, 3))


@pytest.mark.parametrize("seed", range(3))
def test_copies_of_one_triangle(seed: int) -> None:
    """The least distance is that of two corners, over all pairs."""
    vertices, shape = soup("copies", 3000, seed)
    away = np.eye(4)
    away[2, 3] = APART
    found = distance(shape, np.eye(4), shape, away)
    corners = vertices.reshape(-1, 3, 3)
    # Corner k of each copy lies within the jitter of the same place.
    exact = APART + (corners[:, :, 2].min(axis=0) - corners[:, :, 2].max(axis=0)).min()
    assert exact - 1e-15 <= found <= exact + 2 * JITTER


@pytest.mark.parametrize("name", ["copies", "coplanar"])
def test_equal_faces_have_their_common_distance(name: str) -> None:
    vertices, _ = soup(name, 2000)
    flat = Shape(vertices * [1, 1, 0], np.arange(len(vertices)).reshape(-1, 3))
    away = np.eye(4)
    away[2, 3] = APART
    assert distance(flat, np.eye(4), flat, away) == pytest.approx(APART, rel=1e-14)
    assert distance(flat, np.eye(4), flat, np.eye(4)) == 0.0

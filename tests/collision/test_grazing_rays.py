"""Rays that graze vertices and edges, against exact arithmetic; rays that start on a face."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from fgenv.arrays import Floats
from fgenv.bench.common.solids import Solid, angle_iron, ball, box, somewhere
from fgenv.collision import Shape, collide, distance
from fgenv.collision.world import World

HERE = np.eye(4)

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


def exact_hits(solid: Solid, origin: Floats, direction: Floats) -> bool:
    """Whether a ray meets a closed face whose plane does not hold the ray."""
    o, d = [Fraction(x) for x in origin], [Fraction(x) for x in direction]

    def det(a: list[Fraction], b: list[Fraction], c: list[Fraction]) -> Fraction:
        return (
            a[0] * (b[1] * c[2] - b[2] * c[1])
            - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )

    for face in solid[1]:
        p = [[Fraction(x) - o[i] for i, x in enumerate(solid[0][v])] for v in face]
        sides = [det(d, p[k], p[(k + 1) % 3]) for k in range(3)]
        if not any(sides) or (min(sides) < 0 < max(sides)):
            continue
        if det(p[0], p[1], p[2]) * sum(sides) >= 0:
            return True
    return False


@pytest.mark.parametrize("solid", [box(1.0), angle_iron(), ball(0.5, 1)])
def test_rays_through_vertices_and_edges_hit(solid: Solid) -> None:
    """Coordinates on a grid, so that rays pass exactly through vertices and along edges."""
    rng = np.random.default_rng(0)
    shape, grid = Shape(*solid), 8
    for _ in range(400):
        a, b = solid[0][rng.integers(len(solid[0]), size=2)]
        target = a if rng.random() < 0.5 else (a + b) / 2
        direction = rng.integers(-3 * grid, 3 * grid + 1, 3) / grid
        if not direction.any():
            continue
        origin = target - direction
        at, _ = shape.raycast(origin, direction)
        assert np.isfinite(at) == exact_hits(solid, origin, direction)


def test_a_ray_that_touches_only_a_corner_hits_it() -> None:
    shape = Shape(*box())
    origin, direction = np.array([1.5, -0.5, 1.5]), np.array([-2.0, 2.0, -2.0])
    for corner in ((0.5, 0.5, 0.5), (-0.5, 0.5, 0.5), (-0.5, -0.5, -0.5)):
        for away in ((2.0, 1.0, -1.0), (-1.0, 0.5, 1.5), (0.75, -1.25, 0.5)):
            # Beside the box but for the corner, if no face is ahead: the exact test decides.
            origin, direction = np.array(corner) + away, -np.array(away)
            at, face = shape.raycast(origin, direction)
            assert np.isfinite(at) == exact_hits(box(), origin, direction)
            world = World()
            world.add(shape)
            assert world.raycast(origin, direction).distance == at
            if np.isfinite(at):
                assert face >= 0
    silhouette = shape.raycast([1.25, -0.25, 1.0], [-1.5, -0.5, -1.0])  # passes (0.5, -0.5, 0.5)
    assert silhouette[0] == pytest.approx(0.5 * np.linalg.norm([1.5, 0.5, 1.0]))


def test_a_ray_that_starts_on_a_face_has_distance_0() -> None:
    shape = Shape(*box())
    for direction in ([0, 0, 1], [0, 0, -1], [1, 2, 3], [1e-9, 0, -1]):
        assert shape.raycast([0.1, 0.2, 0.5], direction)[0] == 0.0
    assert shape.raycast([0.1, 0.2, np.nextafter(0.5, 1)], [0, 0, 1])[0] == np.inf
    assert 0 < shape.raycast([0.1, 0.2, np.nextafter(0.5, 1)], [0, 0, -1])[0] < 1e-15
    along = shape.raycast([0.1, 0.2, 0.5], [1, 0, 0])  # within the face: the neighbor's edge
    assert along[0] == pytest.approx(0.4)


def test_no_ray_passes_between_two_faces() -> None:
    """From inside a ball, at its edges and vertices, wherever the ball is."""
    rng = np.random.default_rng(1)
    vertices, faces = ball(1.0, 2)
    shape = Shape(vertices, faces)
    targets = np.concatenate(
        [vertices, (vertices[faces] + vertices[np.roll(faces, 1, 1)])[:, 0] / 2]
    )
    origins = rng.normal(0, 0.1, (len(targets), 3))
    assert np.isfinite(shape.raycast(origins, targets - origins)[0]).all()
    pose = somewhere(rng, 1e3)
    far = origins @ pose[:3, :3].T + pose[:3, 3]
    assert np.isfinite(shape.raycast(far, (targets - origins) @ pose[:3, :3].T, pose)[0]).all()


def test_the_distance_is_0_exactly_where_shapes_collide() -> None:
    """Also for gaps whose square is no double."""
    shape = Shape(*box())
    tiny = Shape(box(1e-3)[0] + [0, 0, 5e-4], box(1e-3)[1])
    flat = Shape(box()[0] - [0, 0, 0.5], box()[1])
    for gap in (0.0, 1e-320, 1e-200, 1e-17, 1e-16, 3e-16, -1e-17, 1e-9):
        pose = np.eye(4)
        pose[2, 3] = gap
        for a, b in ((flat, tiny), (shape, tiny), (flat, Shape(box()[0] + [0, 0, 0.5], box()[1]))):
            assert (distance(a, HERE, b, pose) == 0) == collide(a, HERE, b, pose)


@pytest.mark.parametrize("length", [1.0, 2.001, 0.3, 7.7])
def test_a_hit_at_just_the_maximum_distance_is_a_hit(length: float) -> None:
    """The fuzzer's ray to a corner 2 m away, of direction (0, 0, 2.001), had no hit within 2 m."""
    rng = np.random.default_rng(0)
    solid = ball(1.0)
    shape, world = Shape(*solid), World()
    world.add(shape, np.eye(4), name="ball")
    origins = rng.integers(-40, 40, (200, 3)) / 10 + [0.0, 0.0, 8.0]
    directions = length * (solid[0][rng.integers(len(solid[0]), size=200)] - origins)
    for cast in (shape.raycast, world.raycast):
        at, hit = cast(origins, directions)
        found = np.flatnonzero(np.isfinite(at))
        assert len(found) > 100
        for i in found:
            short, named = cast(origins[i], directions[i], max_distance=at[i])
            assert (short, named) == (at[i], hit[i])
            less = np.nextafter(at[i], 0)
            assert cast(origins[i], directions[i], max_distance=less)[1] == -1

"""Arrays of any shape, type and value give a result or an error with a message, never a crash."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from fuzz import queries
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray
from oracles.rational import meshes_meet

from fgenv.bench.common.poses import random_rotations
from fgenv.bench.common.solids import angle_iron, ball, box
from fgenv.collision import FeatureGraph, Shape, collide, contact_point, distance, nearest_points

pytestmark = pytest.mark.native

HERE = np.eye(4)
SOLIDS = [Shape(*box(1.0)), Shape(*angle_iron()), Shape(*ball(0.5, 1), tolerance=0.1)]

ANY_NUMBER = st.one_of(
    st.floats(width=64),
    st.sampled_from([0.0, -0.0, np.nan, np.inf, -np.inf, 5e-324, 1e-200, 1e200, -1.8e308]),
)
ANY_SHAPE = st.one_of(
    hnp.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=5),
    st.sampled_from([(4, 4), (3, 4, 4), (2, 1, 4, 4), (0, 4, 4), (3,), (5, 3), (0, 3), (2, 5, 3)]),
)
ANY_ARRAY = st.one_of(
    hnp.arrays(np.float64, ANY_SHAPE, elements=ANY_NUMBER),
    hnp.arrays(
        st.sampled_from(
            [np.dtype(t) for t in ("f4", "f2", "i8", "u1", "?", "c16", ">f8", "i2", "U3")]
        ),
        ANY_SHAPE,
    ),
    st.recursive(
        st.none() | st.integers() | st.floats() | st.text(max_size=3), st.lists, max_leaves=8
    ),
)
COORDINATES = st.one_of(
    st.floats(-1e9, 1e9),
    st.floats(-1.0, 1.0),
    st.integers(-3, 3).map(float),
    st.sampled_from([0.0, 5e-324, 1e-310, -1e-160, 1e-30, 1e8, 1e9]),
)


@st.composite
def meshes(draw: st.DrawFn) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Valid arrays of any geometry: folded, crossing, flat, far, tiny."""
    n = draw(st.integers(1, 8))
    vertices = draw(hnp.arrays(np.float64, (n, 3), elements=COORDINATES))
    faces = draw(
        hnp.arrays(np.int64, (draw(st.integers(1, 12)), 3), elements=st.integers(0, n - 1))
    )
    return vertices, faces


@st.composite
def poses(draw: st.DrawFn) -> NDArray[np.float64]:
    """Rigid motions, near and far."""
    pose = np.eye(4)
    seed = draw(st.integers(0, 2**32 - 1))
    if seed % 3:
        pose[:3, :3] = random_rotations(np.random.default_rng(seed), 1)[0]
    pose[:3, 3] = draw(hnp.arrays(np.float64, 3, elements=COORDINATES))
    return pose


def ask_everything(a: Shape, ta: Any, b: Shape, tb: Any) -> None:
    """Every query on the two shapes; the results must agree with each other."""
    hit = collide(a, ta, b, tb)
    gap = distance(a, ta, b, tb)
    assert np.all(np.asarray(gap) >= 0)
    assert np.all((np.asarray(gap) == 0) >= np.asarray(hit))
    near = nearest_points(a, ta, b, tb)
    assert np.shape(near.distance) == np.shape(hit)
    if np.ndim(hit) == 0:
        assert (contact_point(a, ta, b, tb) is not None) == bool(hit)


def answers_or_explains(*calls: Callable[[], Any]) -> None:
    """Every call returns, or raises an error with a message."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for call in calls:
            try:
                call()
            except (ValueError, TypeError) as error:
                explains(error)


def explains(error: Exception) -> None:
    """The error names an argument."""
    assert len(str(error)) > 10


@given(vertices=ANY_ARRAY, faces=ANY_ARRAY, method=st.sampled_from(["exact", "crease", "loop"]))
def test_any_arrays_as_a_mesh(vertices: Any, faces: Any, method: str) -> None:
    answers_or_explains(
        lambda: Shape(vertices, faces, method), lambda: FeatureGraph(vertices, faces, method)
    )


@given(pose=ANY_ARRAY, other=ANY_ARRAY)
@pytest.mark.parametrize(
    "query", [collide, distance, nearest_points, contact_point], ids=lambda q: q.__name__
)
def test_any_arrays_as_poses(query: Callable[..., Any], pose: Any, other: Any) -> None:
    a, b = SOLIDS[:2]
    answers_or_explains(
        lambda: query(a, pose, b, other),
        lambda: query(a, pose, b, HERE),
        lambda: query(a, HERE, b, other),
    )


@given(points=ANY_ARRAY, directions=ANY_ARRAY, pose=ANY_ARRAY, reach=ANY_NUMBER)
def test_any_arrays_as_points_and_rays(
    points: Any, directions: Any, pose: Any, reach: float
) -> None:
    shape = SOLIDS[1]
    answers_or_explains(
        lambda: shape.contains(points),
        lambda: shape.contains([[0, 0, 0]], pose),
        lambda: shape.raycast(points, directions),
        lambda: shape.raycast(points, [1, 2, 3], max_distance=reach),
        lambda: shape.raycast([0, 0, 9], directions, pose),
    )


@given(
    margin=ANY_NUMBER | st.none() | st.text(max_size=2),
    threads=st.none() | st.integers() | ANY_NUMBER | st.text(max_size=2),
    tolerance=ANY_NUMBER | st.none(),
    angle=ANY_NUMBER | st.tuples(ANY_NUMBER, ANY_NUMBER) | st.none() | st.text(max_size=2),
    method=st.sampled_from(["exact", "crease", "loop", "tolerance", "", "hull"]),
)
def test_any_settings(margin: Any, threads: Any, tolerance: Any, angle: Any, method: str) -> None:
    if isinstance(threads, int | float) and 16 < threads <= 4096:
        threads = 16  # more threads are valid, but slow on a small machine
    a, b = SOLIDS[:2]
    answers_or_explains(
        lambda: collide(a, HERE[None], b, HERE, margin=margin),
        lambda: collide(a, HERE[None], b, HERE, threads=threads),
        lambda: Shape(*box(1.0), method, tolerance=tolerance, angle=angle),
    )


@given(mesh=meshes(), which=st.sampled_from(range(3)), ta=poses(), tb=poses())
def test_any_geometry(mesh: tuple[Any, Any], which: int, ta: Any, tb: Any) -> None:
    solid = SOLIDS[which]
    for chosen in ({}, {"method": "crease"}, {"method": "loop"}, {"tolerance": 0.01}):
        shape = made(*mesh, **chosen)
        if shape is None:
            return
        ask_everything(shape, ta, solid, tb)
        ask_everything(solid, ta, shape, tb)
        ask_everything(shape, ta, shape, np.stack([tb, ta]))
        if shape.watertight:
            shape.contains(mesh[0], ta)
        shape.raycast(mesh[0], [1.0, -2.0, 0.5], ta)
        assert len(shape.graph.adjacency) >= 0


def made(vertices: Any, faces: Any, **chosen: Any) -> Shape | None:
    """The shape; None for a mesh without area, which raises an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return Shape(vertices, faces, **chosen)
        except ValueError as error:
            if "area" not in str(error):
                raise
            return None


SMALL = st.integers(-2, 2).map(float)


@given(
    first=hnp.arrays(np.float64, (5, 3), elements=SMALL),
    second=hnp.arrays(np.float64, (5, 3), elements=SMALL),
    faces=hnp.arrays(np.int32, (2, 4, 3), elements=st.integers(0, 4)),
)
def test_small_whole_meshes_agree_with_whole_numbers(first: Any, second: Any, faces: Any) -> None:
    """Degenerate meshes: shared points, flush faces, borders, edges of many faces."""
    a, b = made(first, faces[0]), made(second, faces[1])
    if a is None or b is None:
        return
    meet = meshes_meet(first, faces[0], HERE, second, faces[1], HERE)
    hit = collide(a, HERE, b, HERE)
    found = contact_point(a, HERE, b, HERE)
    assert hit == (found is not None)
    if meet:
        assert hit
    if hit and not meet:  # then one is inside the other
        assert found is not None
        assert found.edge is None
    assert (distance(a, HERE, b, HERE) == 0) == hit


@given(data=st.binary(max_size=300))
def test_any_bytes_as_a_question(data: bytes) -> None:
    """A short run of the fuzzer in tests/fuzz."""
    queries.ask(data)


@pytest.mark.parametrize("data", queries.seeds(), ids=lambda data: f"{data[0]}-{len(data)}")
def test_seeds_of_the_fuzzer(data: bytes) -> None:
    queries.ask(data)

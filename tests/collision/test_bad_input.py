"""Invalid input raises one error with the argument, the given and the expected value."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from fgenv.bench.common.solids import at, box
from fgenv.collision import FeatureGraph, Shape, collide, contact_point, distance, nearest_points

pytestmark = pytest.mark.native

CUBE = Shape(*box(1.0))
HERE = np.eye(4)
VERTICES, FACES = box(1.0)


def pose_with(row: int, column: int, value: float) -> np.ndarray[Any, Any]:
    pose = np.eye(4)
    pose[row, column] = value
    return pose


def vertices_with(value: float) -> np.ndarray[Any, Any]:
    vertices = VERTICES.copy()
    vertices[3, 1] = value
    return vertices


def says(error: Exception, *words: str) -> None:
    """Assert that the message is one line that contains every word."""
    text = str(error)
    assert "\n" not in text.strip()
    for word in words:
        assert re.search(word, text), f"{text!r} does not contain {word!r}"


# Meshes

BAD_MESHES: dict[str, tuple[Any, Any, type[Exception], tuple[str, ...]]] = {
    "no vertices": ([], FACES, ValueError, ("vertices", "expected")),
    "flat vertices": (
        VERTICES[:, :2],
        FACES,
        ValueError,
        ("vertices", r"\(8, 2\)", r"\(n, 3\)|, 3\)"),
    ),
    "a list of numbers": (VERTICES.ravel(), FACES, ValueError, ("vertices", r"\(24,\)")),
    "NaN": (vertices_with(np.nan), FACES, ValueError, ("vertices", "3", "nan", "finite")),
    "infinite": (vertices_with(np.inf), FACES, ValueError, ("vertices", "3", "inf", "finite")),
    "minus infinity": (vertices_with(-np.inf), FACES, ValueError, ("vertices", "inf", "finite")),
    "huge": (vertices_with(1e300), FACES, ValueError, ("vertices", "3")),
    "text": ([["a", "b", "c"]], FACES, TypeError, ("vertices", "float64")),
    "ragged": ([[0, 0, 0], [1, 0]], FACES, ValueError, ("vertices",)),
    "complex": (VERTICES * 1j, FACES, TypeError, ("vertices", "complex")),
    "None": (None, FACES, TypeError, ("vertices",)),
    "no faces": (VERTICES, np.zeros((0, 3), int), ValueError, ("faces", "no faces|at least one")),
    "empty faces": (VERTICES, [], ValueError, ("faces",)),
    "quads": (VERTICES, [[0, 1, 2, 3]], ValueError, ("faces", r"\(1, 4\)", "triangles|, 3")),
    "flat faces": (VERTICES, [0, 1, 2], ValueError, ("faces", r"\(3,\)")),
    "index too large": (VERTICES, [[0, 1, 2], [0, 1, 8]], ValueError, ("faces", "1", "8")),
    "index negative": (VERTICES, [[0, 1, -1]], ValueError, ("faces", "-1")),
    "index over 32 bits": (VERTICES, [[0, 1, 2**40]], ValueError, ("faces", str(2**40))),
    "indices not whole": (VERTICES, [[0.0, 1.0, 2.5]], TypeError, ("faces", "float64")),
    "boolean faces": (VERTICES, FACES > 0, TypeError, ("faces", "bool")),
    "zero area": (np.zeros((3, 3)), [[0, 1, 2]], ValueError, ("faces", "area")),
    "faces in line": ([[0, 0, 0], [1, 1, 1], [2, 2, 2]], [[0, 1, 2]], ValueError, ("area",)),
}


@pytest.mark.parametrize("make", [Shape, FeatureGraph], ids=lambda make: make.__name__)
@pytest.mark.parametrize("case", BAD_MESHES)
def test_bad_meshes(make: Callable[..., Any], case: str) -> None:
    vertices, faces, error, words = BAD_MESHES[case]
    with pytest.raises(error) as caught:
        make(vertices, faces)
    says(caught.value, *words)


BAD_CHOICES: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "unknown method": ({"method": "hull"}, ("method", "hull", "exact", "crease", "loop")),
    "negative tolerance": ({"tolerance": -1e-3}, ("tolerance", "-0.001")),
    "NaN tolerance": ({"tolerance": np.nan}, ("tolerance", "nan")),
    "infinite tolerance": ({"tolerance": np.inf}, ("tolerance", "inf")),
    "text tolerance": ({"tolerance": "1mm"}, ("tolerance", "1mm")),
    "tolerance and method": ({"method": "crease", "tolerance": 0.1}, ("tolerance", "crease")),
    "angle without crease": ({"angle": 0.5}, ("angle", "crease")),
    "angle over a turn": ({"method": "crease", "angle": 30.0}, ("angle", "30", "radians|pi")),
    "three angles": ({"method": "crease", "angle": (1.0, 2.0, 3.0)}, ("angle",)),
    "pair the wrong way": ({"method": "crease", "angle": (4.0, 2.0)}, ("angle",)),
    "NaN angle": ({"method": "loop", "angle": np.nan}, ("angle", "nan")),
    "text angle": ({"method": "loop", "angle": "wide"}, ("angle", "wide")),
}


@pytest.mark.parametrize("make", [Shape, FeatureGraph], ids=lambda make: make.__name__)
@pytest.mark.parametrize("case", BAD_CHOICES)
def test_bad_choices(make: Callable[..., Any], case: str) -> None:
    chosen, words = BAD_CHOICES[case]
    with pytest.raises((ValueError, TypeError)) as caught:
        make(VERTICES, FACES, **chosen)
    says(caught.value, *words)


# Files


@pytest.mark.parametrize("extension", ["stl", "obj", "ply", "off", "glb", "dae"])
@pytest.mark.parametrize("content", [b"not a mesh at all\n", b"\x00\xff" * 100, b"ply\nformat x\n"])
def test_a_file_of_something_else(extension: str, content: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"wrong.{extension}"
    path.write_bytes(content)
    with pytest.raises(ValueError, match="wrong") as caught:
        Shape.load(path)
    says(caught.value, f"wrong.{extension}")


def test_an_unknown_format(tmp_path: Path) -> None:
    path = tmp_path / "mesh.docx"
    path.write_bytes(b"words")
    with pytest.raises(ValueError, match="docx") as caught:
        Shape.load(path)
    says(caught.value, "stl", "obj")


def test_a_file_without_faces(tmp_path: Path) -> None:
    path = tmp_path / "points.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n")
    with pytest.raises(ValueError, match="faces") as caught:
        Shape.load(path)
    says(caught.value, "points.obj")


def test_a_file_with_bad_numbers(tmp_path: Path) -> None:
    path = tmp_path / "nan.obj"
    path.write_text("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(ValueError, match="nan") as caught:
        Shape.load(path)
    says(caught.value, "nan.obj", "vert")


def test_a_file_with_indices_out_of_range(tmp_path: Path) -> None:
    path = tmp_path / "range.off"
    path.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n")
    with pytest.raises(ValueError, match="range") as caught:
        Shape.load(path)
    says(caught.value, "face|index|vertex")


@pytest.mark.parametrize("scale", [0.0, -1.0, np.nan, np.inf, "mm", None])
def test_bad_scales(scale: Any, tmp_path: Path) -> None:
    trimesh.Trimesh(*box(1.0)).export(tmp_path / "box.stl")
    with pytest.raises((ValueError, TypeError)) as caught:
        Shape.load(tmp_path / "box.stl", scale=scale)
    says(caught.value, "scale", re.escape(str(scale)))


# Poses

BAD_POSES: dict[str, tuple[Any, type[Exception], tuple[str, ...]]] = {
    "3x3": (np.eye(3), ValueError, (r"\(3, 3\)", "4, 4")),
    "3x4": (np.eye(4)[:3], ValueError, (r"\(3, 4\)", "4, 4")),
    "a vector": (np.zeros(7), ValueError, (r"\(7,\)", "4, 4")),
    "a number": (1.0, ValueError, ("4, 4",)),
    "NaN": (pose_with(0, 3, np.nan), ValueError, ("finite", "nan")),
    "infinite": (pose_with(1, 3, np.inf), ValueError, ("finite", "inf")),
    "singular": (np.diag([1.0, 1.0, 0.0, 1.0]), ValueError, ("singular", "rigid")),
    "all zero": (np.zeros((4, 4)), ValueError, ("last row",)),
    "scaled": (np.diag([2.0, 2.0, 2.0, 1.0]), ValueError, ("scale", "rigid")),
    "scaled by a thousandth": (np.diag([1.001] * 3 + [1.0]), ValueError, ("scale", "rigid")),
    "sheared": (pose_with(0, 1, 0.1), ValueError, ("shear", "rigid")),
    "mirrored": (np.diag([1.0, 1.0, -1.0, 1.0]), ValueError, ("mirror", "rigid")),
    "transposed": (at(1.0, 2.0, 3.0).T, ValueError, ("last row", "0 0 0 1")),
    "projective": (pose_with(3, 3, 2.0), ValueError, ("last row",)),
    "text": ("here", TypeError, ("float64",)),
    "None": (None, TypeError, ()),
    "complex": (np.eye(4) * 1j, TypeError, ("complex",)),
    "objects": (np.full((4, 4), None), TypeError, ("object",)),
    "one of many": (np.stack([HERE, HERE, pose_with(0, 3, np.nan)]), ValueError, (r"\[2\]", "nan")),
}


@pytest.mark.parametrize(
    "query", [collide, distance, nearest_points, contact_point], ids=lambda q: q.__name__
)
@pytest.mark.parametrize("case", BAD_POSES)
def test_bad_poses(query: Callable[..., Any], case: str) -> None:
    pose, error, words = BAD_POSES[case]
    for arguments, name in (((CUBE, pose, CUBE, HERE), "Ta"), ((CUBE, HERE, CUBE, pose), "Tb")):
        with pytest.raises(error) as caught:
            query(*arguments)
        says(caught.value, name, *words)


@pytest.mark.parametrize("case", BAD_POSES)
def test_bad_poses_of_one_shape(case: str) -> None:
    pose, error, words = BAD_POSES[case]
    if pose is None:
        return  # the default: no pose
    for call in (
        lambda: CUBE.contains([[0, 0, 0]], pose),
        lambda: CUBE.raycast([[0, 0, 0]], [[1, 0, 0]], pose),
    ):
        with pytest.raises(error) as caught:
            call()
        says(caught.value, r"\bT\b", *words)


def test_shapes_that_do_not_broadcast() -> None:
    three, four = np.tile(HERE, (3, 1, 1)), np.tile(HERE, (4, 1, 1))
    for query in (collide, distance, nearest_points):
        with pytest.raises(ValueError, match="broadcast") as caught:
            query(CUBE, three, CUBE, four)
        says(caught.value, "Ta", r"\(3,\)", "Tb", r"\(4,\)")
    with pytest.raises(ValueError, match="broadcast") as caught:
        CUBE.raycast(np.zeros((3, 3)), np.ones((2, 3)))
    says(caught.value, "origins", "directions")


def test_contact_takes_one_pose_each() -> None:
    with pytest.raises(ValueError, match="one pose"):
        contact_point(CUBE, np.tile(HERE, (3, 1, 1)), CUBE, HERE)


@pytest.mark.parametrize("margin", [-1e-9, np.nan, np.inf, -np.inf])
def test_bad_margins(margin: float) -> None:
    with pytest.raises(ValueError, match="margin"):
        collide(CUBE, HERE, CUBE, HERE, margin=margin)


@pytest.mark.parametrize("threads", [0, -1, 10**9, 1.5, "all"])
def test_bad_threads(threads: Any) -> None:
    for query in (collide, distance, nearest_points):
        with pytest.raises((ValueError, TypeError), match="threads"):
            query(CUBE, np.tile(HERE, (3, 1, 1)), CUBE, HERE, threads=threads)


@pytest.mark.parametrize("value", ["none", "0", "-2", "1.5"])
def test_bad_thread_counts_in_the_environment(value: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FGENV_THREADS", value)
    with pytest.raises(ValueError, match="FGENV_THREADS"):
        collide(CUBE, np.tile(HERE, (300, 1, 1)), CUBE, HERE)


@pytest.mark.parametrize(
    "query", [collide, distance, nearest_points, contact_point], ids=lambda q: q.__name__
)
@pytest.mark.parametrize("shape", [None, "cube", box(1.0), np.eye(4), Shape])
def test_things_that_are_no_shape(query: Callable[..., Any], shape: Any) -> None:
    for arguments in ((shape, HERE, CUBE, HERE), (CUBE, HERE, shape, HERE)):
        with pytest.raises(TypeError):
            query(*arguments)


# Points and rays

BAD_POINTS: dict[str, tuple[Any, type[Exception], tuple[str, ...]]] = {
    "flat": (np.zeros((2, 2)), ValueError, (r"\(2, 2\)", ", 3")),
    "a number": (0.0, ValueError, (", 3",)),
    "NaN": ([[0.0, 0.0, np.nan]], ValueError, ("nan", "finite")),
    "infinite": ([[0.0, np.inf, 0.0]], ValueError, ("inf", "finite")),
    "text": ([["x", "y", "z"]], TypeError, ("float64",)),
    "ragged": ([[0.0, 0.0], [1.0]], ValueError, ("",)),
}


@pytest.mark.parametrize("case", BAD_POINTS)
def test_bad_points_and_rays(case: str) -> None:
    points, error, words = BAD_POINTS[case]
    for name, call in (
        ("points", lambda: CUBE.contains(points)),
        ("origins", lambda: CUBE.raycast(points, [[1.0, 0.0, 0.0]])),
        ("directions", lambda: CUBE.raycast([[0.0, 0.0, 0.0]], points)),
    ):
        with pytest.raises(error) as caught:
            call()
        says(caught.value, name, *words)


def test_rays_without_a_direction() -> None:
    with pytest.raises(ValueError, match="directions") as caught:
        CUBE.raycast([[0.0, 0.0, 0.0]], [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    says(caught.value, "1")


@pytest.mark.parametrize("reach", [-1.0, np.nan])
def test_bad_reaches(reach: float) -> None:
    with pytest.raises(ValueError, match="max_distance"):
        CUBE.raycast([[0.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]], max_distance=reach)


# Unusual but valid input


def test_odd_but_fine() -> None:
    single = HERE.astype(np.float32)
    assert collide(CUBE, single, CUBE, HERE)
    assert collide(CUBE, HERE.tolist(), CUBE, HERE)
    turned = HERE.copy()
    turned[:3, :3] = trimesh.transformations.random_rotation_matrix()[:3, :3].astype(np.float32)
    assert collide(CUBE, turned, CUBE, HERE)
    assert Shape(VERTICES.astype(np.float32), FACES.astype(np.uint8)).watertight
    assert Shape((2 * VERTICES).astype(int).tolist(), FACES.tolist()).watertight

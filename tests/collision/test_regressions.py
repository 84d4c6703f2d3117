"""Regression tests of fixed bugs, each with its cause."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import trimesh
from support import TESTS

from fgenv.bench.common.solids import at, box, somewhere
from fgenv.collision import MeshWarning, Shape, collide, contact_point, distance, nearest_points

pytestmark = pytest.mark.native

HERE = np.eye(4)


def quiet(vertices: object, faces: object) -> Shape:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)
        return Shape(vertices, faces)  # type: ignore[arg-type]


def test_a_sheet_that_is_flat_but_for_the_smallest_numbers_builds() -> None:
    """16 bins over a width of 1e-40 m: the scale was infinite, the bin index anything."""
    n = 12
    x, y = np.meshgrid(np.arange(n) * 1.0, np.arange(n) * 1.0)
    z = np.zeros_like(x)
    z[3, 4], z[7, 2] = 1e-40, 3e-41
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.vstack(
        [
            np.c_[corner, corner + 1, corner + n],
            np.c_[corner + 1, corner + n + 1, corner + n],
        ]
    )
    sheet = quiet(np.c_[x.ravel(), y.ravel(), z.ravel()], faces)
    assert collide(sheet, HERE, quiet(*box(1.0)), at(3.0, 3.0, 0.0))


def tower_with_t_junctions() -> Shape:
    """A closed box of two halves; the upper has vertices amid the edges of the lower."""
    ring = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    amid = 0.5 * (ring + np.roll(ring, -1, axis=0))
    levels = [
        np.c_[points, np.full(4, z)] for points, z in ((ring, -1.0), (ring, 0.0), (ring, 1.0))
    ]
    vertices = np.vstack([*levels, np.c_[amid, np.zeros(4)]])
    faces = [[0, 2, 1], [0, 3, 2], [8, 9, 10], [8, 10, 11]]
    for i in range(4):
        j = (i + 1) % 4
        faces += [[i, j, 4 + j], [i, 4 + j, 4 + i]]
        faces += [[4 + i, 12 + i, 8 + i], [12 + i, 8 + j, 8 + i], [12 + i, 4 + j, 8 + j]]
        faces += [[4 + i, 4 + j, 12 + i]]  # of zero area: it closes the T-junction
    return quiet(vertices, np.array(faces))


def test_a_shell_closed_by_flat_faces_holds_what_is_inside() -> None:
    """Without its flat faces it fell into two shells, each too small to hold the body."""
    tower, cube = tower_with_t_junctions(), quiet(*box(0.8))
    assert tower.watertight
    assert tower.contains([0.0, 0.0, 0.0])
    assert collide(tower, HERE, cube, HERE)
    assert distance(tower, HERE, cube, HERE) == 0.0


def test_a_pickled_shell_closed_by_flat_faces_stays_closed() -> None:
    """The flat faces were not in the pickle, so the copy was open."""
    tower = tower_with_t_junctions()
    twin = pickle.loads(pickle.dumps(tower))
    assert twin.watertight
    assert (twin.vertices == tower.vertices).all()
    assert (twin.faces == tower.faces).all()
    assert collide(twin, HERE, quiet(*box(0.4)), at(0.0, 0.0, 0.5))


def test_no_hit_beside_a_face_seen_edge_on() -> None:
    """The depth of a face in the ray's plane was rounding noise divided by rounding noise."""
    rng = np.random.default_rng(1)
    for _ in range(1000):
        place = somewhere(rng, 1)
        flat = np.c_[rng.normal(size=(3, 2)), np.zeros(3)]
        face = quiet(flat @ place[:3, :3].T + place[:3, 3], [[0, 1, 2]])
        start = np.r_[rng.normal(size=2) * 3, 0.0]
        way = flat.mean(axis=0) + np.r_[rng.normal(size=2) * 0.1, 0.0] - start
        found, _ = face.raycast(start @ place[:3, :3].T + place[:3, 3], way @ place[:3, :3].T)
        if np.isfinite(found):
            hit = start + found * way / np.linalg.norm(way)
            assert (hit >= flat.min(axis=0) - 1e-6).all()
            assert (hit <= flat.max(axis=0) + 1e-6).all()


@pytest.mark.parametrize("length", [1e-300, 1e-170, 1e-160, 1.0, 1e155, 1e300])
def test_the_length_of_a_ray_s_direction_does_not_matter(length: float) -> None:
    """The square of its length underflowed or overflowed."""
    found, face = quiet(*box(1.0)).raycast([-2.0, 0.1, 0.2], [length, 0.0, 0.0])
    assert found == pytest.approx(1.5, rel=1e-14)
    assert face >= 0


def test_distances_of_the_smallest_bodies() -> None:
    """Squared normals of faces of 1e-12 m underflowed in floats, and everything was culled."""
    for scale in (1e-10, 1e-12, 1e-13):
        cube = quiet(*box(scale))
        for gap in (0.25, 1.0):
            found = distance(cube, HERE, cube, at((1 + gap) * scale, 0.0, 0.0))
            assert found == pytest.approx(gap * scale, rel=1e-6)


def test_sizes_beyond_floats_raise() -> None:
    """Volumes of bodies 1e14 m across overflowed in the culls, which then found nothing."""
    with pytest.raises(ValueError, match="1e9 m"):
        quiet(*box(1e14))
    far = at(1e16, 0.0, 0.0)
    with pytest.raises(ValueError, match="1e12 m from the origin"):
        collide(quiet(*box(1.0)), HERE, quiet(*box(1.0)), far)
    large = quiet(*box(1e9))
    assert collide(large, HERE, large, at(0.99e9, 0.0, 0.0))
    assert not collide(large, HERE, large, at(1.01e9, 0.0, 0.0))


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="reads /proc")
def test_too_few_threads_are_enough() -> None:
    """A failed start of a thread ended the process."""
    script = """
import resource
import numpy as np
from fgenv.collision import Shape, collide
from fgenv.bench.common.solids import box
cube, poses = Shape(*box(1.0)), np.tile(np.eye(4), (300_000, 1, 1))
used = int(open("/proc/self/status").read().split("VmSize:")[1].split()[0]) * 1024
resource.setrlimit(resource.RLIMIT_AS, (used + 300 * 2**20,) * 2)
print(collide(cube, np.eye(4), cube, poses, threads=4096).all())
"""
    found = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(TESTS)},
    )
    if "MemoryError" in found.stderr or "bad_alloc" in found.stderr:
        pytest.skip("the limit left too little memory for the poses")
    assert found.stdout.strip() == "True", found.stderr


def symmetric_contacts() -> list[object]:
    """Contacts and nearest points of poses with many equivalent candidates."""
    rng = np.random.default_rng(5)
    corner = np.array([0.9, 0.6, 0.3])
    fine = trimesh.creation.box((1.0, 1.0, 1.0)).subdivide().subdivide()
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.6)
    results: list[object] = []
    for mesh in (fine, ball):
        shape = quiet(mesh.vertices + corner, mesh.faces)
        for _ in range(150):
            a = somewhere(rng, 0.1)
            turn = rng.choice([0.0, np.pi / 2, np.pi / 4, np.pi])
            step = trimesh.transformations.rotation_matrix(turn, [1, 0, 0])
            step[0, 3] = rng.choice([0.5, 0.9, 1.0, 1.25, 1.5, 2.0])
            b = a @ at(*corner) @ step @ at(*-corner)
            touch = contact_point(shape, a, shape, b)
            results.append(None if touch is None else (touch.point.tobytes(), touch.face))
            results.append([part.tobytes() for part in nearest_points(shape, a, shape, b)])
    return results


@pytest.mark.unsanitized
def test_contacts_do_not_depend_on_the_instruction_set() -> None:
    """Fused products in the culls changed which of equal contacts was found first."""
    results = []
    for isa in ("baseline", "v3"):
        found = subprocess.run(
            [
                sys.executable,
                "-c",
                "import pickle, sys; from collision.test_regressions import symmetric_contacts;"
                "sys.stdout.buffer.write(pickle.dumps(symmetric_contacts()))",
            ],
            capture_output=True,
            env={**os.environ, "FGENV_ISA": isa, "PYTHONPATH": str(TESTS)},
        )
        if b"no AVX2" in found.stderr:
            pytest.skip("this processor has one instruction set only")
        assert found.returncode == 0, found.stderr.decode()
        results.append(pickle.loads(found.stdout))
    assert results[0] == results[1]

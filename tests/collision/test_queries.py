"""Laws of the queries, and comparisons with independent results."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

import igl
import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.independent import coal_distances, distances_to_surface, fcl_checker
from support import TESTS
from support.meshes import MeshPair, pairs

from fgenv.arrays import Floats
from fgenv.bench.common.poses import USUAL, random_poses_batched
from fgenv.bench.common.solids import (
    angle_iron,
    at,
    ball,
    bowl,
    box,
    inverted,
    opened,
    somewhere,
    together,
)
from fgenv.collision import Shape, collide, contact_point, distance, nearest_points

HERE = np.eye(4)
PAIRS = pairs(6, largest=3000, seed=11)

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


class Scene:
    """A pair of real meshes at a random place, with poses of b around contact."""

    def __init__(self, pair: MeshPair, count: int, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        self.mesh_a, self.mesh_b = pair.load()
        self.a, self.b = (Shape(m.vertices, m.faces) for m in (self.mesh_a, self.mesh_b))
        self.size = max(self.mesh_a.size, self.mesh_b.size)
        self.pose_a = somewhere(rng, self.size)
        self.fcl = fcl_checker(self.mesh_a, self.mesh_b, self.pose_a)
        meshes = self.mesh_a, self.mesh_b
        self.poses = random_poses_batched(
            *meshes, self.pose_a, count, self.fcl.collide_all, rng, USUAL
        )


@pytest.fixture(params=PAIRS, ids=lambda pair: pair.name, scope="module")
def scene(request: pytest.FixtureRequest) -> Scene:
    return Scene(request.param, 150)


# Distance


def test_distance_agrees_with_fcl_and_coal(scene: Scene) -> None:
    found = distance(scene.a, scene.pose_a, scene.b, scene.poses)
    free = found > 0
    assert free.mean() > 0.3
    assert scene.fcl.distance_all is not None
    place = scene.mesh_a, scene.mesh_b, scene.pose_a, scene.poses[free]
    for others in (scene.fcl.distance_all(scene.poses[free]), coal_distances(*place)):
        np.testing.assert_allclose(found[free], others, rtol=1e-6, atol=1e-9 * scene.size)


def test_distance_is_zero_exactly_where_they_collide(scene: Scene) -> None:
    found = distance(scene.a, scene.pose_a, scene.b, scene.poses)
    hits = collide(scene.a, scene.pose_a, scene.b, scene.poses)
    assert ((found == 0) == hits).all()


def test_distance_is_symmetric_and_moves_with_both(scene: Scene) -> None:
    found = distance(scene.a, scene.pose_a, scene.b, scene.poses)
    swapped = distance(scene.b, scene.poses, scene.a, scene.pose_a)
    np.testing.assert_allclose(swapped, found, rtol=1e-9, atol=1e-12 * scene.size)
    place = somewhere(np.random.default_rng(1))
    moved = distance(scene.a, place @ scene.pose_a, scene.b, place @ scene.poses)
    np.testing.assert_allclose(moved, found, rtol=1e-7, atol=1e-12 * scene.size)


def test_distance_changes_no_faster_than_the_body_moves(scene: Scene) -> None:
    rng = np.random.default_rng(2)
    step = rng.normal(size=(len(scene.poses), 3)) * 0.05 * scene.size
    moved = scene.poses.copy()
    moved[:, :3, 3] += step
    before = distance(scene.a, scene.pose_a, scene.b, scene.poses)
    after = distance(scene.a, scene.pose_a, scene.b, moved)
    assert (np.abs(after - before) <= np.linalg.norm(step, axis=1) * (1 + 1e-9)).all()


def test_the_nearest_points_are_on_the_surfaces(scene: Scene) -> None:
    found = nearest_points(scene.a, scene.pose_a, scene.b, scene.poses)
    gap = np.linalg.norm(found.point_a - found.point_b, axis=-1)
    np.testing.assert_allclose(gap, found.distance, rtol=1e-9, atol=1e-12 * scene.size)
    np.testing.assert_allclose(np.linalg.norm(found.normal, axis=-1), 1.0, rtol=1e-9)
    free = found.distance > 1e-6 * scene.size
    way = found.point_a[free] - found.point_b[free]
    np.testing.assert_allclose(
        way, found.normal[free] * found.distance[free, None], atol=1e-9 * scene.size
    )
    # a containment's contact point is a vertex of the inner body: inside the outer one, not on it
    touches = [contact_point(scene.a, scene.pose_a, scene.b, pose) for pose in scene.poses]
    on_both = np.array([touch is None or touch.edge is not None for touch in touches])
    for shape, pose, point in (
        (scene.a, np.broadcast_to(scene.pose_a, scene.poses.shape), found.point_a),
        (scene.b, scene.poses, found.point_b),
    ):
        local = np.einsum("nji,nj->ni", pose[:, :3, :3], point - pose[:, :3, 3])
        off = distances_to_surface(shape, local[on_both])
        assert off.max() < 1e-7 * scene.size


def test_distances_known_on_paper() -> None:
    cube, rod = Shape(*box(1.0)), Shape(*box(0.2, 0.2, 3.0))
    place = somewhere(np.random.default_rng(3))
    for apart, expected in (
        (at(2.0, 0.0, 0.0), 1.4),  # face to face
        (at(2.0, 2.0, 0.0), np.hypot(1.4, 1.4)),  # edge to edge
        (at(2.0, 3.0, 4.0), np.linalg.norm([1.4, 2.4, 2.0])),  # corner to corner
        (at(0.0, 0.0, 5.0), 3.0),
        (at(0.6, 0.3, 0.0), 0.0),  # flush, up to rounding
    ):
        assert distance(cube, HERE, rod, apart) == pytest.approx(expected, abs=1e-15)
        assert distance(cube, place, rod, place @ apart) == pytest.approx(expected, abs=1e-15)
    edge_on = at(3.0)
    c = np.sqrt(0.5)
    edge_on[:3, :3] = [[c, -c, 0], [c, c, 0], [0, 0, 1]]
    assert distance(cube, HERE, cube, edge_on) == pytest.approx(2.5 - c, rel=1e-14)
    found = nearest_points(cube, HERE, rod, at(2.0, 0.0, 0.0))
    assert found.normal == pytest.approx([-1.0, 0.0, 0.0])
    assert found.point_a[0] == pytest.approx(0.5)
    assert found.point_b[0] == pytest.approx(1.9)


@pytest.mark.parametrize("gap", [1e-12, 1e-8, 1e-3, 1e3, 1e6])
def test_distances_near_and_far(gap: float) -> None:
    cube = Shape(*box(1.0))
    assert distance(cube, HERE, cube, at(1.0 + gap)) == pytest.approx(gap, rel=1e-3, abs=1e-15)


@pytest.mark.parametrize("gap", [1e-13, 1e-11, 1e-9])
def test_a_gap_as_small_as_rounding_has_a_distance(gap: float) -> None:
    """Faces a kilometer long, turned together."""
    rng = np.random.default_rng(4)
    slab = Shape(*box(1e3, 1e3, 1.0))
    for place in (somewhere(rng) for _ in range(40)):
        x, y = rng.uniform(-300.0, 300.0, 2)
        aside = at(x, y, 1.0 + gap)
        found = distance(slab, place, slab, place @ aside)
        assert found == pytest.approx(gap, abs=1e-9)


# Margin


def test_margin_is_a_bound_on_the_distance(scene: Scene) -> None:
    found = distance(scene.a, scene.pose_a, scene.b, scene.poses)
    for margin in (0.0, 0.01 * scene.size, 0.2 * scene.size):
        near = collide(scene.a, scene.pose_a, scene.b, scene.poses, margin=margin)
        clear = np.abs(found - margin) > 1e-12 * scene.size
        assert (near == (found <= margin))[clear].all()
    for i in np.flatnonzero(found > 0)[:20]:
        for factor, expected in ((1 + 1e-9, True), (1 - 1e-9, False)):
            margin = float(found[i] * factor)
            assert (
                collide(scene.a, scene.pose_a, scene.b, scene.poses[i], margin=margin) == expected
            )


# Broadcasting, forms of arguments


def test_poses_broadcast() -> None:
    a, b = Shape(*angle_iron()), Shape(*box(0.4))
    rng = np.random.default_rng(4)
    ta, tb = (np.stack([somewhere(rng, 0.4) for _ in range(n)]) for n in (3, 5))
    grid = collide(a, ta[:, None], b, tb)
    assert grid.shape == (3, 5)
    assert grid.dtype == np.bool_
    expected = [[collide(a, x, b, y) for y in tb] for x in ta]
    assert grid.tolist() == expected
    assert set(grid.ravel()) == {True, False}
    far = distance(a, ta[:, None], b, tb)
    assert far.tolist() == [[distance(a, x, b, y) for y in tb] for x in ta]
    assert isinstance(collide(a, ta[0], b, tb[0]), bool)
    assert isinstance(distance(a, ta[0], b, tb[0]), float)
    assert collide(a, ta[:0], b, tb[0]).shape == (0,)
    assert collide(a, ta[:1], b, tb).shape == (5,)
    found = nearest_points(a, ta[:, None], b, tb)
    assert found.distance.shape == (3, 5)
    assert found.point_a.shape == found.point_b.shape == found.normal.shape == (3, 5, 3)


def test_any_memory_layout_gives_the_same() -> None:
    a, b = Shape(*angle_iron()), Shape(*box(0.4))
    rng = np.random.default_rng(5)
    poses = np.stack([somewhere(rng, 0.4) for _ in range(20)])
    expected = collide(a, HERE, b, poses)
    strided = np.zeros((20, 8, 8))[:, ::2, ::2]
    strided[:] = poses
    fortran = np.asfortranarray(poses)
    for same in (strided, fortran, poses[::-1][::-1], poses.tolist(), poses.astype(">f8")):
        assert (collide(a, HERE, b, same) == expected).all()
    read_only = poses.copy()
    read_only.flags.writeable = False
    assert (collide(a, HERE, b, read_only) == expected).all()
    assert (collide(a, np.eye(4, dtype=int), b, poses) == expected).all()


def test_arguments_are_left_alone() -> None:
    vertices, faces = (np.array(x) for x in box(1.0))
    before = vertices.copy(), faces.copy()
    shape = Shape(vertices, faces)
    poses = np.tile(HERE, (5, 1, 1))
    collide(shape, HERE, shape, poses)
    vertices[:] = 7.0
    assert np.ptp(shape.vertices, axis=0) == pytest.approx([1.0, 1.0, 1.0])
    assert (poses == HERE).all()
    assert (faces == before[1]).all()


# Points inside


def test_contains_agrees_with_the_solid_angle(scene: Scene) -> None:
    for shape, mesh in ((scene.a, scene.mesh_a), (scene.b, scene.mesh_b)):
        if not shape.watertight:
            continue
        rng = np.random.default_rng(6)
        low, high = shape.bounds
        points = rng.uniform(low - 0.05 * mesh.size, high + 0.05 * mesh.size, size=(400, 3))
        angle = igl.winding_number(shape.vertices, shape.faces.astype(np.int64), points)
        place = somewhere(rng, mesh.size)
        world = points @ place[:3, :3].T + place[:3, 3]
        off = distances_to_surface(shape, points)
        sure = (off > 1e-9 * mesh.size) & (np.abs(angle - np.round(angle)) < 1e-6)
        assert (shape.contains(world, place) == (np.round(angle) != 0))[sure].all()


def test_contains_in_simple_solids() -> None:
    for solid in (ball(1.0), inverted(ball(1.0))):
        round_ = Shape(*solid)
        assert round_.contains([[0.0, 0, 0], [0.9, 0, 0], [1.1, 0, 0], [0, 0, 1.0]]).tolist() == [
            True,
            True,
            False,
            True,  # a vertex: the surface counts
        ]
    hollow = Shape(*together(ball(1.0), inverted(ball(0.5))))
    assert hollow.contains([[0.0, 0, 0], [0.7, 0, 0]]).tolist() == [False, True]
    assert Shape(*bowl()).contains([[0, 0, 0.5], [0, 0, 0.05]]).tolist() == [False, True]


def test_contains_on_the_surface() -> None:
    cube = Shape(*box(2.0))
    corners = np.array(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3)).reshape(3, -1).T
    assert cube.contains(corners).all()
    assert not cube.contains(corners[np.abs(corners).max(axis=1) == 1] * (1 + 1e-12)).any()
    assert cube.contains([[0, 0, 0], [5, 0, 0]], at(5.0)).tolist() == [False, True]
    assert cube.contains([0.0, 0.0, 0.0]).shape == ()


def test_contains_requires_a_solid() -> None:
    with pytest.raises(ValueError, match="watertight"):
        Shape(*opened(box(1.0))).contains([[0, 0, 0]])


# Rays


def test_rays_agree_with_a_formula(scene: Scene) -> None:
    rng = np.random.default_rng(7)
    for shape, mesh in ((scene.a, scene.mesh_a), (scene.b, scene.mesh_b)):
        target = shape.vertices[shape.faces].mean(axis=1)[rng.integers(len(shape.faces), size=300)]
        origins = target + rng.normal(size=(300, 3)) * mesh.size
        directions = target - origins + rng.normal(size=(300, 3)) * 0.05 * mesh.size
        by_hand, _ = nearest_hits(shape, origins, directions)
        place = somewhere(rng, mesh.size)
        turned = directions @ place[:3, :3].T
        found, face = shape.raycast(origins @ place[:3, :3].T + place[:3, 3], turned, place)
        assert ((face >= 0) == np.isfinite(found)).all()
        agree = np.isclose(found, by_hand, rtol=1e-9, atol=1e-9 * mesh.size)
        assert (
            agree | (np.isinf(found) & np.isinf(by_hand))
        ).mean() > 0.99  # grazing rays may differ
        hit = face >= 0
        unit = directions[hit] / np.linalg.norm(directions[hit], axis=1, keepdims=True)
        at_face = shape.vertices[shape.faces[face[hit]]]
        normal = np.cross(at_face[:, 1] - at_face[:, 0], at_face[:, 2] - at_face[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        off = np.einsum("ni,ni->n", origins[hit] + found[hit, None] * unit - at_face[:, 0], normal)
        assert np.abs(off).max() < 1e-9 * mesh.size


def nearest_hits(
    shape: Shape, origins: Floats, directions: Floats
) -> tuple[Floats, NDArray[np.intp]]:
    """Distances along rays by Moeller and Trumbore's formula against every face."""
    corners = shape.vertices[shape.faces]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    found = np.full(len(origins), np.inf)
    which = np.full(len(origins), -1)
    for i, (origin, way) in enumerate(zip(origins, directions, strict=True)):
        way = way / np.linalg.norm(way)
        p = np.cross(way, two)
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1.0 / np.einsum("ni,ni->n", one, p)
            t = origin - corners[:, 0]
            u = np.einsum("ni,ni->n", t, p) * inverse
            q = np.cross(t, one)
            v = q @ way * inverse
            distance_ = np.einsum("ni,ni->n", two, q) * inverse
            meets = (u >= 0) & (v >= 0) & (u + v <= 1) & (distance_ >= 0)
        if meets.any():
            which[i] = int(np.argmin(np.where(meets, distance_, np.inf)))
            found[i] = distance_[which[i]]
    return found, which


def test_rays_known_on_paper() -> None:
    cube = Shape(*box(2.0))
    rays = (
        [[-5, 0.1, 0.2], [0.0, 0, 0], [-5.0, 3, 0], [-5.0, 0, 0]],
        [[1, 0, 0], [0, 0, 1], [1, 0, 0], [-1, 0, 0]],
    )
    found, face = cube.raycast(*rays)
    assert found.tolist() == [4.0, 1.0, np.inf, np.inf]
    assert (face[2:] == -1).all()
    assert cube.raycast(*rays, max_distance=3.9)[0].tolist() == [np.inf, 1.0, np.inf, np.inf]
    assert cube.raycast([-5, 0, 0], [2, 0, 0])[0] == 4.0  # length does not matter; edges count
    assert cube.raycast([-5, 1, 1], [1, 0, 0])[0] == 4.0  # along an edge of the cube
    through = cube.raycast([[-5, 0, 0]], [[1, 0, 0]], np.stack([at(i) for i in range(3)]))
    assert through[0].tolist() == [4.0, 5.0, 6.0]


def test_no_ray_slips_through_a_closed_surface() -> None:
    """All rays from inside at vertices, edges and faces must hit."""
    round_ = Shape(*ball(1.0, 3))
    corners = round_.vertices[round_.faces]
    aims = np.concatenate([round_.vertices, corners.mean(axis=1), corners[:, :2].mean(axis=1)])
    for origin in ([0.0, 0.0, 0.0], [0.1, 0.2, -0.3]):
        found, _ = round_.raycast(np.array(origin), aims - origin)
        np.testing.assert_allclose(found, np.linalg.norm(aims - origin, axis=1), rtol=1e-12)


# Contacts


def test_a_contact_lies_on_both(scene: Scene) -> None:
    hits = collide(scene.a, scene.pose_a, scene.b, scene.poses)
    for pose, hit in zip(scene.poses[:60], hits[:60], strict=True):
        found = contact_point(scene.a, scene.pose_a, scene.b, pose)
        assert (found is not None) == hit
        if found is None or found.edge is None:
            continue
        assert np.linalg.norm(found.normal) == pytest.approx(1.0)
        assert found.edge_of in ("a", "b")
        start, end = found.edge
        way = end - start
        along = (found.point - start) @ way / (way @ way)
        assert -1e-9 <= along <= 1 + 1e-9
        assert np.linalg.norm(start + along * way - found.point) < 1e-9 * scene.size
        face_of, place = (scene.b, pose) if found.edge_of == "a" else (scene.a, scene.pose_a)
        assert found.face is not None
        corners = face_of.vertices[face_of.faces[found.face]] @ place[:3, :3].T + place[:3, 3]
        apart = igl.point_mesh_squared_distance(
            found.point[None], corners, np.array([[0, 1, 2]], np.int64)
        )[0]
        assert np.sqrt(np.atleast_1d(apart)[0]) < 1e-9 * scene.size


def test_a_contact_names_a_feature_edge() -> None:
    """The edge belongs to the feature graph of its shape."""
    a, b = Shape(*angle_iron()), Shape(*box(0.4))
    rng = np.random.default_rng(8)
    seen = set()
    for _ in range(100):
        pose = somewhere(rng, 0.4)
        found = contact_point(a, HERE, b, pose)
        if found is None or found.edge is None:
            continue
        own, place = (a, HERE) if found.edge_of == "a" else (b, pose)
        ends = (found.edge - place[:3, 3]) @ place[:3, :3]
        known = own.graph.points[own.graph.edges]
        gap = np.minimum(
            np.abs(known - ends).max(axis=(1, 2)), np.abs(known - ends[::-1]).max(axis=(1, 2))
        )
        assert gap.min() < 1e-12
        seen.add(found.edge_of)
    assert seen == {"a", "b"}


def test_the_normal_pushes_a_off_b() -> None:
    floor, cube = Shape(*box(10.0, 10.0, 1.0)), Shape(*box(1.0))
    assert nearest_points(cube, at(z=1.5), floor, HERE).normal == pytest.approx([0.0, 0.0, 1.0])
    found = contact_point(cube, at(z=0.99), floor, HERE)
    assert found is not None
    assert abs(found.normal).max() == pytest.approx(1.0)


# Threads, instruction sets, interruption

DIGEST = """
import hashlib, sys, warnings
sys.path.insert(0, {tests!r})
warnings.simplefilter("ignore")
import numpy as np
from support.meshes import pairs
from fgenv.bench.common.solids import somewhere
from fgenv import _core
from fgenv.collision import Shape, collide, distance, nearest_points
digest = hashlib.sha256()
for index, pair in enumerate(pairs(2, largest=1000, seed=12)):
    rng = np.random.default_rng(index)
    meshes = pair.load()
    a, b = (Shape(m.vertices, m.faces) for m in meshes)
    size = max(m.size for m in meshes)
    poses = np.stack([somewhere(rng, 0.4 * size) for _ in range(300)])
    spin = np.stack([somewhere(rng, 0.4 * size) for _ in range(300)])
    digest.update(collide(a, spin, b, poses).tobytes())
    digest.update(collide(a, spin, b, poses, margin=0.1 * size).tobytes())
    digest.update(distance(a, spin[:100], b, poses[:100]).tobytes())
    for part in nearest_points(a, spin[:100], b, poses[:100]):
        digest.update(part.tobytes())
    for part in a.raycast(poses[:, :3, 3], poses[:, :3, 0], spin):
        digest.update(part.tobytes())
    if a.watertight:
        digest.update(a.contains(poses[:, :3, 3], spin).tobytes())
    digest.update(a.graph.adjacency.tobytes())
print(_core.isa(), digest.hexdigest())
"""


def digest(**environment: str) -> tuple[str, str]:
    """Instruction set and digest of many results in a fresh process."""
    code = DIGEST.format(tests=str(TESTS))
    ran = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    isa, value = ran.stdout.split()
    return isa, value


@pytest.mark.unsanitized
def test_results_are_equal_bit_for_bit_on_every_machine() -> None:
    usual = digest(FGENV_THREADS="1")
    assert digest(FGENV_THREADS="2")[1] == usual[1]
    baseline = digest(FGENV_ISA="baseline", FGENV_THREADS="1")
    assert baseline == ("baseline", usual[1])
    if (
        usual[0] != "baseline"
    ):  # the best instruction set of this machine; skipped if there is only one
        assert digest(FGENV_ISA=usual[0], FGENV_THREADS="2") == usual


def test_threads_change_nothing(scene: Scene) -> None:
    for query in (collide, distance):
        one = query(scene.a, scene.pose_a, scene.b, scene.poses, threads=1)
        for threads in (2, 3, 16):
            many = query(scene.a, scene.pose_a, scene.b, scene.poses, threads=threads)
            assert one.tobytes() == many.tobytes()


def test_queries_run_side_by_side(scene: Scene) -> None:
    """The GIL is released, and shapes are shared between Python threads."""
    expected = collide(scene.a, scene.pose_a, scene.b, scene.poses, threads=1)
    found: list[NDArray[np.bool_]] = []

    def work() -> None:
        for _ in range(5):
            found.append(collide(scene.a, scene.pose_a, scene.b, scene.poses, threads=1))

    team = [threading.Thread(target=work) for _ in range(4)]
    for member in team:
        member.start()
    for member in team:
        member.join()
    assert len(found) == 20
    assert all((one == expected).all() for one in found)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("threads", [1, 2])
def test_a_long_batch_can_be_interrupted(threads: int) -> None:
    a = Shape(*ball(1.0, 4))
    poses = np.broadcast_to(at(0.0, 0.0, 2.1), (500_000, 4, 4))
    began = time.process_time()
    distance(a, HERE, a, poses[:10_000], threads=threads)
    whole = 50 * (time.process_time() - began)  # CPU-seconds of all poses
    began = time.process_time()
    timer = threading.Timer(0.4, signal.raise_signal, [signal.SIGINT])
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)

    def work() -> None:
        for _ in range(20):
            distance(a, HERE, a, poses, threads=threads)

    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, handler)
    assert time.process_time() - began < 0.8 * whole


def test_shapes_pickle_and_copy() -> None:
    import copy
    import pickle

    a = Shape(*angle_iron(), method="crease", angle=0.3, name="iron")
    for twin in (pickle.loads(pickle.dumps(a)), copy.deepcopy(a)):
        assert twin.name == "iron"
        assert twin.method == "crease"
        assert (twin.vertices == a.vertices).all()
        assert (twin.faces == a.faces).all()
        assert collide(a, HERE, twin, HERE)

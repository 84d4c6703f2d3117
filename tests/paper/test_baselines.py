"""Each baseline against an independent oracle; no bound misses a contact."""

from __future__ import annotations

import fcl
import numpy as np
import pytest
import trimesh
from scipy.optimize import linprog

from fgenv.arrays import Floats
from fgenv.bench.common.meshes import Mesh, load
from fgenv.bench.common.poses import random_poses, random_rotations
from fgenv.paper.baselines import (
    BASELINES,
    Aabb,
    Grid,
    Hull,
    Obb,
    Sphere,
    boxes_overlap,
    hull,
    move,
    voxels,
)


def body(mesh: trimesh.Trimesh, name: str = "") -> Mesh:
    return Mesh(name, np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int32))


@pytest.fixture(scope="module")
def pair() -> tuple[Mesh, Mesh]:
    """Two real, concave links."""
    folder = "so_arm_description/meshes/so100"
    return (
        load("example-robot-data", f"{folder}/Moving_Jaw.stl"),
        load("rtb-data", "meshes/Puma560-obj/pieza6.obj"),
    )


def tumble(rng: np.random.Generator, count: int, spread: float) -> Floats:
    """Poses (count, 4, 4) with any rotation and a normal offset of `spread` meters."""
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = random_rotations(rng, count)
    poses[:, :3, 3] = rng.normal(scale=spread, size=(count, 3))
    return poses


def fcl_hit(a: object, pose_a: Floats, b: object, pose_b: Floats) -> bool:
    objects = [
        fcl.CollisionObject(g, fcl.Transform(pose[:3, :3], pose[:3, 3]))
        for g, pose in ((a, pose_a), (b, pose_b))
    ]
    return bool(fcl.collide(*objects, fcl.CollisionRequest(), fcl.CollisionResult()) > 0)


def surface(mesh: Mesh) -> fcl.BVHModel:
    model = fcl.BVHModel()
    model.beginModel(len(mesh.vertices), len(mesh.faces))
    model.addSubModel(mesh.vertices, mesh.faces)
    model.endModel()
    return model


def test_box_test_agrees_with_fcl() -> None:
    rng = np.random.default_rng(1)
    hits = 0
    for pose_a, pose_b in zip(tumble(rng, 500, 0.5), tumble(rng, 500, 0.5), strict=True):
        half_a, half_b = rng.uniform(0.02, 0.8, size=(2, 3))
        rotation = pose_a[:3, :3].T @ pose_b[:3, :3]
        offset = pose_a[:3, :3].T @ (pose_b[:3, 3] - pose_a[:3, 3])
        ours = bool(boxes_overlap(rotation, offset, half_a, half_b))
        assert ours == fcl_hit(fcl.Box(*2 * half_a), pose_a, fcl.Box(*2 * half_b), pose_b)
        hits += ours
    assert 100 < hits < 400


def test_box_test_counts_touching_and_parallel_edges() -> None:
    half = np.array([0.5, 0.5, 0.5])
    offsets = np.array([[1.0, 0, 0], [1.0, 1.0, 1.0], [1.0 + 1e-9, 0, 0], [1.0, 1.0 + 1e-9, 0]])
    assert boxes_overlap(np.eye(3), offsets, half, half).tolist() == [True, True, False, False]


def test_aabb_is_the_box_of_the_posed_mesh(pair: tuple[Mesh, Mesh]) -> None:
    rng = np.random.default_rng(2)
    a, b = pair
    aabb, found = Aabb(a, b), []
    for pose_a, pose_b in zip(tumble(rng, 200, 0.05), tumble(rng, 200, 0.05), strict=True):
        low_a, high_a = np.sort(move(pose_a, a.vertices), axis=0)[[0, -1]]
        low_b, high_b = np.sort(move(pose_b, b.vertices), axis=0)[[0, -1]]
        found.append(aabb.collides(pose_a, pose_b))
        assert found[-1] == (np.maximum(low_a, low_b) <= np.minimum(high_a, high_b)).all()
    assert 20 < sum(found) < 180


def test_obb_contains_the_mesh_and_agrees_with_fcl(pair: tuple[Mesh, Mesh]) -> None:
    rng = np.random.default_rng(3)
    obb, found = Obb(*pair), []
    bounds = [Obb._bound(mesh) for mesh in pair]
    for mesh, (box, half) in zip(pair, bounds, strict=True):
        local = move(np.asarray(np.linalg.inv(box), float), mesh.vertices)
        assert (np.abs(local) <= half + 1e-12).all()
        assert (local.max(axis=0) > half - 1e-9).all()
        assert 8 * half.prod() <= np.ptp(mesh.vertices, axis=0).prod() * (1 + 1e-9)
    for pose_a, pose_b in zip(tumble(rng, 200, 0.05), tumble(rng, 200, 0.05), strict=True):
        (box_a, half_a), (box_b, half_b) = bounds
        found.append(obb.collides(pose_a, pose_b))
        shapes = fcl.Box(*2 * half_a), fcl.Box(*2 * half_b)
        assert found[-1] == fcl_hit(shapes[0], pose_a @ box_a, shapes[1], pose_b @ box_b)
    assert 20 < sum(found) < 180


def test_sphere_is_smallest_on_known_shapes() -> None:
    cube = body(trimesh.creation.box((2.0, 2.0, 2.0)))
    center, radius = Sphere._bound(cube)
    assert center == pytest.approx(np.zeros(3), abs=1e-9)
    assert radius == pytest.approx(np.sqrt(3.0))
    rod = body(trimesh.creation.cylinder(0.1, 2.0))
    assert Sphere._bound(rod)[1] == pytest.approx(np.hypot(1.0, 0.1), rel=1e-6)


def test_sphere_contains_the_mesh_and_agrees_with_fcl(pair: tuple[Mesh, Mesh]) -> None:
    rng = np.random.default_rng(4)
    sphere, found = Sphere(*pair), []
    (center_a, radius_a), (center_b, radius_b) = (Sphere._bound(mesh) for mesh in pair)
    assert np.linalg.norm(pair[0].vertices - center_a, axis=1).max() <= radius_a
    at = [np.eye(4), np.eye(4)]
    for pose_a, pose_b in zip(tumble(rng, 800, 0.05), tumble(rng, 800, 0.05), strict=True):
        at[0][:3, 3], at[1][:3, 3] = move(pose_a, center_a), move(pose_b, center_b)
        found.append(sphere.collides(pose_a, pose_b))
        assert found[-1] == fcl_hit(fcl.Sphere(radius_a), at[0], fcl.Sphere(radius_b), at[1])
    assert 200 < sum(found) < 600


def separation(a: Floats, b: Floats) -> float:
    """Largest gap between point sets along a normal in [-1, 1]^3; 0 if there is none."""
    rows = np.block(
        [
            [a, -np.ones((len(a), 1)), np.ones((len(a), 1))],
            [-b, np.ones((len(b), 1)), np.ones((len(b), 1))],
        ]
    )
    found = linprog(
        [0, 0, 0, 0, -1],
        A_ub=rows,
        b_ub=np.zeros(len(rows)),
        bounds=[(-1, 1)] * 3 + [(None, None)] * 2,
    )
    return float(found.x[-1])


def test_hull_agrees_with_a_separating_plane(pair: tuple[Mesh, Mesh]) -> None:
    rng = np.random.default_rng(5)
    hulls, found = Hull(*pair), []
    a, b = (np.asarray(hull(mesh).vertices) for mesh in pair)
    for pose_a, pose_b in zip(tumble(rng, 150, 0.03), tumble(rng, 150, 0.03), strict=True):
        found.append(hulls.collides(pose_a, pose_b))
        assert found[-1] == (separation(move(pose_a, a), move(pose_b, b)) < 1e-9)
    assert 20 < sum(found) < 130


def test_voxels_are_the_cells_on_the_surface_by_fcl(pair: tuple[Mesh, Mesh]) -> None:
    mesh = pair[1]
    side, origin, ijk = voxels(mesh, 8)
    found = {tuple(cell) for cell in ijk.tolist()}
    model, at = surface(mesh), np.eye(4)
    for cell in np.ndindex(*(ijk.max(axis=0) + 1)):
        at[:3, 3] = origin + (np.array(cell) + 0.5) * side
        assert (cell in found) == fcl_hit(model, np.eye(4), fcl.Box(side, side, side), at)


def test_grid_agrees_with_all_cells_against_all(pair: tuple[Mesh, Mesh]) -> None:
    rng = np.random.default_rng(6)
    cells = 6
    grid, found = Grid(*pair, cells=cells), []
    (side_a, origin_a, ijk_a), (side_b, origin_b, ijk_b) = (voxels(m, cells) for m in pair)
    a, b = origin_a + (ijk_a + 0.5) * side_a, origin_b + (ijk_b + 0.5) * side_b
    half_a, half_b = np.full(3, side_a / 2), np.full(3, side_b / 2)
    for pose_a, pose_b in zip(tumble(rng, 150, 0.04), tumble(rng, 150, 0.04), strict=True):
        relative = np.linalg.inv(pose_a) @ pose_b
        offset = move(relative, b)[None] - a[:, None]
        brute = boxes_overlap(relative[:3, :3], offset, half_a, half_b)
        found.append(grid.collides(pose_a, pose_b))
        assert found[-1] == brute.any()
        assert grid.tests <= brute.size
    assert 20 < sum(found) < 130


def test_no_baseline_misses_intersecting_surfaces(pair: tuple[Mesh, Mesh]) -> None:
    rng = np.random.default_rng(7)
    models = [surface(mesh) for mesh in pair]
    pose_a = tumble(rng, 1, 1.0)[0]

    def truth(pose: Floats) -> bool:
        return fcl_hit(models[0], pose_a, models[1], pose)

    poses = random_poses(*pair, pose_a, 120, truth, rng)
    hits = [pose for pose in poses if truth(pose)]
    assert len(hits) > 20
    for name, kind in BASELINES.items():
        method = kind(*pair)
        assert all(method.collides(pose_a, pose) for pose in hits), name
        assert method.tests >= 1


def test_bounds_report_a_body_inside_another_and_surface_cells_do_not() -> None:
    shell = body(trimesh.creation.icosphere(3, 1.0))
    core = body(trimesh.creation.icosphere(2, 0.3))
    verdicts = {
        n: kind(shell, core).collides(np.eye(4), np.eye(4)) for n, kind in BASELINES.items()
    }
    assert verdicts == {"AABB": True, "OBB": True, "sphere": True, "hull": True, "grid": False}


def test_finer_cells_have_fewer_hits(pair: tuple[Mesh, Mesh]) -> None:
    rng = np.random.default_rng(8)
    poses = tumble(rng, 120, 0.05)
    grids = [Grid(*pair, cells=n) for n in (4, 12, 36)]
    hits = [sum(grid.collides(np.eye(4), pose) for pose in poses) for grid in grids]
    assert hits[0] >= hits[1] >= hits[2]
    assert hits[0] > hits[2]

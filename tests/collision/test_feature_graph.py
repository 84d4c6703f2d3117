"""Feature graphs: contents and guarantees; repairs of input meshes."""

from __future__ import annotations

import itertools
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracles.independent import distances_to_surface
from support.meshes import MeshPair, pairs

from fgenv.arrays import Floats
from fgenv.bench.common.poses import random_poses_batched
from fgenv.bench.common.solids import (
    Solid,
    angle_iron,
    at,
    ball,
    bowl,
    box,
    inverted,
    moved,
    opened,
    scaled,
    somewhere,
    together,
)
from fgenv.collision import FeatureGraph, MeshWarning, Shape, collide


def both_are_solid(pair: MeshPair) -> bool:
    """Penetration depth is defined only for solids."""
    return all(trimesh.Trimesh(m.vertices, m.faces).is_watertight for m in pair.load())


HERE = np.eye(4)
PAIRS = [pair for pair in pairs(40, largest=3000, seed=21) if both_are_solid(pair)][:4]
assert len(PAIRS) == 4
METHODS: list[dict[str, object]] = [
    {"method": "exact"},
    {"method": "crease"},
    {"method": "loop"},
    {"tolerance": 1e-2},
]

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


def kinds(graph: FeatureGraph) -> dict[str, int]:
    return {str(kind): int((graph.kinds == kind).sum()) for kind in np.unique(graph.kinds)}


# Contents of a graph


def test_a_cube_has_twelve_ridges() -> None:
    for chosen in ({"method": "exact"}, {"method": "crease"}, {"tolerance": 0.0}):
        graph = FeatureGraph(*box(2.0), **chosen)
        assert sorted(map(tuple, graph.points)) == sorted(itertools.product((-1.0, 1.0), repeat=3))
        assert len(graph.edges) == 12
        assert kinds(graph) == {"ridge": 12}
        ends = graph.points[graph.edges]
        assert np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) == pytest.approx(2.0)
        assert graph.tolerance == 0.0


def test_an_angle_iron_has_one_valley() -> None:
    graph = FeatureGraph(*angle_iron())
    assert kinds(graph) == {"ridge": 17, "valley": 1}
    ends = graph.points[graph.edges[graph.kinds == "valley"][0]]
    assert ends[:, :2] == pytest.approx(0.25)


def test_the_published_pair_of_thresholds() -> None:
    """theta is pi/2 along the valley and 3 pi/2 along the ridges."""
    half = math.pi / 2
    for valley, ridge, expected in (
        (half + 0.1, 3 * half - 0.1, {"ridge": 17, "valley": 1}),
        (half - 0.1, 3 * half - 0.1, {"ridge": 17}),
        (half + 0.1, 3 * half + 0.1, {"valley": 1}),
        (half - 0.1, 3 * half + 0.1, {}),
    ):
        graph = FeatureGraph(*angle_iron(), method="crease", angle=(valley, ridge))
        assert kinds(graph) == expected


def test_an_angle_is_a_bend_from_flat() -> None:
    for bend, count in ((1.4, 12), (1.6, 0)):
        assert len(FeatureGraph(*box(1.0), method="crease", angle=bend).edges) == count


def test_the_loop_is_one_cycle_in_the_order_found() -> None:
    graph = FeatureGraph(*box(1.0), method="loop")
    n = len(graph.points)
    assert n == 8
    assert graph.edges.tolist() == [[i, (i + 1) % n] for i in range(n)]
    assert kinds(graph) == {"chord": n}
    assert graph.tolerance is None


def test_a_ball_has_no_crease_and_every_edge_is_exact() -> None:
    graph = FeatureGraph(*ball(1.0, 3), method="crease")
    assert len(graph.points) == len(graph.edges) == 0
    assert graph.points.shape == (0, 3)
    assert graph.dense().shape == (0, 0)
    assert graph.tolerance == math.inf  # one patch turns by more than a right angle
    assert len(FeatureGraph(*ball(1.0, 3)).edges) == 3 * 1280 // 2


def test_borders_are_features() -> None:
    graph = FeatureGraph(*opened(box(1.0)))
    assert kinds(graph) == {"border": 4, "ridge": 8}


def test_an_edge_of_three_faces_is_a_feature() -> None:
    """Two coplanar triangles and a third that stands on their common edge."""
    vertices = [[0.0, 0, 0], [1.0, 0, 0], [0.5, 1, 0], [0.5, -1, 0], [0.5, 0, 1]]
    two, three = [[0, 1, 2], [1, 0, 3]], [[0, 1, 2], [1, 0, 3], [0, 1, 4]]
    assert len(FeatureGraph(vertices, two).edges) == 4
    graph = FeatureGraph(vertices, three)
    assert len(graph.edges) == 7
    assert [0.0, 0.0, 0.0] in graph.points.tolist()
    fin = Shape(vertices, three, tolerance=0.5)
    middle = Shape([[0.5, -0.1, -0.1], [0.5, 0.1, -0.1], [0.5, 0.0, 0.1]], [[0, 1, 2]])
    assert collide(fin, HERE, middle, HERE)


def test_faces_folded_flat_onto_each_other_end_at_their_edge() -> None:
    leaf = [[0.0, 0, 0], [1.0, 0, 0], [0.5, 1, 0], [0.4, 0.8, 0]]
    graph = FeatureGraph(leaf, [[0, 1, 2], [1, 0, 3]])
    assert [sorted(edge) for edge in graph.edges.tolist()].count([0, 1]) == 1


def test_exact_drops_flat_edges_only() -> None:
    """A cube with finely triangulated faces has only the subdivided edges of the cube."""
    fine = trimesh.Trimesh(*box(2.0)).subdivide().subdivide()
    graph = FeatureGraph(fine.vertices, fine.faces)
    assert len(graph.edges) == 12 * 4
    on_sides = (np.abs(np.abs(graph.points) - 1.0) < 1e-12).sum(axis=1)
    assert (on_sides >= 2).all()


@pytest.mark.parametrize("chosen", METHODS, ids=str)
@pytest.mark.parametrize(
    "solid",
    [box(1.0), ball(1.0, 1), angle_iron(), opened(bowl())],
    ids=["box", "ball", "L", "bowl"],
)
def test_the_packed_matrix_is_that_of_the_edges(solid: Solid, chosen: dict[str, Any]) -> None:
    graph = FeatureGraph(*solid, **chosen)
    n = len(graph.points)
    dense = np.zeros((n, n), np.bool_)
    dense[graph.edges[:, 0], graph.edges[:, 1]] = True
    dense |= dense.T
    assert (graph.dense() == dense).all()
    assert not dense.diagonal().any()
    packed = np.packbits(dense[np.triu_indices(n, 1)])
    assert graph.adjacency.dtype == np.uint8
    assert (graph.adjacency == packed).all()
    assert len(graph.kinds) == len(graph.edges)


@pytest.mark.parametrize("chosen", METHODS, ids=str)
def test_a_shape_carries_the_graph_of_its_mesh(chosen: dict[str, Any]) -> None:
    of_shape, alone = Shape(*angle_iron(), **chosen).graph, FeatureGraph(*angle_iron(), **chosen)
    assert (of_shape.points == alone.points).all()
    assert (of_shape.edges == alone.edges).all()
    assert of_shape.tolerance == alone.tolerance
    assert of_shape.method == alone.method


# Tolerance in meters


@pytest.mark.parametrize("tolerance", [1e-4, 1e-2, 5e-2, 0.3])
def test_a_wider_tolerance_keeps_fewer_edges(tolerance: float) -> None:
    solid = ball(0.5, 3)
    graph = FeatureGraph(*solid, tolerance=tolerance)
    assert graph.tolerance is not None
    assert graph.tolerance <= tolerance
    assert len(graph.edges) <= len(FeatureGraph(*solid, tolerance=tolerance / 3).edges)
    assert len(graph.edges) <= len(FeatureGraph(*solid).edges)


def test_patches_keep_to_their_slab_and_their_right_angle() -> None:
    """Thickness and normals of each patch of a ball, from the faces between patch borders."""
    shape = Shape(*ball(0.5, 3), tolerance=0.03)
    border = {
        frozenset(map(tuple, ends)) for ends in shape.graph.points[shape.graph.edges].tolist()
    }
    mesh = trimesh.Trimesh(shape.vertices, shape.faces, process=False)
    joined = [
        pair
        for pair, edge in zip(mesh.face_adjacency, mesh.face_adjacency_edges, strict=True)
        if frozenset(map(tuple, mesh.vertices[edge].tolist())) not in border
    ]
    patches = trimesh.graph.connected_components(joined, nodes=np.arange(len(mesh.faces)))
    assert 10 < len(patches) < len(mesh.faces)
    for patch in patches:
        normal = mesh.face_normals[patch]
        assert any(
            np.ptp(mesh.triangles[patch] @ n) <= 0.03 + 1e-12 and (normal @ n > 0).all()
            for n in normal
        )


BALLS = [(ball(0.5, 3), 0.5), (ball(0.4, 3), 0.4)]


@given(
    tolerances=st.tuples(*[st.floats(1e-4, 0.2)] * 2),
    seed=st.integers(0, 2**32 - 1),
)
def test_nothing_deeper_than_the_certificate_is_missed(
    tolerances: tuple[float, float], seed: int
) -> None:
    """Two balls; the overlap of balls with centers d apart is a lens (r1 + r2 - d) thick."""
    (one, r1), (two, r2) = BALLS
    a, b = (Shape(*s, tolerance=t) for s, t in zip((one, two), tolerances, strict=True))
    truth = Shape(*one), Shape(*two)
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(60, 3))
    way *= rng.uniform(0.0, 1.05 * (r1 + r2), size=(60, 1)) / np.linalg.norm(way, axis=1)[:, None]
    poses = np.stack([somewhere(rng) for _ in way])
    poses[:, :3, 3] = way
    found, hits = collide(a, HERE, b, poses), collide(*mixed(truth, poses))
    assert not (found & ~hits).any(), "a false hit"
    assert a.graph.tolerance is not None
    assert b.graph.tolerance is not None
    depth = 0.5 * np.minimum(r1 + r2 - np.linalg.norm(way, axis=1), 2 * r2)
    assert (depth[hits & ~found] <= a.graph.tolerance + b.graph.tolerance).all()


def mixed(truth: tuple[Shape, Shape], poses: Floats) -> tuple[Shape, Floats, Shape, Floats]:
    return truth[0], HERE, truth[1], poses


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: pair.name)
@pytest.mark.parametrize(
    "chosen",
    [
        {"tolerance": 0.01},
        {"tolerance": 0.3},
        {"tolerance": 0.1},
        {"method": "crease"},
        {"method": "crease", "angle": 0.1},
    ],
    ids=str,
)
def test_real_meshes_keep_the_certificate(pair: MeshPair, chosen: dict[str, Any]) -> None:
    """No false hits; the deepest sampled point of a missed overlap is within the bound."""
    meshes = pair.load()
    size = min(mesh.size for mesh in meshes)
    if "tolerance" in chosen:
        chosen = {"tolerance": chosen["tolerance"] * size}
    a, b = (Shape(m.vertices, m.faces, **chosen) for m in meshes)
    exact_a, exact_b = (Shape(m.vertices, m.faces) for m in meshes)

    def judge(poses: Floats) -> NDArray[np.bool_]:
        return np.asarray(collide(exact_a, HERE, exact_b, poses, threads=1))

    rng = np.random.default_rng(3)
    poses = random_poses_batched(*meshes, HERE, 300, judge, rng, (-3.0, 0.0))
    found, hits = collide(a, HERE, b, poses), collide(exact_a, HERE, exact_b, poses)
    assert not (found & ~hits).any()
    assert a.graph.tolerance is not None
    assert b.graph.tolerance is not None
    bound = a.graph.tolerance + b.graph.tolerance
    for pose in poses[hits & ~found][:20]:
        assert depth(exact_a, exact_b, pose, rng) <= bound * (1 + 1e-9)


def depth(a: Shape, b: Shape, pose: Floats, rng: np.random.Generator) -> float:
    """Depth of the deepest of many points inside both: distance to the nearer surface."""
    corners = np.concatenate([a.vertices, b.vertices @ pose[:3, :3].T + pose[:3, 3]])
    some = corners[rng.integers(len(corners), size=4000)]
    points = np.concatenate([corners, some + rng.normal(size=some.shape) * 0.02 * np.ptp(corners)])
    local = (points - pose[:3, 3]) @ pose[:3, :3]
    both = a.contains(points) & b.contains(local)
    if not both.any():
        return 0.0
    to_a, to_b = distances_to_surface(a, points[both]), distances_to_surface(b, local[both])
    return float(np.minimum(to_a, to_b).max())


def test_a_bump_that_sticks_out_does_not_hide_a_contained_body() -> None:
    """Only a vertex outside the feature graph protrudes: the graph's own points must be tested."""
    wall, inner = box(2.0), trimesh.creation.icosphere(subdivisions=3, radius=0.98)
    vertices = np.array(inner.vertices)
    vertices[np.argmax(vertices[:, 0])] *= 1.04 / 0.98  # a bump of one vertex through the wall
    bumped = Shape(vertices, np.array(inner.faces), tolerance=0.2)
    for tolerance in (0.0, 0.2):
        assert collide(Shape(*wall, tolerance=tolerance), HERE, bumped, HERE)


@pytest.mark.parametrize("chosen", [{"method": "crease"}, {"tolerance": 0.05}], ids=str)
def test_containment_is_seen_by_every_sound_method(chosen: dict[str, Any]) -> None:
    outer, inner = Shape(*box(2.0), **chosen), Shape(*box(0.3), **chosen)
    assert collide(outer, HERE, inner, HERE)
    assert collide(inner, HERE, outer, HERE)
    # a smooth body has no crease
    assert collide(outer, HERE, Shape(*ball(0.3), **chosen), HERE)
    hollow = Shape(*together(box(2.0), inverted(box(1.0))), **chosen)
    assert not collide(hollow, HERE, inner, HERE)


# Repairs of input meshes


def test_equal_vertices_are_merged() -> None:
    vertices, faces = box(1.0)
    soup = vertices[faces].reshape(-1, 3)
    shape = Shape(soup, np.arange(36).reshape(12, 3))
    assert len(shape.vertices) == 8
    assert shape.watertight
    assert shape.repairs["merged_vertices"] == 28
    assert kinds(shape.graph) == {"ridge": 12}


def test_negative_zero_is_zero() -> None:
    vertices = [[0.0, 0, 0], [1.0, 0, 0], [0.0, 1, 0], [-0.0, 0, -0.0], [0.0, 1, 0], [1.0, 0, 0]]
    shape = Shape(vertices, [[0, 1, 2], [3, 4, 5]])
    assert len(shape.vertices) == 3


def test_degenerate_faces_are_dropped() -> None:
    vertices, faces = box(1.0)
    vertices = np.vstack([vertices, [[9.0, 9.0, 9.0], 0.5 * (vertices[0] + vertices[1])]])
    extra = [faces[3], np.roll(faces[4], 1), [0, 0, 1], [0, 1, 9], [2, 2, 2]]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        shape = Shape(vertices, np.vstack([faces, extra]), name="crate")
    assert len(shape.faces) == 12
    assert len(shape.vertices) == 8
    assert shape.repairs["duplicate_faces"] == 2
    assert shape.repairs["degenerate_faces"] == 3
    assert shape.watertight
    (warning,) = [w for w in caught if issubclass(w.category, MeshWarning)]
    assert "crate" in str(warning.message)
    assert kinds(shape.graph) == {"ridge": 12}


def test_inconsistent_winding_is_repaired() -> None:
    vertices, faces = ball(1.0)
    turned = faces.copy()
    some = np.random.default_rng(4).choice(len(faces), len(faces) // 3, replace=False)
    turned[some] = turned[some][:, ::-1]
    shape = Shape(vertices, turned)
    assert shape.watertight
    assert shape.repairs["flipped_faces"] == len(some)
    volume = trimesh.Trimesh(shape.vertices, shape.faces, process=False).volume
    assert volume == pytest.approx(trimesh.Trimesh(vertices, faces).volume)
    assert collide(shape, HERE, Shape(*box(0.1)), HERE)


def test_shells_are_separated() -> None:
    both = together(moved(box(1.0), x=-2.0), moved(ball(0.5), x=2.0))
    shape = Shape(*both)
    assert shape.watertight
    half_open = together(moved(box(1.0), x=-2.0), moved(opened(ball(0.5)), x=2.0))
    assert not Shape(*half_open).watertight
    assert len(shape.faces) == len(both[1])


def test_solids_that_share_an_edge_are_closed() -> None:
    """Four faces around the common edge of two cubes."""
    twins = together(moved(box(1.0), 0.5, 0.5, 0.5), moved(box(1.0), -0.5, -0.5, 0.5))
    shape = Shape(*twins)
    assert len(shape.vertices) == 14
    assert shape.watertight
    pebble = Shape(*ball(0.1))
    for x, y, expected in ((0.5, 0.5, True), (-0.5, -0.5, True), (0.5, -0.5, False)):
        assert collide(shape, HERE, pebble, at(x, y, 0.5)) == expected


def test_a_moebius_strip_is_a_surface() -> None:
    n = 24
    turn = np.linspace(0, 2 * np.pi, n, endpoint=False)
    across = np.c_[
        np.cos(turn / 2) * np.cos(turn), np.cos(turn / 2) * np.sin(turn), np.sin(turn / 2)
    ]
    middle = np.c_[np.cos(turn), np.sin(turn), np.zeros(n)]
    vertices = np.vstack([middle - 0.2 * across, middle + 0.2 * across])
    faces = []
    for i in range(n):
        j, low, high = (i + 1) % n, 0, n
        near = (low + i, high + i)
        far = (low + j, high + j) if j else (high + j, low + j)
        faces += [[near[0], far[0], near[1]], [near[1], far[0], far[1]]]
    strip = Shape(vertices, faces)
    assert not strip.watertight
    assert collide(strip, HERE, Shape(*box(0.1)), at(1.0))
    assert not collide(strip, HERE, Shape(*box(0.1)), HERE)


def test_an_open_mesh_warns_once() -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        shape = Shape(*opened(box(1.0)), name="crate")
        collide(shape, HERE, shape, HERE)
        shape.raycast([0, 0, 0], [1, 0, 0])
    (warning,) = caught
    assert "crate" in str(warning.message)
    assert "watertight" in str(warning.message)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Shape(*box(1.0))


@pytest.mark.parametrize("extension", ["stl", "obj", "ply", "off", "glb", "dae"])
def test_every_format_comes_back_as_it_was(extension: str, tmp_path: Path) -> None:
    vertices, faces = angle_iron()
    path = tmp_path / f"iron.{extension}"
    trimesh.Trimesh(vertices * 1000.0, faces, process=False).export(path)
    shape = Shape.load(path, scale=0.001)
    assert shape.name == "iron"
    assert shape.watertight
    assert len(shape.faces) == len(faces)
    assert len(shape.vertices) == len(vertices)
    assert shape.bounds == pytest.approx(np.array([vertices.min(axis=0), vertices.max(axis=0)]))
    assert kinds(shape.graph) == {"ridge": 17, "valley": 1}
    same = Shape(vertices, faces)
    rng = np.random.default_rng(5)
    poses = np.stack([somewhere(rng, 0.5) for _ in range(100)])
    probe = Shape(*box(0.3))
    assert (collide(shape, HERE, probe, poses) == collide(same, HERE, probe, poses)).all()


def test_a_scene_of_several_meshes_becomes_one(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box((1, 1, 1)), transform=at(2.0))
    scene.add_geometry(trimesh.creation.box((1, 1, 1)), transform=at(-2.0))
    scene.export(tmp_path / "two.glb")
    shape = Shape.load(tmp_path / "two.glb")
    assert len(shape.faces) == 24
    assert shape.watertight
    assert shape.bounds == pytest.approx(np.array([[-2.5, -0.5, -0.5], [2.5, 0.5, 0.5]]))


def test_load_accepts_the_arguments_of_shape(tmp_path: Path) -> None:
    trimesh.Trimesh(*ball(1.0)).export(tmp_path / "ball.stl")
    assert Shape.load(tmp_path / "ball.stl", method="loop").method == "loop"
    assert Shape.load(str(tmp_path / "ball.stl"), tolerance=0.1).graph.tolerance == pytest.approx(
        0.1
    )
    assert Shape.load(tmp_path / "ball.stl", method="crease", angle=0.01, name="x").name == "x"
    assert np.ptp(scaled(ball(1.0), 2.0)[0]) == pytest.approx(
        np.ptp(Shape.load(tmp_path / "ball.stl", scale=2.0).vertices), rel=1e-6
    )

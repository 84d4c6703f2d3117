"""The published algorithm: analytic cases, its laws, its traversal against all pairs, and the
native method ``loop`` against it."""

from __future__ import annotations

from itertools import pairwise
from math import pi

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.bench.common.meshes import Mesh, load
from fgenv.bench.common.poses import random_poses, random_rotations
from fgenv.bench.comparison import PAIRS
from fgenv.bench.pairs.catalog import Pair
from fgenv.collision import FeatureGraph, Shape, collide
from fgenv.paper import method
from fgenv.paper.method import ALPHA_RIDGE, ALPHA_VALLEY, Node

L_OUTLINE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]


def arrays(mesh: trimesh.Trimesh) -> tuple[Floats, NDArray[np.int64]]:
    return np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64)


def node(mesh: trimesh.Trimesh, at: tuple[float, float, float] = (0, 0, 0), id: int = 0) -> Node:
    made = Node(id, f"body {id}", *arrays(mesh))
    made.pose[:3, 3] = at
    method.extract([made])
    return made


def l_shape() -> trimesh.Trimesh:
    """An L of three unit squares, one unit high; its only valley is the upright edge at (1, 1)."""
    fan = np.array([[3, 4, 5], [3, 5, 0], [3, 0, 1], [3, 1, 2]])
    walls = [[k, (k + 1) % 6, k + 6] for k in range(6)]
    walls += [[(k + 1) % 6, (k + 1) % 6 + 6, k + 6] for k in range(6)]
    vertices = [(x, y, z) for z in (0, 1) for x, y in L_OUTLINE]
    solid = trimesh.Trimesh(vertices, np.concatenate((fan[:, ::-1], fan + 6, walls)))
    assert solid.is_watertight
    assert solid.volume == pytest.approx(3.0)
    return solid


# 2.1 Feature points


def test_features_of_a_cube_are_its_corners_and_edges() -> None:
    vertices, faces = arrays(trimesh.creation.box())
    found = method.feature_points(vertices, faces)
    edges = method.feature_edges(vertices, faces)
    assert sorted(found) == list(range(8))
    assert len(edges) == 12  # of 18: the 6 diagonals are flat
    assert {kind for _, _, kind in edges} == {"ridge"}
    assert np.linalg.norm(np.subtract(*vertices[np.array([e[:2] for e in edges]).T]), axis=1) == (
        pytest.approx(np.ones(12))
    )


def test_a_finely_tessellated_sphere_has_no_features() -> None:
    sphere = arrays(trimesh.creation.icosphere(3))
    assert len(method.feature_points(*sphere)) == 0
    everything = method.feature_points(*sphere, alpha_valley=pi, alpha_ridge=pi)
    assert len(everything) == len(sphere[0])  # thresholds at flat: every vertex


def test_an_l_shape_has_ridges_and_one_valley() -> None:
    vertices, faces = arrays(l_shape())
    edges = method.feature_edges(vertices, faces)
    (valley,) = [vertices[[a, b]] for a, b, kind in edges if kind == "valley"]
    assert sorted(valley.tolist()) == [[1, 1, 0], [1, 1, 1]]
    assert len(edges) == 18  # two outlines and six upright edges; the diagonals are flat
    assert len(method.feature_points(vertices, faces)) == 12


def test_each_threshold_applies_to_its_own_kind() -> None:
    solid = arrays(l_shape())
    no_valley = method.feature_edges(*solid, alpha_valley=0.0)
    no_ridge = method.feature_edges(*solid, alpha_ridge=2 * pi)
    assert {kind for _, _, kind in no_valley} == {"ridge"}
    assert {kind for _, _, kind in no_ridge} == {"valley"}


def test_turning_the_surface_inside_out_swaps_valleys_and_ridges() -> None:
    vertices, faces = arrays(l_shape())
    swap = {"valley": "ridge", "ridge": "valley"}
    outward = {(min(a, b), max(a, b)): k for a, b, k in method.feature_edges(vertices, faces)}
    inward = method.feature_edges(vertices, faces[:, ::-1])
    assert {(min(a, b), max(a, b)): swap[k] for a, b, k in inward} == outward


@pytest.mark.parametrize("sides", [6, 12, 24])
def test_a_tie_with_the_threshold_is_no_feature(sides: int) -> None:
    prism = arrays(trimesh.creation.cylinder(1.0, 1.0, sections=sides))
    turn = 2 * pi / sides
    at, below = pi + turn, pi + turn - 1e-6
    upright = [(a, b) for a, b, _ in method.feature_edges(*prism, alpha_ridge=at)]
    heights = prism[0][np.array(upright)][..., 2]
    assert (np.ptp(heights, axis=1) < 0.5).all()  # the two rims alone
    assert len(method.feature_edges(*prism, alpha_ridge=below)) == len(upright) + sides


def test_feature_points_are_in_the_order_of_faces_and_edges() -> None:
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    faces = np.array([[3, 1, 2], [0, 2, 1], [0, 1, 3], [0, 3, 2]])
    assert list(method.interior_edges(faces)) == [
        (3, 1, 0, 2),
        (1, 2, 0, 1),
        (2, 3, 0, 3),
        (0, 2, 1, 3),
        (1, 0, 1, 2),
        (3, 0, 2, 3),
    ]
    assert method.feature_points(vertices, faces).tolist() == [3, 1, 2, 0]


def test_edges_without_a_dihedral_angle_give_no_features() -> None:
    square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]])
    assert method.feature_edges(square, np.array([[0, 1, 2]])) == []
    fin = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    assert method.feature_edges(square, fin) == []
    wound_alike = np.array([[0, 1, 2], [0, 1, 4]])
    assert method.feature_edges(square, wound_alike) == []
    assert len(method.feature_edges(square, np.array([[0, 1, 2], [1, 0, 4]]))) == 1


def test_one_bent_edge_gives_one_segment_and_a_flat_sheet_none() -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    bent = np.array([[0, 1, 2], [1, 0, 3]])
    assert method.feature_points(corners, bent).tolist() == [0, 1]
    assert method.head_to_tail(2).tolist() == [[0, 1]]
    corners[3] = [0, -1, 0]
    assert len(method.feature_points(corners, bent)) == 0
    assert method.head_to_tail(1).shape == method.head_to_tail(0).shape == (0, 2)


# 2.2 Feature graph


def test_packed_matrix_of_four_points_is_formula_2() -> None:
    packed = method.pack(method.head_to_tail(4), 4)
    assert method.unpack(packed, 4).astype(int).tolist() == [
        [0, 1, 0, 1],
        [1, 0, 1, 0],
        [0, 1, 0, 1],
        [1, 0, 1, 0],
    ]
    assert packed.tolist() == [0b10110100]  # (01)(02)(03)(12)(13)(23), two bits of padding


@given(st.integers(0, 60))
def test_the_cycle_is_simple(n: int) -> None:
    dense = method.unpack(method.pack(method.head_to_tail(n), n), n)
    degree = dense.sum(axis=0)
    assert not dense.diagonal().any()
    assert (dense == dense.T).all()
    assert degree.tolist() == [2] * n if n >= 3 else degree.sum() == 2 * (n == 2)
    walk = list(method.depth_first(method.pack(method.head_to_tail(n), n), n))
    assert walk == ([(i, (i + 1) % n) for i in range(n)] if n >= 3 else [(0, 1)] * (n == 2))


@given(st.integers(2, 14).flatmap(lambda n: hnp.arrays(bool, (n, n))))
def test_packing_and_traversal_keep_every_edge_of_any_graph(matrix: NDArray[np.bool_]) -> None:
    n = len(matrix)
    dense = np.triu(matrix, 1) | np.triu(matrix, 1).T
    edges = np.argwhere(np.triu(dense))
    packed = method.pack(edges, n)
    assert len(packed) == (n * (n - 1) // 2 + 7) // 8
    assert (packed == np.packbits(dense[np.triu_indices(n, 1)])).all()
    assert (method.unpack(packed, n) == dense).all()
    before = packed.copy()
    walked = [(min(e), max(e)) for e in method.depth_first(packed, n)]
    assert sorted(walked) == [tuple(e) for e in edges.tolist()]  # each once
    assert (packed == before).all()


def test_traversal_is_depth_first() -> None:
    edges = np.array([[0, 1], [0, 4], [1, 2], [2, 3]])
    walk = method.depth_first(method.pack(edges, 5), 5)
    assert list(walk) == [(0, 1), (1, 2), (2, 3), (0, 4)]


# 2.3 Motion range, 2.4 masks


def test_the_motion_box_contains_the_whole_polyline() -> None:
    path = np.array([[0.0, 0, 0], [3, -1, 0], [2, 5, 1]])
    assert method.motion_box(path).tolist() == [[0, -1, 0], [3, 5, 1]]
    assert method.in_box(np.array([3.0, 5, 1]), method.motion_box(path))
    assert not method.in_box(np.array([3.0, 5, 1.01]), method.motion_box(path))


def test_masks_as_in_figure_5() -> None:
    cube = trimesh.creation.box((0.2, 0.2, 0.2))
    places = {"R": (0, 0, 0), "A": (1, 1, 0), "B": (2, 0.5, 0), "C": (4, 0.5, 0)}
    scene = {name: node(cube, at, id) for id, (name, at) in enumerate(places.items())}
    path = np.array([[0.0, 0, 0], [1.5, 2, 0], [3, 2, 0]])
    bodies = list(scene.values())
    assert not any(n.collision_mask for n in bodies)
    method.set_masks(bodies, scene["R"], path)
    assert [n.collision_mask for n in bodies] == [1, 1, 1, 0]
    tested = [method.must_test(scene["R"], n) for n in bodies[1:]]
    assert tested == [True, True, False]
    method.set_masks(bodies, scene["R"], np.array([[0.0, 0, 0], [5, 1, 0]]))  # re-planned
    assert [n.collision_mask for n in bodies] == [1, 1, 1, 1]
    method.clear_masks(bodies)
    assert not any(method.must_test(scene["R"], n) for n in bodies)


@given(hnp.arrays(float, (6, 3), elements=st.floats(-2, 2)), st.integers(0, 5))
def test_masks_are_set_for_bodies_in_the_box_only(places: Floats, moving: int) -> None:
    nodes = [Node(i, "", np.empty((0, 3)), np.empty((0, 3), np.int64)) for i in range(6)]
    for n, at in zip(nodes, places, strict=True):
        n.pose[:3, 3] = at
        n.collision_mask = 1
    mover, path = nodes[moving], np.array([[-1.0, -1, -1], [1, 1, 1], [0, 0, 0]])
    method.set_masks(nodes, mover, path)
    inside = {n.id for n in nodes if (np.abs(n.position) <= 1).all()}
    assert {n.id for n in nodes if n.collision_mask} == inside | {moving}
    method.clear_masks(nodes)
    assert not any(n.collision_mask for n in nodes)


# 2.5 The test

TRIANGLE = np.array([[[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]])
SEGMENTS = [
    ((1, 1, -1), (1, 1, 1), True),  # through the middle
    ((1, 1, 1), (1, 1, 0), True),  # ends on the face: t = 1
    ((1, 1, 0), (1, 1, 1), True),  # starts on it: t = 0
    ((1, 1, 2), (1, 1, 0.5), False),  # stops above
    ((2, 2, -1), (2, 2, 1), True),  # through the edge
    ((0, 0, -1), (0, 0, 1), True),  # through a corner
    ((3, 3, -1), (3, 3, 1), False),  # intersects the plane beside the face
    ((-1, 1, 0), (5, 1, 0), False),  # within the plane: parallel
    ((-1, 1, 1), (5, 1, 1), False),  # parallel above
    ((2, 1, 1), (0, 1, -1), True),  # oblique
    ((1, 1, 1), (1, 1, 1), False),  # no length
]


@pytest.mark.parametrize(("p1", "p2", "hit"), SEGMENTS)
def test_segment_against_face(p1: list[float], p2: list[float], hit: bool) -> None:
    a, b = np.array([p1, p2], float)
    for corners in (TRIANGLE, TRIANGLE[:, ::-1], np.roll(TRIANGLE, 1, axis=1)):
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert method.segment_hits(a, b, corners, normals).tolist() == [hit]
        assert method.segment_hits(b, a, corners, normals).tolist() == [hit]


def all_pairs(mover: Node, target: Node) -> bool:
    """Oracle: every edge of the dense matrix against every face, by five signed volumes."""
    points = mover.feature_points @ mover.pose[:3, :3].T + mover.pose[:3, 3]
    vertices = target.vertices @ target.pose[:3, :3].T + target.pose[:3, 3]
    i, j = np.nonzero(np.triu(method.unpack(mover.feature_graph, len(points))))
    p, q = points[i][:, None], points[j][:, None]
    a, b, c = (vertices[target.faces[:, k]][None] for k in range(3))

    def volume(p: Floats, q: Floats, r: Floats, s: Floats) -> Floats:
        return np.asarray((np.cross(q - p, r - p) * (s - p)).sum(axis=-1))

    across = volume(p, a, b, c) * volume(q, a, b, c) <= 0
    turns = np.stack([volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)])
    return bool((across & ((turns >= 0).all(axis=0) | (turns <= 0).all(axis=0))).any())


def test_traversal_equals_all_edges_against_all_faces() -> None:
    rng = np.random.default_rng(11)
    mover = node(l_shape())
    target = node(trimesh.creation.annulus(0.6, 1.2, 0.8, sections=16))
    hits = 0
    for _ in range(300):
        mover.pose = trimesh.transformations.random_rotation_matrix(rng.random(3))
        mover.pose[:3, 3] = rng.normal(scale=0.9, size=3)
        found = method.collides(mover, target)
        assert found == all_pairs(mover, target)
        hits += found
    assert 60 < hits < 240


def test_two_cubes() -> None:
    a, b = node(trimesh.creation.box()), node(trimesh.creation.box())
    b.pose[:3, 3] = 0.5, 0.4, 0.3
    assert method.collides(a, b)
    b.pose[:3, 3] = 1.5, 0, 0
    assert not method.collides(a, b)


def test_the_published_form_is_unsound_as_documented() -> None:
    core, shell = node(trimesh.creation.box((0.2, 0.2, 0.2))), node(trimesh.creation.box())
    assert not method.collides(core, shell)  # containment
    ball = node(trimesh.creation.icosphere(3), (0.7, 0, 0))
    assert not method.collides(ball, shell)  # no features, no hits
    chord = node(l_shape())
    post = node(trimesh.creation.box((0.1, 0.1, 4)), (1.5, 1.25, 0.5))
    assert method.collides(chord, post)  # false: the chord (2, 1, 1), (0, 2, 0) leaves the L


# The flow of figure 6


def test_positions_keep_the_corners_and_the_step() -> None:
    path = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0.25, 0]])
    places, gone = zip(*method.positions(path, 0.1), strict=True)
    steps = [float(np.linalg.norm(b - a)) for a, b in pairwise(places)]
    assert max(steps) <= 0.1 + 1e-12
    assert gone == pytest.approx(np.cumsum([0, *steps]))
    assert any((place == path[1]).all() for place in places)
    assert (places[-1] == path[-1]).all()


def test_a_motion_stops_at_a_tank_and_clears_the_masks() -> None:
    tank = trimesh.creation.cylinder(0.4, 1.0, sections=24)
    robot = node(trimesh.creation.box((0.4, 0.4, 0.4)), (0, 0, 0), 0)
    tanks = [node(tank, at, k) for k, at in enumerate([(0, 3, 0), (2, 0, 0), (3, 0.5, 0)], 1)]
    scene = [robot, *tanks]
    hit = method.move(scene, robot, np.array([[0.0, 0, 0], [4, 1, 0]]), step=0.02)
    assert hit is not None
    assert (hit.mover, hit.other) == (0, 2)
    assert (hit.position == robot.position).all()
    assert 1.2 < hit.position[0] < 1.5
    assert hit.distance == pytest.approx(np.linalg.norm(hit.position))
    assert not any(n.collision_mask for n in scene)


def test_a_free_motion_reaches_the_goal() -> None:
    robot = node(trimesh.creation.box((0.4, 0.4, 0.4)), (0, 0, 0), 0)
    aside = node(trimesh.creation.box(), (0.5, 2.5, 0), 1)
    path = np.array([[0.0, 0, 0], [0, 1, 0], [3, 1, 0]])
    assert method.move([robot, aside], robot, path) is None
    assert robot.position.tolist() == [3, 1, 0]


# The native method `loop`

SMALL = PAIRS[1:5]  # the others have over a thousand feature points


def record(shape: Shape) -> Node:
    made = Node(0, shape.name, shape.vertices, shape.faces.astype(np.int64))
    method.extract([made])
    return made


def loops(a: Mesh, b: Mesh) -> tuple[Shape, Shape]:
    return Shape(a.vertices, a.faces, "loop"), Shape(b.vertices, b.faces, "loop")


def check_agreement(a: Mesh, b: Mesh, count: int, seed: int) -> int:
    """Compare native and published results on poses near contact and far away; return the hits."""
    rng = np.random.default_rng(seed)
    pose_a = np.eye(4)
    pose_a[:3, :3], pose_a[:3, 3] = random_rotations(rng, 1)[0], rng.normal(size=3)
    exact = Shape(a.vertices, a.faces), Shape(b.vertices, b.faces)

    def truth(pose: Floats) -> bool:
        return bool(collide(exact[0], pose_a, exact[1], pose))

    poses = random_poses(a, b, pose_a, count, truth, rng)
    mover, target = loops(a, b)
    native = collide(mover, pose_a, target, poses)
    slow_mover, slow_target = record(mover), record(target)
    slow_mover.pose = pose_a
    for pose, verdict in zip(poses, native, strict=True):
        slow_target.pose = pose
        assert method.collides(slow_mover, slow_target) == verdict
    return int(native.sum())


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: pair.name)
def test_native_points_and_packed_matrix_equal_the_published_ones(pair: Pair) -> None:
    for shape in loops(pair.a.load(), pair.b.load()):
        slow = record(shape)
        assert (shape.graph.points == slow.feature_points).all()
        assert (shape.graph.adjacency == slow.feature_graph).all()
        assert (shape.graph.edges == method.head_to_tail(len(slow.feature_points))).all()
        assert set(shape.graph.kinds) == {"chord"}
        assert shape.graph.tolerance is None


@pytest.mark.parametrize("pair", SMALL, ids=lambda pair: pair.name)
def test_native_loop_agrees_on_real_meshes(pair: Pair) -> None:
    a, b = pair.a.load(), pair.b.load()
    hits = check_agreement(a, b, 30, seed=1) + check_agreement(b, a, 30, seed=2)
    assert 10 < hits < 50


@pytest.mark.filterwarnings("ignore:mesh")  # repaired; not watertight
def test_native_loop_agrees_on_a_mesh_with_borders_and_non_manifold_edges() -> None:
    a = load("example-robot-data", "tiago_description/meshes/arm/arm_5-wrist-2010.stl")
    b = PAIRS[4].b.load()
    shapes = loops(a, b)
    assert not shapes[0].watertight
    assert (shapes[0].graph.points == record(shapes[0]).feature_points).all()
    assert 4 < check_agreement(a, b, 20, seed=6) < 16


@pytest.mark.slow
@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: pair.name)
def test_native_loop_agrees_on_many_poses(pair: Pair) -> None:
    a, b = pair.a.load(), pair.b.load()
    check_agreement(a, b, 120, seed=3)
    check_agreement(b, a, 120, seed=4)


def bent_sheet(p1: Floats, p2: Floats) -> Shape:
    """Two faces with the feature edge P1 P2: the graph is this segment."""
    off = np.cross(p2 - p1, [3.0, 5.0, 7.0])
    corners = np.array([p1, p2, p1 + off, p1 + np.cross(p2 - p1, off)])
    sheet = Shape(corners, [[0, 1, 2], [1, 0, 3]], "loop")
    assert len(sheet.graph.edges) == 1
    return sheet


@pytest.mark.filterwarnings("ignore:mesh")  # not watertight
def test_native_segment_test_agrees_on_whole_numbers() -> None:
    """Ends on the face, on its boundary, in its plane: both are exact."""
    rng = np.random.default_rng(5)
    target = Shape(TRIANGLE[0], [[0, 1, 2]])
    cases = [(p1, p2) for p1, p2, _ in SEGMENTS if p1 != p2]
    cases += list(rng.integers([-2, -2, -1], [6, 6, 2], size=(400, 2, 3)))
    hits = 0
    for p1, p2 in cases:
        p, q = np.array(p1, float), np.array(p2, float)
        if (p == q).all():
            continue
        sheet = bent_sheet(p, q)
        found = method.collides(record(sheet), record(target))
        assert collide(sheet, np.eye(4), target, np.eye(4)) == found, (p1, p2)
        hits += found
    assert hits > 50


@pytest.mark.parametrize("sides", [6, 10, 12, 15, 24, 36])
def test_native_thresholds_treat_a_tie_as_published(sides: int) -> None:
    prism = trimesh.creation.cylinder(1.0, 1.0, sections=sides)
    turn = 2 * pi / sides
    shape = Shape(prism.vertices, prism.faces, "loop", angle=turn)
    points = method.feature_points(
        shape.vertices, shape.faces.astype(np.int64), alpha_valley=pi - turn, alpha_ridge=pi + turn
    )
    assert (shape.graph.points == shape.vertices[points]).all()
    rims = FeatureGraph(prism.vertices, prism.faces, "crease", angle=turn)
    assert len(rims.edges) == 2 * sides


def test_native_loop_has_the_published_thresholds() -> None:
    solid = l_shape()
    only_ridges = Shape(solid.vertices, solid.faces, "loop", angle=(0.0, ALPHA_RIDGE))
    only_valley = Shape(solid.vertices, solid.faces, "loop", angle=(ALPHA_VALLEY, 2 * pi))
    assert len(only_ridges.graph.points) == 12
    assert sorted(only_valley.graph.points.tolist()) == [[1, 1, 0], [1, 1, 1]]

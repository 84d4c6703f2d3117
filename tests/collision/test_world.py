"""Laws of the World at one instant: results against a model that tests every pair."""

from __future__ import annotations

import copy
import itertools
import pickle
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from oracles.world_model import Model, along, carry, nudged, scatter, shapes, wander
from scipy.spatial import cKDTree

from fgenv.arrays import Floats
from fgenv.bench.common.solids import angle_iron, at, ball, box, opened, somewhere, turned
from fgenv.collision import Shape, collide
from fgenv.collision.world import World
from fgenv.paper import method

HERE = np.eye(4)
CUBE = Shape(*box(1.0))
TWINS: dict[str, Callable[[World], World]] = {
    "copy": World.copy,
    "copy.copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda world: pickle.loads(pickle.dumps(world)),
}

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


def mixed(seed: int, count: int = 24, reach: float = 0.8) -> tuple[World, Model]:
    """Random bodies: some carried, some allowed, some in groups."""
    rng = np.random.default_rng(seed)
    world, model = scatter(rng, count, reach)
    carry(world, model, 1, 0)
    carry(world, model, 3, 2)
    carry(world, model, 2, 1)  # 0 carries 1 carries 2 carries 3
    carry(world, model, 5, 4)
    for a, b in ((6, 7), (0, 8), (9, 3)):
        world.allow(a, b)
        model.allow(a, b)
    for name, groups in (("one", "a"), ("two", ("b", "c")), ("three", ["c"])):
        pose = somewhere(rng, 0.4)
        model.add(world.add(shapes()[0], pose, name=name, groups=groups), shapes()[0], pose, groups)
    world.allow_groups("a", "c")
    model.allow_groups("a", "c")
    return world, model


# Bodies


def test_bodies_are_added_and_removed() -> None:
    world = World()
    assert len(world) == 0
    assert world.ids.tolist() == []
    assert world.names == []
    crate = world.add(CUBE, at(1.0), name="crate", groups="things")
    other = world.add(CUBE)
    assert [crate, other] == world.ids.tolist() == [0, 1]
    assert world.names == ["crate", "body 1"]
    assert len(world) == 2
    assert (world.poses("crate") == at(1.0)).all()
    assert (world.poses(other) == HERE).all()
    world.remove("crate")
    assert world.ids.tolist() == [1]
    assert world.names == ["body 1"]
    world.remove(other)
    assert len(world) == 0
    again = world.add(CUBE, name="crate")  # the name is free again, the id is not
    assert again == 2
    assert world.record(again).groups == ()


def test_default_names_never_conflict() -> None:
    world = World()
    world.add(CUBE, name="body 1")
    assert world.add(CUBE) == 1
    assert len(set(world.names)) == 2


def test_ids_in_every_form_mean_the_same() -> None:
    world = World()
    ids = [world.add(CUBE, at(x), name=f"cube {x}") for x in range(4)]
    rows = np.stack([at(x) for x in range(4)])
    for same in (ids, tuple(ids), np.array(ids), np.array(ids, np.uint8), world.ids, world.names):
        assert (world.poses(same) == rows).all()
    several: tuple[Any, ...] = (2, np.int64(2), np.array(2), "cube 2")
    for one in several:
        assert world.poses(one).shape == (4, 4)
        assert (world.poses(one) == at(2)).all()
    assert world.poses([2]).shape == (1, 4, 4)
    assert world.poses([]).shape == (0, 4, 4)
    assert (world.poses([3, "cube 1", 3]) == rows[[3, 1, 3]]).all()


def test_bodies_are_placed_one_by_one_or_together() -> None:
    rng = np.random.default_rng(0)
    world = World()
    ids = [world.add(CUBE) for _ in range(5)]
    poses = wander(rng, 5, 3.0)
    world.set_pose(ids, poses)
    assert (world.poses(ids) == poses).all()
    world.set_pose(ids[1], poses[0])
    assert (world.poses(ids[1]) == poses[0]).all()
    world.set_pose(ids[2:4], poses[4])  # one for all
    assert (world.poses(ids[2:4]) == poses[4]).all()
    world.set_pose(ids[2:4], poses[:1])
    assert (world.poses(ids[2:4]) == poses[0]).all()
    world.set_pose([], poses[0])
    assert (world.poses(ids[4]) == poses[4]).all()
    poses[:] = np.nan  # arguments are copied
    assert np.isfinite(world.poses(ids)).all()


def test_an_iterable_of_bodies_may_query_the_world() -> None:
    """Python code that runs while a call reads its arguments must not meet the call's lock."""
    world = World()
    ids = [world.add(CUBE) for _ in range(3)]
    lazy: Any = (i for i in ids if world.mask(i) == 0)
    world.set_pose(lazy, at(1.0))
    assert (world.poses(ids)[:, 0, 3] == 1.0).all()


def test_a_record_has_the_published_fields() -> None:
    iron = Shape(*angle_iron(), method="crease", angle=0.3, name="iron")
    world = World()
    hand = world.add(CUBE, at(5.0), name="hand")
    held = world.add(iron, at(1.0, 2.0, 3.0), name="held", groups=("tools", "metal"))
    world.attach(held, hand)
    record = world.record("held")
    assert (record.id, record.name, record.carrier) == (held, "held", hand)
    assert record.position.tolist() == [1.0, 2.0, 3.0]
    assert (record.pose == at(1.0, 2.0, 3.0)).all()
    assert sorted(record.groups) == ["metal", "tools"]
    assert record.shape is iron
    assert (record.feature_points == iron.graph.points).all()
    assert (record.graph.adjacency == iron.graph.adjacency).all()
    assert record.mask == 0
    world.set_path(hand, [at(5.0), at(6.0)])
    assert world.record("held").mask == world.own_bit(hand) == 1
    assert world.record(hand).carrier is None


def test_size_of_a_world() -> None:
    world = World()
    empty = world.nbytes
    for x in range(100):
        world.add(CUBE, at(2.0 * x))
    assert empty < world.nbytes - 100 * 100
    assert "100" in repr(world)


# Contacts, collisions, clearance


@pytest.mark.parametrize("seed", range(4))
def test_contacts_agree_with_a_test_of_every_pair(seed: int) -> None:
    world, model = mixed(seed)
    for margin in (0.0, 0.03, 0.3):
        expected = model.contacts(margin)
        assert world.contact_pairs(margin=margin).tolist() == expected
        assert world.contact_pairs(margin=margin, threads=3).tolist() == expected
    assert 5 < len(model.contacts()) < len(model.items) ** 2 / 3


@pytest.mark.parametrize("seed", range(4))
def test_a_robot_collides_where_any_of_its_parts_meets_any_body(seed: int) -> None:
    world, model = mixed(seed)
    rng = np.random.default_rng(100 + seed)
    poses = wander(rng, 60, 0.9)
    mean = []
    for robot in model.roots:
        for margin in (0.0, 0.05):
            expected = model.collides(robot, poses, margin=margin)
            assert (world.collides(robot, poses, margin=margin) == expected).all()
            one = world.collides(robot, poses[0], margin=margin)
            assert isinstance(one, bool)
            assert one == expected[0]
        mean.append(expected.mean())
    assert 0.2 < np.mean(mean) < 0.9


def test_collisions_do_not_move_the_robot() -> None:
    world, model = mixed(9)
    before = world.poses(world.ids)
    rng = np.random.default_rng(1)
    poses = wander(rng, 5, 1.0)
    for robot in model.roots:
        world.collides(robot, poses)
        world.clearance(robot, poses)
        world.check_motion(robot, poses[:4], poses[1:])
        world.check_motions([robot], poses[:1], poses[1:2])
    assert (world.poses(world.ids) == before).all()


@pytest.mark.parametrize("seed", range(4))
def test_clearance_is_the_least_distance(seed: int) -> None:
    world, model = mixed(seed)
    rng = np.random.default_rng(200 + seed)
    poses = wander(rng, 40, 2.5)
    for robot in model.roots:
        apart = model.distances(robot, poses)
        ids, table = np.array(list(apart)), np.array(list(apart.values()))
        found = world.clearance(robot, poses)
        np.testing.assert_allclose(found.distance, table.min(axis=0), rtol=1e-9, atol=1e-12)
        assert ((found.distance == 0) == world.collides(robot, poses)).all()
        row = {int(body): i for i, body in enumerate(ids)}
        own = table[[row[body] for body in found.body.tolist()], np.arange(len(poses))]
        np.testing.assert_allclose(own, found.distance, rtol=1e-9, atol=1e-12)
        one = world.clearance(robot, poses[0])
        assert one.distance == found.distance[0]
        assert one.body == found.body[0]


def test_clearance_without_other_bodies() -> None:
    world = World()
    robot = world.add(CUBE)
    poses = np.tile(HERE, (300, 1, 1))
    for _ in range(2):
        found = world.clearance(robot, poses, threads=2)
        assert np.isinf(found.distance).all()
        assert (found.body == -1).all()
        world.allow(robot, world.add(CUBE))  # then a body that it may touch
    assert not world.collides(robot, HERE)
    assert world.check_motion(robot, HERE, at(1.0))


def test_ties_are_broken_by_id() -> None:
    """Independent of the order of additions, moves and removals."""
    for order in itertools.permutations(range(3)):
        world = World()
        robot = world.add(CUBE)
        gone = [world.add(CUBE, at(50.0 + i)) for i in range(3)]
        for i in order:  # reuses their places in the index in another order
            world.remove(gone[i])
        others = [world.add(CUBE, at(50.0 + i)) for i in range(3)]
        for i in order:
            world.set_pose(others[i], at(3.0))
        found = world.clearance(robot, HERE)
        assert (float(found.distance), int(found.body)) == (2.0, others[0])
        hit = world.raycast([0.0, 0.1, 0.2], [1.0, 0.0, 0.0], ignore=robot)
        assert (float(hit.distance), int(hit.body)) == (2.5, others[0])


def test_poses_and_times_broadcast() -> None:
    world = World()
    robot = world.add(CUBE)
    door = world.add(CUBE, at(9.0))
    world.set_trajectory(door, [0.0, 10.0], [at(0.0), at(10.0)])
    poses = np.stack([at(0.0), at(5.0), at(10.0)])
    times = np.array([0.0, 4.9, 7.0, 99.0])
    grid = world.collides(robot, poses[:, None], times=times)
    assert grid.astype(int).tolist() == [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
    apart = world.clearance(robot, poses[:, None], times=times)
    assert apart.distance.shape == (3, 4)
    np.testing.assert_allclose(apart.distance[1], [4.0, 0.0, 1.0, 4.0], atol=1e-12)
    assert world.collides(robot, poses[1], times=4.9) is True
    assert world.collides(robot, poses[0], times=times).tolist() == [True, False, False, False]
    assert world.collides(robot, poses[:0]).shape == (0,)
    assert world.collides(robot, poses).tolist() == [False, False, True]  # without a time: as set
    assert world.clearance(robot, at(9.0)).distance == 0.0


@pytest.mark.parametrize("seed", range(3))
def test_bodies_collide_at_their_places_on_trajectories(seed: int) -> None:
    world, model = mixed(seed, count=12)
    rng = np.random.default_rng(300 + seed)
    for body in (0, 4, 6, 10):
        times = np.sort(rng.uniform(0.0, 10.0, size=rng.integers(1, 5)))
        poses = wander(rng, len(times), 1.0)
        world.set_trajectory(body, times, poses)
        model.set_trajectory(body, times, poses)
    poses, times = wander(rng, 60, 1.2), rng.uniform(-2.0, 12.0, size=60)
    for robot in model.roots:
        for margin in (0.0, 0.05):
            expected = model.collides(robot, poses, times, margin)
            assert (world.collides(robot, poses, times=times, margin=margin) == expected).all()
        apart = np.min(list(model.distances(robot, poses, times).values()), axis=0)
        found = world.clearance(robot, poses, times=times)
        np.testing.assert_allclose(found.distance, apart, rtol=1e-9, atol=1e-12)
        assert (world.collides(robot, poses) == model.collides(robot, poses)).all()
    world.set_trajectory(0, None, None)
    model.set_trajectory(0, None, None)
    assert (world.collides(8, poses, times=times) == model.collides(8, poses, times)).all()


# Rays


@pytest.mark.parametrize("seed", range(3))
def test_rays_meet_the_nearest_body(seed: int) -> None:
    world, model = mixed(seed)
    rng = np.random.default_rng(400 + seed)
    origins, directions = rng.normal(size=(2, 300, 3)) * [[[3.0]], [[1.0]]]
    directions[:200] -= origins[:200]
    directions[200:203] = np.eye(3)
    expected = {
        body: item.shape.raycast(origins, directions, item.pose)[0]
        for body, item in model.items.items()
    }
    named = {name: world.record(name).id for name in ("one", "two")}
    most = list(model.items)[:-1]
    cases: list[tuple[Any, Sequence[int]]] = [
        (None, ()),
        (4, (4,)),
        ("two", (named["two"],)),
        ([0, "one", 9, 0], (0, named["one"], 9)),
        (np.array(most), most),
    ]
    for ignore, skipped in cases:
        left = {body: hits for body, hits in expected.items() if body not in skipped}
        nearest = np.min(list(left.values()), axis=0)
        found = world.raycast(origins, directions, ignore=ignore)
        np.testing.assert_allclose(found.distance, nearest, rtol=1e-12)
        assert ((found.body >= 0) == np.isfinite(nearest)).all()
        for i in np.flatnonzero(found.body >= 0):
            assert left[int(found.body[i])][i] == pytest.approx(nearest[i], rel=1e-12)
    near = world.raycast(origins, directions, 2.0)
    whole = world.raycast(origins, directions)
    assert np.isfinite(whole.distance).mean() > 0.2
    assert (near.distance == np.where(whole.distance <= 2.0, whole.distance, np.inf)).all()
    assert (near.body == np.where(whole.distance <= 2.0, whole.body, -1)).all()
    assert 0 < np.isfinite(near.distance).sum() < np.isfinite(whole.distance).sum()


def test_rays_broadcast_and_may_be_long() -> None:
    world = World()
    assert world.raycast([0, 0, 0], [1, 0, 0]).body == -1
    wall = world.add(CUBE, at(1e6))
    found = world.raycast(
        np.zeros((2, 1, 3)), [[1.0, 0, 0], [0.0, 1, 0], [1e-9, 0, 0], [1, 1e-7, 0]]
    )
    assert found.distance.shape == found.body.shape == (2, 4)
    assert found.body[1].tolist() == [wall, -1, wall, wall]
    assert found.distance[0, 0] == pytest.approx(1e6 - 0.5, rel=1e-15)


# Filters


def test_allowed_contacts_are_no_collision() -> None:
    world = World()
    a, b, c = (world.add(CUBE, at(0.5 * x), groups=g) for x, g in ((0, "g"), (1, "h"), (2, ())))
    everything = [[a, b], [a, c], [b, c]]
    assert world.contact_pairs().tolist() == everything
    world.allow(b, a)
    assert world.contact_pairs().tolist() == everything[1:]
    assert world.collides(a, HERE)  # c still
    world.allow(a, c)
    assert not world.collides(a, HERE)
    assert world.check_motion(a, HERE, at(1.0))
    nearest = world.clearance(a, HERE)
    assert (float(nearest.distance), int(nearest.body)) == (np.inf, -1)
    assert world.check_motions([a, b], [HERE, HERE], [HERE, HERE]).other.tolist() == [-1, c]
    world.allow(a, b, False)
    world.allow(c, a, allowed=False)
    assert world.contact_pairs().tolist() == everything
    world.allow_groups("h", "g")
    assert world.contact_pairs().tolist() == everything[1:]
    world.allow_groups("g", "h", False)
    assert world.contact_pairs().tolist() == everything
    world.allow_groups("g", "g")  # within a group
    assert world.contact_pairs().tolist() == everything
    world.add(CUBE, groups=["x", "g"])
    assert [a, 3] not in world.contact_pairs().tolist()
    assert [b, 3] in world.contact_pairs().tolist()


def test_a_filter_ends_with_the_body() -> None:
    world = World()
    a, b = world.add(CUBE), world.add(CUBE)
    world.allow(a, b)
    world.remove(b)
    c = world.add(CUBE)
    assert world.contact_pairs().tolist() == [[a, c]]


# Carried bodies


def test_a_carrier_moves_what_it_carries() -> None:
    rng = np.random.default_rng(5)
    world, model = scatter(rng, 8, 1.0)
    carry(world, model, 1, 0)
    carry(world, model, 2, 1)
    carry(world, model, 4, 3)
    carry(world, model, 3, 2)  # includes carried bodies
    for _ in range(5):
        apart = {i: np.linalg.inv(world.poses(0)) @ world.poses(i) for i in (1, 2, 3, 4)}
        pose = somewhere(rng, 2.0)
        world.set_pose(0, pose)
        model.set_pose(0, pose)
        for i, offset in apart.items():
            np.testing.assert_allclose(world.poses(i), pose @ offset, atol=1e-12)
    assert world.contact_pairs().tolist() == model.contacts()
    world.detach(3)
    model.detach(3)
    before = world.poses(world.ids)
    world.set_pose(0, at(30.0))
    model.set_pose(0, at(30.0))
    moved = (world.poses(world.ids) != before).any(axis=(1, 2))
    assert moved.tolist() == [True, True, True, False, False, False, False, False]
    assert world.record(4).carrier == 3
    poses = wander(rng, 40, 1.0)
    for robot in model.roots:
        assert (world.collides(robot, poses) == model.collides(robot, poses)).all()


def test_parts_of_a_robot_never_meet_each_other() -> None:
    world = World()
    a, b, c = (world.add(CUBE, at(0.2 * i)) for i in range(3))
    world.attach(b, a)
    world.attach(c, b)
    assert world.contact_pairs().tolist() == []
    assert not world.collides(a, at(7.0))
    assert world.clearance(a, HERE).body == -1
    assert world.check_motion(a, HERE, turned(3.0))
    world.detach(b)  # c moves along
    assert world.contact_pairs().tolist() == [[a, b], [a, c]]


def test_bodies_of_a_removed_carrier_stay() -> None:
    """Removal at the end of a chain, in the middle and at its root."""
    for gone in range(3):
        world = World()
        chain = [world.add(CUBE, at(3.0 * i)) for i in range(3)]
        world.attach(1, 0)
        world.attach(2, 1)
        before = world.poses(chain)
        world.remove(gone)
        left = [i for i in chain if i != gone]
        assert world.ids.tolist() == left
        assert (world.poses(left) == before[left]).all()
        carriers = {0: [None, 1], 1: [None, None], 2: [None, 0]}[gone]
        assert [world.record(i).carrier for i in left] == carriers
        assert world.contact_pairs().tolist() == []
        free = [i for i in left if world.record(i).carrier is None]
        world.set_pose(free, [at(0.0, 10.0 * i) for i in free])
        for i in free:
            assert not world.collides(i, at(0.0, 0.0, 50.0))
            assert world.collides(i, at(0.0, 10.0 * free[0])) == (i != free[0])


def test_attaching_deletes_path_and_trajectory() -> None:
    world = World()
    hand, cup = world.add(CUBE), world.add(CUBE, at(3.0))
    other = world.add(CUBE, at(9.0))
    world.set_path(cup, [at(3.0), at(9.0)])
    world.set_trajectory(cup, [0.0, 1.0], [at(3.0), at(9.0)])
    assert world.mask(other) == 1
    world.attach(cup, hand)
    assert world.mask(other) == world.mask(cup) == 0
    assert not world.collides(other, at(9.0), times=1.0)
    world.set_trajectory(hand, [0.0, 1.0], [HERE, at(6.0)])  # the cup moves along
    assert world.collides(other, at(9.0), times=1.0)
    assert not world.collides(other, at(9.0), times=0.5)


# Masks as bits


def test_every_mover_has_a_bit_of_its_own() -> None:
    """Any number of movers: masks are Python integers without a limit."""
    world = World()
    movers = [world.add(CUBE, at(3.0 * i)) for i in range(150)]
    wall = world.add(Shape(*box(1000.0, 0.1, 1.0)), at(0.0, 5.0))
    for mover in movers:
        x = world.poses(mover)[0, 3]
        world.set_path(mover, [at(x), at(x, 10.0)])
    bits = [world.own_bit(mover) for mover in movers]
    assert sorted(bits) == [1 << i for i in range(150)]
    assert world.mask(wall) == sum(bits) == (1 << 150) - 1
    for mover, bit in zip(movers, bits, strict=True):
        assert world.mask(mover) == bit  # lanes that do not meet
        assert world.candidates(mover).tolist() == [wall]
    world.clear_path(movers[70])
    assert world.mask(wall) == sum(bits) - bits[70]
    world.set_path(movers[3], [at(0.0, 50.0)])  # the bits of other movers do not change
    assert [world.own_bit(mover) for mover in movers[71:]] == bits[71:]
    world.set_path(movers[70], [at(210.0), at(210.0, 10.0)])
    assert len({world.own_bit(mover) for mover in movers}) == 150
    world.remove(wall)
    for mover in movers:
        world.clear_path(mover)
    assert {world.mask(mover) for mover in movers} == {0}
    assert {world.own_bit(mover) for mover in movers} == {0}


@pytest.mark.parametrize("seed", range(10))
def test_published_masks_are_those_of_the_reference(seed: int) -> None:
    """The paper's masks: positions of bodies in the box of the way points, one bit for all."""
    rng = np.random.default_rng(seed)
    world, model = scatter(rng, 30, 1.0, masks="published")
    nodes = [
        method.Node(body, f"{body}", item.shape.vertices, item.shape.faces.astype(int), item.pose)
        for body, item in model.items.items()
    ]
    path = wander(rng, int(rng.integers(1, 4)), 1.0)
    found = world.set_path(0, path)
    method.set_masks(nodes, nodes[0], path[:, :3, 3])
    assert [world.mask(node.id) for node in nodes] == [node.collision_mask for node in nodes]
    expected = method.candidates(nodes, nodes[0], path[:, :3, 3])
    assert found.tolist() == world.candidates(0).tolist() == [node.id for node in expected]
    box_ = method.motion_box(path[:, :3, 3])
    assert (world.motion_boxes(0) == box_).all()
    world.clear_path(0)
    assert {world.mask(node.id) for node in nodes} == {0}


def test_published_masks_miss_bodies_that_reach_in() -> None:
    """Shows that they are unsound: for comparison only."""
    worlds = [World(masks=m) for m in ("published", "path", "off")]
    for world in worlds:
        world.add(CUBE, name="robot")
        world.add(Shape(*box(1.0, 40.0, 1.0)), at(5.0, 19.0), name="wall")
        world.set_path("robot", [HERE, at(10.0)])
        assert world.masks in ("published", "path", "off")
    assert [world.collides("robot", at(5.0)) for world in worlds] == [False, True, True]
    assert [bool(world.check_motion("robot", HERE, at(10.0))) for world in worlds] == [
        True,
        False,
        False,
    ]


def test_masks_save_tests() -> None:
    rng = np.random.default_rng(7)
    counts = {}
    for masks in ("path", "off"):
        world, _ = scatter(np.random.default_rng(6), 200, 6.0, masks=masks)
        pose = world.poses(0)
        world.set_path(0, [pose, nudged(rng, pose, 0.5)])
        assert world.tests == 0
        world.collides(0, along(pose, nudged(rng, pose, 0.2), np.linspace(0, 1, 50)))
        counts[masks] = world.tests
    assert counts["path"] < counts["off"] / 10


# Copies


def furnished(seed: int) -> tuple[World, Model, np.random.Generator]:
    """A world with all features, and with ids, names and bits out of order."""
    rng = np.random.default_rng(seed)
    world, model = mixed(seed, count=14)
    world.add(CUBE, name="gone")
    world.remove("gone")
    for body in (4, 6):
        times, poses = np.array([0.0, 1.0, 3.0]), wander(rng, 3, 1.0)
        world.set_trajectory(body, times, poses)
        model.set_trajectory(body, times, poses)
    world.remove(11)
    model.remove(11)
    world.set_pose(0, pose := somewhere(rng, 0.5))
    model.set_pose(0, pose)
    for robot in (13, 0, 7):
        world.set_path(robot, wander(rng, 3, 1.0))
    return world, model, rng


@pytest.mark.parametrize("how", TWINS)
def test_a_copy_is_the_same(how: str) -> None:
    world, _, _ = furnished(1)
    twin = TWINS[how](world)
    assert type(twin) is World
    assert twin is not world
    assert twin.ids.tolist() == world.ids.tolist()
    assert twin.names == world.names
    assert twin.masks == world.masks
    for body in world.ids.tolist():
        one, other = world.record(body), twin.record(body)
        assert (one.id, one.name, one.groups, one.carrier) == (
            other.id,
            other.name,
            other.groups,
            other.carrier,
        )
        assert (one.pose == other.pose).all()
        assert (one.shape is other.shape) == (how != "pickle")
    if how == "pickle":  # bodies that shared a shape still do
        same = [[world.record(i).shape is world.record(j).shape for i in (0, 5)] for j in world.ids]
        kept = [[twin.record(i).shape is twin.record(j).shape for i in (0, 5)] for j in world.ids]
        assert same == kept


@pytest.mark.parametrize("how", TWINS)
def test_a_copy_has_the_same_paths_and_masks(how: str) -> None:
    world, model, _ = furnished(2)
    twin = TWINS[how](world)
    assert [twin.mask(body) for body in world.ids] == [world.mask(body) for body in world.ids]
    for robot in model.roots:
        assert twin.own_bit(robot) == world.own_bit(robot)
    for robot in (13, 0, 7):
        assert twin.candidates(robot).tolist() == world.candidates(robot).tolist()
        assert (twin.motion_boxes(robot) == world.motion_boxes(robot)).all()


@pytest.mark.parametrize("how", TWINS)
def test_a_copy_goes_on_as_the_original(how: str) -> None:
    """Results are equal bit for bit, and copies are independent."""
    world, _, rng = furnished(3)
    twin = TWINS[how](world)
    poses, times = wander(rng, 30, 1.0), rng.uniform(0.0, 4.0, size=30)

    def answers(w: World) -> bytes:
        parts = [
            w.contact_pairs(),
            w.contact_pairs(margin=0.1),
            *w.raycast(poses[:, :3, 3], poses[:, :3, 0]),
        ]
        for robot in (0, 4, 6, 7, 13):
            parts += [w.collides(robot, poses), w.collides(robot, poses, times=times)]
            parts += w.clearance(robot, poses, times=times)
            parts += w.check_motion(robot, poses[:-1], poses[1:], start_time=0.0, end_time=2.0)[:5]
        parts += [w.poses(w.ids), *(w.candidates(robot) for robot in (0, 7))]
        return b"".join(np.ascontiguousarray(part).tobytes() for part in parts)

    def change(w: World) -> None:
        new = w.add(CUBE, poses[0], name="new")
        w.set_pose([0, 4, new], poses[1:4])
        w.remove(10)
        w.attach(new, 0)
        w.detach(2)
        w.clear_path(13)
        w.set_path(8, poses[5:7])

    before = answers(world)
    assert answers(twin) == before
    change(world)
    assert answers(twin) == before
    change(twin)
    assert twin.ids.tolist() == world.ids.tolist()
    assert answers(twin) == answers(world) != before


@pytest.mark.parametrize("how", TWINS)
def test_an_empty_world_copies(how: str) -> None:
    for masks in ("path", "published", "off"):
        twin = TWINS[how](World(masks=masks))
        assert twin.masks == masks
        assert len(twin) == 0
        assert twin.add(CUBE) == 0


def test_a_copy_outlives_the_original() -> None:
    world = World()
    a, b = world.add(Shape(*ball(0.6))), world.add(Shape(*box(1.0)))
    twin = world.copy()
    world.remove(a)
    del world
    assert twin.contact_pairs().tolist() == [[a, b]]


# Many bodies


def test_thousands_of_bodies_are_added_moved_and_removed() -> None:
    """The index is built, refitted and rebuilt; contacts agree with those of all near pairs."""
    rng = np.random.default_rng(8)
    small = Shape(*box(0.2))
    world = World()
    there: dict[int, Floats] = {}

    def agrees() -> int:
        ids = np.array(sorted(there))
        poses = np.stack([there[i] for i in ids.tolist()])
        assert world.ids.tolist() == ids.tolist()
        near = cKDTree(poses[:, :3, 3]).query_pairs(0.35, output_type="ndarray")
        near = near[np.lexsort(near.T[::-1])]
        i, j = near[collide(small, poses[near[:, 0]], small, poses[near[:, 1]])].T
        assert world.contact_pairs().tolist() == np.c_[ids[i], ids[j]].tolist()
        return len(i)

    for reach in (2.0, 2.0, 2.5, 0.2, 3.0):
        for pose in wander(rng, 500, reach):
            there[world.add(small, pose)] = pose
        agrees()
        for body in rng.choice(list(there), size=100, replace=False).tolist():
            world.remove(body)
            del there[body]
        agrees()
        for count in (1, 9, len(there) // 5, len(there) // 2):
            some = rng.choice(list(there), size=count, replace=False)
            poses = wander(rng, count, 2.0)
            world.set_pose(some, poses)
            there.update(zip(some.tolist(), poses, strict=True))
            assert agrees() > 5


def test_open_shapes_have_no_inside() -> None:
    world = World()
    tray = world.add(Shape(*opened(box(1.0))))
    pebble = world.add(Shape(*ball(0.1)))
    assert world.contact_pairs().tolist() == []
    assert not world.collides(pebble, HERE)
    assert world.clearance(pebble, HERE).body == tray
    shut = world.add(CUBE)
    assert world.collides(pebble, at(0.1))
    nearest = world.clearance(pebble, HERE)
    assert (float(nearest.distance), int(nearest.body)) == (0.0, shut)

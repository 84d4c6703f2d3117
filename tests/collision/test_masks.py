"""Laws of the masks: they never hide a collision, and they reduce the candidates.

Random motions in worlds with paths, in which bodies are added, moved, removed and carried, against
a world without masks and against all pairs at random instants.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.world_model import Model, along, nudged, shapes, wander
from support import CASES

from fgenv.arrays import Floats
from fgenv.bench.common.solids import at, box, somewhere, turned
from fgenv.collision import Shape
from fgenv.collision.world import MotionResult, World

HERE = np.eye(4)
CUBE = Shape(*box(1.0))
SIZE = 1.2  # meters: about how far bodies are from the origin
END = 4.0  # seconds: when trajectories end

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


class Stage:
    """The same bodies in a world with masks, in one without, and in a model."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.on, self.off, self.model = World(), World(masks="off"), Model()
        self.paths: dict[int, Floats] = {}
        for _ in range(9):
            self.add()
        self.all("attach", 1, 0)
        self.all("attach", 3, 2)
        for robot in (0, 2):
            self.plan(robot)
        self.let_go(4)

    def all(self, change: str, *arguments: Any) -> None:
        for one in (self.on, self.off, self.model):
            getattr(one, change)(*arguments)

    def some(self, bodies: list[int]) -> int:
        return int(self.rng.choice(bodies))

    def add(self) -> None:
        pool = shapes()
        shape, pose = pool[self.rng.integers(len(pool))], somewhere(self.rng, SIZE)
        groups = [str(name) for name in self.rng.choice(["a", "b", "c"], size=1)]
        body = self.on.add(shape, pose, groups=groups)
        assert self.off.add(shape, pose, groups=groups) == body
        self.model.add(body, shape, pose, groups)

    def remove(self) -> None:
        body = self.some([b for b in self.model.items if b not in (0, 2)])
        if len(self.model.items) > 6:
            self.all("remove", body)
            self.paths.pop(body, None)

    def move(self) -> None:
        self.all("set_pose", self.some(self.model.roots), somewhere(self.rng, SIZE))

    def come(self) -> None:
        """Move a body into the path of a robot."""
        robot = self.some(list(self.paths))
        others = [b for b in self.model.roots if b != robot]
        pose = self.paths[robot][self.rng.integers(len(self.paths[robot]))]
        self.all("set_pose", self.some(others), nudged(self.rng, pose, 0.1))

    def attach(self) -> None:
        body = self.some([b for b in self.model.roots if b not in (0, 2)])
        carrier = self.some([b for b in self.model.items if self.model.root(b) != body])
        self.all("attach", body, carrier)
        self.paths.pop(body, None)

    def detach(self) -> None:
        carried = [b for b, item in self.model.items.items() if item.carrier is not None]
        if carried:
            self.all("detach", self.some(carried))

    def allow(self) -> None:
        a, b = (int(x) for x in self.rng.choice(list(self.model.items), size=2, replace=False))
        self.all("allow", a, b, bool(self.rng.random() < 0.5))

    def allow_groups(self) -> None:
        a, b = (str(x) for x in self.rng.choice(["a", "b", "c"], size=2))
        self.all("allow_groups", a, b, bool(self.rng.random() < 0.3))

    def plan(self, robot: int | None = None) -> None:
        if robot is None:
            robot = self.some(self.model.roots)
        steps = [somewhere(self.rng, SIZE)]
        for _ in range(self.rng.integers(0, 4)):
            steps.append(nudged(self.rng, steps[-1], 0.6, 1.0))
        self.paths[robot] = np.stack(steps)
        for world in (self.on, self.off):
            world.set_path(robot, self.paths[robot])

    def clear(self) -> None:
        robot = self.some(list(self.paths))
        if robot not in (0, 2):
            self.on.clear_path(robot)
            self.off.clear_path(robot)
            del self.paths[robot]

    def let_go(self, body: int | None = None) -> None:
        """Set or delete a body's trajectory."""
        body = self.some(self.model.roots) if body is None else body
        times = np.sort(self.rng.uniform(0.0, END, size=self.rng.integers(1, 4)))
        poses = wander(self.rng, len(times), SIZE)
        if self.rng.random() < 0.2:
            self.all("set_trajectory", body, None, None)
        else:
            self.all("set_trajectory", body, times, poses)

    def change(self) -> None:
        changes = (
            *(self.add, self.remove, self.move, self.move, self.come, self.come, self.attach),
            *(self.detach, self.allow, self.allow_groups, self.plan, self.clear, self.let_go),
        )
        changes[self.rng.integers(len(changes))]()


def motions(stage: Stage, robot: int, count: int) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Start poses, end poses, and flags of the motions along legs of the robot's path."""
    rng, path = stage.rng, stage.paths[robot]
    leg = rng.integers(max(len(path) - 1, 1), size=count)
    first, last = path[leg], path[np.minimum(leg + 1, len(path) - 1)]
    piece = np.sort(rng.random((2, count)), axis=0)
    piece[0, : count // 8], piece[1, : count // 8] = 0.0, 1.0
    starts, ends = along(first, last, piece[0]), along(first, last, piece[1])
    along_path = rng.random(count) < 0.7
    others = wander(rng, count, SIZE), wander(rng, count, 0.3)
    starts = np.where(along_path[:, None, None], starts, others[0])
    elsewhere = starts @ others[1]
    elsewhere[:, :3, 3] = starts[:, :3, 3] + others[1][:, :3, 3]
    return starts, np.where(along_path[:, None, None], ends, elsewhere), along_path


def hides_nothing(stage: Stage, count: int) -> tuple[int, int]:
    """Check `count` motions of a robot with a path: numbers of free ones and of candidates."""
    rng = stage.rng
    robot = stage.some(list(stage.paths))
    starts, ends, along_path = motions(stage, robot, count)
    window = None if rng.random() < 0.5 else np.sort(rng.uniform(-0.5, END + 0.5, size=2))
    margin = 0.0 if rng.random() < 0.7 else 0.05
    how: dict[str, Any] = {"margin": margin, "threads": 1}
    if window is not None:
        how |= {"start_time": window[0], "end_time": window[1]}
    with_masks = stage.on.check_motion(robot, starts, ends, **how)
    without = stage.off.check_motion(robot, starts, ends, **how)
    for one, other in zip(with_masks[:5], without[:5], strict=True):
        np.testing.assert_array_equal(one, other)  # bit for bit
    # all pairs, at an instant of each motion and at the reported contacts
    t = np.where(np.isfinite(with_masks.contact_by), with_masks.contact_by, rng.random(count))
    poses = along(starts, ends, t)
    times = None if window is None else window[0] + t * (window[1] - window[0])
    hit = np.zeros(count, np.bool_)
    candidates = stage.on.candidates(robot).tolist()
    for body, hits in stage.model.hits(robot, poses, times, margin).items():
        hit |= hits
        if margin == 0.0 and (hits & along_path).any():
            assert body in candidates
    assert not (hit & with_masks.free).any()
    assert (hit | ~np.isfinite(with_masks.contact_by)).all()
    assert (stage.on.collides(robot, poses, times=times, margin=margin, threads=1) == hit).all()
    return int(with_masks.free.sum()), len(candidates)


def bits_are_candidates(stage: Stage) -> None:
    """own_bit & mask(j) is nonzero exactly for candidates j; bits are single and distinct."""
    bits = {robot: stage.on.own_bit(robot) for robot in stage.model.roots}
    assert {robot for robot, bit in bits.items() if bit} == set(stage.paths)
    assert all(bit & (bit - 1) == 0 for bit in bits.values())
    assert len({bits[robot] for robot in stage.paths}) == len(stage.paths)
    for body in stage.model.items:
        root = stage.model.root(body)
        mask = bits.get(root, 0)
        for robot in stage.paths:
            candidate = body in stage.on.candidates(robot).tolist()
            mask |= bits[robot] if candidate else 0
            assert not candidate or may_meet(stage, robot, body)
            if root != robot:
                assert (bits[robot] & stage.on.mask(body) != 0) == candidate
            else:
                assert not candidate
        assert stage.on.mask(body) == mask


def may_meet(stage: Stage, robot: int, body: int) -> bool:
    """Whether enlarged boxes of the body, at its pose or on its path, overlap a motion box."""
    if all(stage.model.ignores(part, body) for part in stage.model.parts(robot)):
        return False
    item, root = stage.model.items[body], stage.model.root(body)
    if stage.model.items[root].times is not None:
        return True
    corners = np.array(np.meshgrid(*item.shape.bounds.T)).reshape(3, -1).T
    posed = corners @ item.pose[:3, :3].T + item.pose[:3, 3]
    own = [np.stack([posed.min(axis=0), posed.max(axis=0)])]
    if root in stage.paths:
        own += list(stage.on.motion_boxes(root))
    legs = stage.on.motion_boxes(robot)[:, None]
    low, high = np.array(own)[:, 0], np.array(own)[:, 1]
    return bool(((legs[:, :, 0] <= high + 1e-9) & (low - 1e-9 <= legs[:, :, 1])).all(-1).any())


def clears(stage: Stage) -> None:
    """Deleting a path clears its bit in all masks; without paths every mask is 0."""
    for robot in list(stage.paths):
        bit = stage.on.own_bit(robot)
        stage.on.clear_path(robot)
        assert stage.on.own_bit(robot) == 0
        assert not any(stage.on.mask(body) & bit for body in stage.model.items)
    assert {stage.on.mask(body) for body in stage.model.items} == {0}


def performance(seed: int, changes: int, count: int) -> tuple[int, int, float, float]:
    """Numbers of motions and of free ones, and mean numbers of candidates and bodies."""
    stage = Stage(np.random.default_rng(seed))
    free, chosen, bodies = 0, [], []
    for _ in range(changes):
        found = hides_nothing(stage, count)
        free += found[0]
        chosen.append(found[1])
        bodies.append(len(stage.model.items))
        bits_are_candidates(stage)
        stage.change()
    bits_are_candidates(stage)
    clears(stage)
    return changes * count, free, float(np.mean(chosen)), float(np.mean(bodies))


def performances(seeds: range, changes: int, count: int) -> int:
    """Number of checked motions."""
    results = np.array([performance(seed, changes, count) for seed in seeds])
    total, free = results[:, :2].sum(axis=0)
    chosen, bodies = results[:, 2:].mean(axis=0)
    assert 0.2 < free / total < 0.8
    assert chosen < 0.8 * bodies  # the masks reduce the candidates
    return int(total)


def test_masks_hide_no_collision() -> None:
    assert performances(range(20), changes=12, count=100) >= 20_000


@pytest.mark.slow
def test_masks_hide_no_collision_in_many_motions() -> None:
    """A hundred thousand motions; a million in .ci/nightly."""
    worlds = range(1000, 1000 + 25 * CASES)
    assert performances(worlds, changes=16, count=250) >= 100_000 * CASES


# Known results


def lanes() -> tuple[World, list[int], list[int]]:
    """Two movers on lanes 10 m apart, each with bodies beside it; one body reaches over both."""
    world = World()
    movers = [world.add(CUBE, at(0.0, 10.0 * i)) for i in range(2)]
    beside = [world.add(CUBE, at(5.0, 10.0 * i + 0.8)) for i in range(2)]
    beside.append(world.add(Shape(*box(0.1, 20.0, 0.1)), at(7.0, 5.0)))
    for i, mover in enumerate(movers):
        world.set_path(mover, [at(0.0, 10.0 * i), at(9.0, 10.0 * i)])
    return world, movers, beside


def test_movers_do_not_see_each_others_candidates() -> None:
    world, (one, two), (near_one, near_two, both) = lanes()
    assert world.candidates(one).tolist() == [near_one, both]
    assert world.candidates(two).tolist() == [near_two, both]
    assert (world.own_bit(one), world.own_bit(two)) == (1, 2)
    assert [world.mask(body) for body in (one, two, near_one, near_two, both)] == [1, 2, 1, 2, 3]
    before = world.tests
    assert not world.check_motion(one, at(0.0), at(3.0)).checks  # no body there
    assert not world.check_motion(two, at(0.0, 10.0), at(3.0, 10.0)).checks
    assert world.tests == before


def test_movers_whose_paths_cross_see_each_other() -> None:
    world = World()
    one, two = world.add(CUBE), world.add(CUBE, at(5.0, -5.0))
    cup = world.add(Shape(*box(0.1)), at(5.0, -4.4))
    world.attach(cup, two)
    assert world.set_path(one, [HERE, at(9.0)]).tolist() == []
    world.set_path(two, [at(5.0, -5.0), at(5.0, 5.0)])
    assert world.candidates(one).tolist() == [two, cup]
    assert world.candidates(two).tolist() == [one]
    world.set_path(two, [at(5.0, -5.0), at(9.0, -5.0)])  # path replaced
    assert world.candidates(one).tolist() == world.candidates(two).tolist() == []
    world.set_trajectory(two, [0.0, 1.0], [at(5.0, -5.0), at(5.0, 0.0)])
    assert world.candidates(one).tolist() == [two, cup]
    world.set_trajectory(two, None, None)
    assert world.candidates(one).tolist() == []
    world.set_path(two, [at(5.0, -5.0), at(5.0, 5.0)])
    assert world.candidates(one).tolist() == [two, cup]
    world.clear_path(two)  # at rest
    assert world.candidates(one).tolist() == []


CHANGES: dict[str, tuple[str, Callable[[World], Any]]] = {
    "moves in": ("far", lambda w: w.set_pose("far", at(5.0))),
    "is carried in": ("load", lambda w: w.set_pose("carrier", at(5.0, 6.0))),
    "comes": ("new", lambda w: w.add(CUBE, at(5.0), name="new")),
    "is going to": ("far", lambda w: w.set_trajectory("far", [0, 1], [at(5, 9), at(5, -9)])),
    "is going to ride": ("rider", lambda w: w.attach("rider", "train")),
    "has a path across": ("far", lambda w: w.set_path("far", [at(5, 9), at(5, -9)])),
    "is allowed no more": ("friend", lambda w: w.allow("robot", "friend", False)),
    "is in a group that is included again": ("mate", lambda w: w.allow_groups("b", "r", False)),
    "is let go": ("held", lambda w: w.detach("held")),
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_body_that_enters_the_box_gets_the_bit_at_once(what: str) -> None:
    world = World()
    world.add(CUBE, name="robot", groups="r")
    world.add(CUBE, at(50.0), name="far")
    world.add(CUBE, at(50.0, 6.0), name="carrier")
    world.add(CUBE, at(50.0, 0.0), name="load")
    world.attach("load", "carrier")
    world.add(CUBE, at(5.0), name="friend")
    world.add(CUBE, at(5.0), name="mate", groups="b")
    world.allow_groups("r", "b")
    world.add(CUBE, at(5.0), name="held", groups="r")
    for part in ("robot", "held"):
        world.allow(part, "friend")
    world.attach("held", "robot")
    world.add(CUBE, at(5.0, 100.0), name="train")
    world.add(CUBE, at(5.0, 50.0), name="rider")
    world.set_trajectory("train", [0.0, 1.0], [at(5.0, 59.0), at(5.0, 41.0)])
    world.set_path("robot", [HERE, at(9.0)])
    assert world.candidates("robot").tolist() == []
    name, change = CHANGES[what]
    change(world)
    came = world.record(name)
    assert world.candidates("robot").tolist() == [came.id]
    assert came.mask & world.own_bit("robot") != 0
    if "is going to" in what:
        assert not world.check_motion("robot", HERE, at(9.0), start_time=0.3, end_time=0.7).free
    elif what != "has a path across":
        assert not world.check_motion("robot", HERE, at(9.0)).free
        assert world.collides("robot", at(5.0))


def test_a_body_that_leaves_loses_the_bit_at_once() -> None:
    world = World()
    world.add(CUBE, name="robot")
    for name in ("moves", "goes", "is carried", "is allowed"):
        world.add(CUBE, at(5.0), name=name)
    assert len(world.set_path("robot", [HERE, at(9.0)])) == 4
    world.set_pose("moves", at(50.0))
    world.remove("goes")
    world.attach("is carried", "robot")
    for part in ("robot", "is carried"):
        world.allow("is allowed", part)
    assert world.candidates("robot").tolist() == []
    assert [world.mask(name) for name in world.names] == [
        1,
        0,
        1,
        0,
    ]  # carried bodies have the bit too


def test_the_box_encloses_the_whole_robot_along_the_leg() -> None:
    """Includes rotation and carried bodies, not only the path of the reference point."""
    rng = np.random.default_rng(0)
    for seed in range(20):
        stage = Stage(np.random.default_rng(seed))
        for robot, path in stage.paths.items():
            boxes = stage.on.motion_boxes(robot)
            assert boxes.shape == (max(len(path) - 1, 1), 2, 3)
            for leg, (low, high) in enumerate(boxes):
                last = path[min(leg + 1, len(path) - 1)]
                poses = along(path[leg], last, np.r_[0.0, 1.0, rng.random(20)])
                for part in stage.model.parts(robot):
                    item = stage.model.items[part]
                    local = item.shape.vertices @ item.offset[:3, :3].T + item.offset[:3, 3]
                    points = local @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]
                    assert (points >= low).all()
                    assert (points <= high).all()


def test_the_box_is_tight() -> None:
    world = World()
    bar = world.add(Shape(*box(2.0, 0.2, 0.2)))
    world.set_path(bar, [HERE, at(3.0)])
    np.testing.assert_allclose(world.motion_boxes(bar)[0], [[-1, -0.1, -0.1], [4, 0.1, 0.1]], 1e-6)
    world.set_path(bar, [HERE, turned(np.pi / 2)])
    low, high = world.motion_boxes(bar)[0]
    true = np.hypot(1.0, 0.1)
    assert (high[:2] >= true).all()
    assert (high[:2] <= 1.05 * true).all()
    assert (low[:2] <= -true).all()
    assert high[2] <= 0.12


def test_the_box_follows_changes_of_carried_bodies() -> None:
    world = World()
    robot = world.add(CUBE)
    load = world.add(CUBE, at(0.0, 5.0))
    path = [HERE, at(9.0)]
    world.set_path(robot, path)
    alone = world.motion_boxes(robot)
    world.attach(load, robot)
    laden = world.motion_boxes(robot)
    assert laden[0, 1, 1] >= 5.5
    world.set_path(robot, path)
    assert (world.motion_boxes(robot) == laden).all()
    world.detach(load)
    assert (world.motion_boxes(robot) == alone).all()
    world.attach(load, robot)
    world.remove(load)
    assert (world.motion_boxes(robot) == alone).all()


def test_a_motion_outside_the_path_computes_its_own_candidates() -> None:
    world = World()
    robot = world.add(CUBE)
    wall = world.add(CUBE, at(0.0, 9.0))
    world.set_path(robot, [HERE, at(9.0)])
    assert world.candidates(robot).tolist() == []
    assert world.collides(robot, at(0.0, 9.0))
    assert world.check_motion(robot, HERE, at(0.0, 20.0)).other == wall
    assert world.check_motions([robot], [HERE], [at(0.0, 20.0)]).other.tolist() == [wall]
    assert world.collides(
        robot, at(0.0, 7.9), margin=0.2
    )  # with a margin the motion leaves the box
    world.set_pose(wall, at(10.05, 0.0))
    assert world.candidates(robot).tolist() == []
    assert not world.check_motion(robot, at(8.9), at(9.0), margin=0.1).free
    assert world.collides(robot, at(9.0), margin=0.1)


def test_masks_are_for_planning_only() -> None:
    """Clearance, contacts and rays test all bodies, independent of masks."""
    world = World()
    robot, wall = world.add(CUBE), world.add(CUBE, at(0.0, 9.0))
    world.set_path(robot, [HERE, at(9.0)])
    other = world.add(CUBE, at(0.0, 9.5))
    nearest = world.clearance(robot, HERE)
    assert (float(nearest.distance), int(nearest.body)) == (8.0, wall)
    assert world.contact_pairs().tolist() == [[wall, other]]
    assert world.raycast([0, 0, 0], [0, 1, 0], ignore=robot).body == wall


def test_a_result_reports_the_reduction_by_masks() -> None:
    rng = np.random.default_rng(3)
    saved = []
    for masks in ("path", "off"):
        world = World(masks=masks)
        for i in range(100):
            world.add(CUBE, at(*(10.0 * np.array([i % 10, i // 10, 0.0]))))
        world.set_path(0, [HERE, at(0.0, 0.0, 5.0)])
        found = world.check_motion(0, HERE, nudged(rng, HERE, 0.01))
        assert isinstance(found, MotionResult)
        saved.append(found.checks)
    assert saved[0] == 0
    assert saved[1] <= 99

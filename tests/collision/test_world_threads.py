"""Several threads on one world and on several: correct results and no deadlocks."""

from __future__ import annotations

import itertools
import pickle
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pytest
from oracles.world_model import scatter, shapes, wander

from fgenv.bench.common.solids import at, ball, box, turned
from fgenv.collision import Shape
from fgenv.collision.world import World

HERE = np.eye(4)
CUBE = Shape(*box(1.0))

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]


@pytest.fixture(autouse=True)
def switch_often() -> Iterator[None]:
    """Let Python switch threads as often as possible."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    yield
    sys.setswitchinterval(usual)


def together(
    *work: Callable[[], Any], limit: float = 60.0, stop: threading.Event | None = None
) -> None:
    """Run all calls concurrently; raise their exceptions, and fail if a thread does not end."""
    raised: list[BaseException] = []

    def guarded(job: Callable[[], Any]) -> None:
        try:
            job()
        except BaseException as error:
            raised.append(error)
            if stop is not None:
                stop.set()

    team = [threading.Thread(target=guarded, args=(job,), daemon=True) for job in work]
    for member in team:
        member.start()
    ends = time.monotonic() + limit
    for member in team:
        member.join(max(0.0, ends - time.monotonic()))
    waits = any(member.is_alive() for member in team)
    if waits and stop is not None:
        stop.set()
        for member in team:
            member.join(limit)
    assert not waits, "a thread is blocked"
    if raised:
        raise raised[0]


def times(count: int, job: Callable[[], Any]) -> Callable[[], None]:
    def work() -> None:
        for _ in range(count):
            job()

    return work


def answers(world: World, seed: int, threads: int | None = 1) -> list[bytes]:
    """Results of every query."""
    rng = np.random.default_rng(seed)
    poses = wander(rng, 40, 1.0)
    some: list[Any] = [world.contact_pairs(threads=threads), world.poses(world.ids)]
    some += [world.collides(0, poses, threads=threads), *world.clearance(0, poses, threads=threads)]
    some += world.check_motion(0, poses[1:], poses[:-1], threads=threads)
    some += world.check_motions([0, 2, 3], poses[:3], poses[3:6])
    some += world.raycast(poses[:, :3, 3], poses[:, :3, 0], threads=threads)
    some += [world.candidates(0), world.mask(3), world.record(2).pose]
    return [np.ascontiguousarray(one).tobytes() for one in some]


def furnished(seed: int) -> World:
    rng = np.random.default_rng(seed)
    world, _ = scatter(rng, 15, 1.0)
    world.attach(1, 0)
    world.set_path(0, wander(rng, 3, 1.0))
    return world


def test_queries_run_side_by_side_on_one_world() -> None:
    world = furnished(0)
    expected = [answers(world, seed) for seed in range(4)]

    def work(seed: int) -> None:
        assert answers(world, seed, threads=1 + seed % 2) == expected[seed]

    together(*(times(8, partial(work, seed)) for seed in range(4)))


def test_threads_on_worlds_of_their_own() -> None:
    """The worlds share shapes; each thread changes its own world."""

    def life(seed: int, results: dict[int, list[bytes]]) -> None:
        rng = np.random.default_rng(seed)
        world = furnished(seed)
        for _ in range(10):
            body = world.add(shapes()[0], wander(rng, 1, 1.0)[0])
            world.set_pose([2, body], wander(rng, 2, 1.0))
            world.contact_pairs()
            twin = world.copy()
            twin.remove(body)
            if rng.random() < 0.5:
                world = twin
        results[seed] = answers(world, seed)

    alone: dict[int, list[bytes]] = {}
    for seed in range(4):
        life(seed, alone)
    side_by_side: dict[int, list[bytes]] = {}
    together(*(partial(life, seed, side_by_side) for seed in range(4)))
    assert side_by_side == alone


def test_a_change_is_seen_whole_or_not_at_all() -> None:
    """Two bodies swap places repeatedly: no query finds both at one place."""
    world = World()
    pair = [world.add(CUBE), world.add(CUBE, at(5.0))]
    feeler = world.add(Shape(*ball(0.1)), at(0.0, 50.0))
    stop = threading.Event()
    seen: list[int] = []

    def swap() -> None:
        places = np.stack([HERE, at(5.0)])
        ends = time.monotonic() + 20.0
        for i in itertools.count():
            world.set_pose(pair, places[:: 1 if i % 2 else -1])
            if (i > 500 and len(set(seen)) == 2) or time.monotonic() > ends:
                stop.set()
                return

    def look() -> None:
        while not stop.is_set():
            assert world.contact_pairs().tolist() == []
            left, right = world.collides(feeler, np.stack([HERE, at(5.0)]), threads=1)
            assert left
            assert right
            seen.append(int(world.clearance(feeler, at(-2.0)).body))
            first, last = world.raycast([[-9, 0, 0], [9, 0, 0]], [[1, 0, 0], [-1, 0, 0]]).body
            assert {int(first), int(last)} == set(pair)

    together(swap, look, look, stop=stop)
    assert set(seen) == set(pair)  # they did see both states


def test_queries_and_changes_of_every_kind_on_one_world() -> None:
    world = furnished(1)
    stop = threading.Event()

    def change(seed: int) -> None:
        rng = np.random.default_rng(seed)
        for i in range(40):
            pose = wander(rng, 3, 1.0)
            mine = world.add(shapes()[i % 6], pose[0], name=f"{seed} {i}", groups=f"{seed}")
            world.set_pose([mine], pose[1])
            world.set_path(mine, pose)
            world.allow(mine, 3)
            world.set_trajectory(mine, [0.0, 1.0], pose[:2])
            world.attach(mine, seed)
            world.allow_groups(f"{seed}", "x", i % 2 == 0)
            if i % 3:
                world.detach(f"{seed} {i}")
                world.clear_path(mine)
            assert world.record(mine).name == f"{seed} {i}"
            world.remove(mine)
        stop.set()

    def ask(seed: int) -> None:
        rng = np.random.default_rng(seed)
        while not stop.is_set():
            poses = wander(rng, 20, 1.0)
            world.collides(0, poses, times=0.5, threads=2)
            world.clearance(2, poses, threads=1)
            assert len(world.contact_pairs(margin=0.1)) > 0
            world.check_motion(0, poses[1:], poses[:-1], start_time=0.0, end_time=1.0)
            world.check_motions([0, 5, 7], poses[:3], poses[3:6])
            world.raycast(poses[:, :3, 3], poses[:, :3, 0])
            assert world.mask(0) >= 1
            assert 15 <= len(world) <= 17
            world.copy().contact_pairs()
            assert 0 <= world.nbytes < 1e9
            time.sleep(1e-3)  # lets changes in

    together(lambda: change(2), lambda: change(3), lambda: ask(4), lambda: ask(5), stop=stop)
    assert world.ids.tolist() == list(range(15))


@pytest.mark.unsanitized
def test_queries_do_not_starve_changes() -> None:
    """Readers without a pause, and a writer that must not starve."""
    world = furnished(2)
    stop = threading.Event()
    poses = wander(np.random.default_rng(0), 400, 1.0)

    def ask() -> None:
        while not stop.is_set():
            world.check_motion(0, poses[1:], poses[:-1], threads=1)

    def change() -> None:
        for i in range(5):
            world.set_pose(3, poses[i])
        stop.set()

    together(ask, ask, ask, change, limit=20.0, stop=stop)


class Removing:
    """A core in which another thread removes a body at the worst time."""

    def __init__(self, core: Any, after: str, body: int) -> None:
        self.core, self.after, self.body = core, after, body

    def __getattr__(self, name: str) -> Any:
        method = getattr(self.core, name)

        def call(*arguments: Any) -> Any:
            found = method(*arguments)
            if name == self.after and self.core.__len__() == 3:
                self.core.remove(self.body)
            return found

        return call

    def __len__(self) -> int:
        return len(self.core)


@pytest.mark.parametrize(
    ("what", "after", "tell"),
    [
        ("names", "ids", lambda world: len(world.names)),
        ("record", "record", lambda world: len(world.record(1).name)),
        ("pickle", "ids", lambda world: len(pickle.loads(pickle.dumps(world)))),
    ],
)
def test_results_are_of_one_moment(what: str, after: str, tell: Callable[[World], int]) -> None:
    """Names, records and pickles while another thread removes bodies."""
    world = World()
    for i in range(3):
        world.add(CUBE, at(2.0 * i))
    core: Any = Removing(world._core, after, 1)
    world._core = core
    assert tell(world) == (6 if what == "record" else 3)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("threads", [1, 2])
def test_a_long_batch_can_be_interrupted(threads: int) -> None:
    world = World()
    round_ = Shape(*ball(1.0, 4))
    world.add(round_)
    world.add(round_, at(1.3, 1.3, 1.3))  # boxes overlap, the bodies do not
    poses = np.broadcast_to(turned(0.5), (200_000, 4, 4))
    before = world.tests
    world.check_motion(0, HERE, poses[:100], threads=threads)
    batch = (world.tests - before) * len(poses) // 100  # tests of a whole batch
    before = world.tests
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)

    def work() -> None:
        for _ in range(50):
            world.check_motion(0, HERE, poses, threads=threads)

    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, handler)
    assert (world.tests - before) % batch > 0  # the last batch was not finished
    assert world.check_motion(0, HERE, HERE).free  # and goes on


@pytest.mark.unsanitized
def test_python_runs_during_a_batch() -> None:
    world = furnished(3)
    poses = wander(np.random.default_rng(1), 1000, 1.0)
    ticks = []
    done = threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(world.mask(0))  # a query beside the batch
            time.sleep(1e-4)

    def batch() -> None:
        time.sleep(0.01)
        before = len(ticks)
        world.check_motion(0, poses[1:], poses[:-1], threads=1)
        assert len(ticks) > before + 5
        done.set()

    together(tick, batch, stop=done)

"""Any order of changes: the World agrees with a model that tests every pair."""

from __future__ import annotations

from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)
from oracles.world_model import Model, along, nudged, shapes, wander
from support import CASES

from fgenv.arrays import Floats
from fgenv.collision.world import World

SIZE = 1.0  # meters: about how far bodies are from the origin

pytestmark = [
    pytest.mark.native,
    pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning"),
]

seeds = st.integers(0, 2**32 - 1)
picks = st.integers(0, 2**16)


class WorldMachine(RuleBasedStateMachine):
    """Worlds with masks and without, and the model."""

    def __init__(self) -> None:
        super().__init__()
        self.worlds = [World(), World(masks="off")]
        self.model = Model()
        self.paths: dict[int, Floats] = {}
        self.last = -1  # id

    def all(self, change: str, *arguments: Any) -> None:
        for one in (*self.worlds, self.model):
            getattr(one, change)(*arguments)

    @staticmethod
    def pick(bodies: list[int], which: int) -> int:
        return sorted(bodies)[which % len(bodies)]

    # Changes

    @initialize(seed=seeds, count=st.integers(2, 7))
    def furnish(self, seed: int, count: int) -> None:
        for i in range(count):
            self.add(seed + i, i)

    @rule(seed=seeds, kind=picks)
    @precondition(lambda self: len(self.model.items) < 12)
    def add(self, seed: int, kind: int) -> None:
        rng = np.random.default_rng(seed)
        shape, pose = shapes()[kind % len(shapes())], wander(rng, 1, SIZE)[0]
        groups = [("a", "b", "c")[kind % 3]] if seed % 2 else []
        ids = {world.add(shape, pose, groups=groups) for world in self.worlds}
        assert ids == {self.last + 1}
        self.last += 1
        self.model.add(self.last, shape, pose, groups)

    @rule(which=picks)
    @precondition(lambda self: len(self.model.items) > 2)
    def remove(self, which: int) -> None:
        body = self.pick(list(self.model.items), which)
        self.all("remove", body)
        self.paths.pop(body, None)

    @rule(which=picks, seed=seeds, near=st.booleans())
    def move(self, which: int, seed: int, near: bool) -> None:
        rng = np.random.default_rng(seed)
        body = self.pick(self.model.roots, which)
        pose = wander(rng, 1, SIZE)[0]
        if near:  # beside another body
            other = self.model.items[self.pick(list(self.model.items), which // 7)]
            pose = nudged(rng, other.pose, 0.4)
        self.all("set_pose", body, pose)

    @rule(seed=seeds)
    def move_all(self, seed: int) -> None:
        poses = wander(np.random.default_rng(seed), len(self.model.roots), SIZE)
        roots = self.model.roots
        for world in self.worlds:
            world.set_pose(roots, poses)
        for body, pose in zip(roots, poses, strict=True):
            self.model.set_pose(body, pose)

    @rule(which=picks, carrier=picks)
    @precondition(lambda self: len(self.model.roots) > 1)
    def attach(self, which: int, carrier: int) -> None:
        body = self.pick(self.model.roots, which)
        others = [b for b in self.model.items if self.model.root(b) != body]
        self.all("attach", body, self.pick(others, carrier))
        self.paths.pop(body, None)

    @rule(which=picks)
    @precondition(lambda self: len(self.model.roots) < len(self.model.items))
    def detach(self, which: int) -> None:
        carried = [b for b, item in self.model.items.items() if item.carrier is not None]
        self.all("detach", self.pick(carried, which))

    @rule(a=picks, b=picks, allowed=st.booleans())
    def allow(self, a: int, b: int, allowed: bool) -> None:
        bodies = list(self.model.items)
        one = self.pick(bodies, a)
        bodies.remove(one)
        if bodies:
            self.all("allow", one, self.pick(bodies, b), allowed)

    @rule(a=st.sampled_from("abc"), b=st.sampled_from("abc"), allowed=st.booleans())
    def allow_groups(self, a: str, b: str, allowed: bool) -> None:
        self.all("allow_groups", a, b, allowed)

    @rule(which=picks, seed=seeds, count=st.integers(1, 4))
    def set_path(self, which: int, seed: int, count: int) -> None:
        robot = self.pick(self.model.roots, which)
        self.paths[robot] = wander(np.random.default_rng(seed), count, SIZE)
        for world in self.worlds:
            assert (world.set_path(robot, self.paths[robot]) == world.candidates(robot)).all()

    @rule(which=picks)
    def clear_path(self, which: int) -> None:
        robot = self.pick(self.model.roots, which)  # with a path or without
        for world in self.worlds:
            world.clear_path(robot)
        self.paths.pop(robot, None)

    @rule(which=picks, seed=seeds, count=st.integers(0, 3))
    def set_trajectory(self, which: int, seed: int, count: int) -> None:
        body = self.pick(self.model.roots, which)
        rng = np.random.default_rng(seed)
        if count == 0:
            self.all("set_trajectory", body, None, None)
        else:
            times = np.cumsum(rng.uniform(0.1, 1.0, size=count))
            self.all("set_trajectory", body, times, wander(rng, count, SIZE))

    @rule(pickled=st.booleans())
    def become_a_copy(self, pickled: bool) -> None:
        import pickle

        before = [world.ids.tolist() for world in self.worlds]
        self.worlds = [
            pickle.loads(pickle.dumps(world)) if pickled else world.copy() for world in self.worlds
        ]
        assert [world.ids.tolist() for world in self.worlds] == before

    # Laws

    @rule(which=picks, seed=seeds, margin=st.sampled_from([0.0, 0.05]), timed=st.booleans())
    def motions_are_true(self, which: int, seed: int, margin: float, timed: bool) -> None:
        """On the path and elsewhere: free without colliding samples; all hits are candidates."""
        rng = np.random.default_rng(seed)
        robot = self.pick(self.model.roots, which)
        legs = self.legs(robot, rng)
        window = np.sort(rng.uniform(-0.5, 3.0, size=2)) if timed else None
        t = np.r_[0.0, rng.random(12), 1.0]
        times = None if window is None else window[0] + t * (window[1] - window[0])
        how = {} if window is None else {"start_time": window[0], "end_time": window[1]}
        for start, end, on_path in legs:
            found = self.worlds[0].check_motion(robot, start, end, margin=margin, **how)
            same = self.worlds[1].check_motion(robot, start, end, margin=margin, **how)
            np.testing.assert_array_equal(np.array(found[:5], float), np.array(same[:5], float))
            hit = np.zeros(len(t), np.bool_)
            poses = along(start, end, t)
            for body, hits in self.model.hits(robot, poses, times, margin).items():
                hit |= hits
                if on_path and margin == 0.0 and hits.any():
                    assert body in self.worlds[0].candidates(robot).tolist()
            assert not (found.free and hit.any())
            assert found.free or not hit[t < found.free_until].any()
            for world in self.worlds:
                answer = world.collides(robot, poses, times=times, margin=margin, threads=1)
                assert (answer == hit).all()
            if np.isfinite(found.contact_by):
                at = np.array([found.contact_by])
                when = None if window is None else window[0] + at * (window[1] - window[0])
                shown = self.model.hits(robot, along(start, end, at), when, margin)
                assert shown[found.other][0]

    def legs(self, robot: int, rng: np.random.Generator) -> list[tuple[Floats, Floats, bool]]:
        start = self.model.items[robot].pose
        legs = [(start, nudged(rng, start, 0.5), False)]
        path = self.paths.get(robot)
        if path is not None:
            i = int(rng.integers(len(path)))
            legs.append((path[i], path[min(i + 1, len(path) - 1)], True))
        return legs

    @rule(which=picks, seed=seeds)
    def clearance_is_true(self, which: int, seed: int) -> None:
        robot = self.pick(self.model.roots, which)
        poses = wander(np.random.default_rng(seed), 4, 2 * SIZE)
        table = self.model.distances(robot, poses)
        found = self.worlds[0].clearance(robot, poses)
        nearest = np.min([*table.values(), np.full(4, np.inf)], axis=0)
        np.testing.assert_allclose(found.distance, nearest, rtol=1e-9, atol=1e-12)

    @invariant()
    def contacts_are_true(self) -> None:
        for world in self.worlds:
            assert world.contact_pairs().tolist() == self.model.contacts()

    @invariant()
    def poses_are_true(self) -> None:
        bodies = sorted(self.model.items)
        for world in self.worlds:
            assert world.ids.tolist() == bodies
            expected = [self.model.items[body].pose for body in bodies]
            np.testing.assert_allclose(
                world.poses(bodies), np.array(expected).reshape(-1, 4, 4), atol=1e-9
            )

    @invariant()
    def masks_are_candidates(self) -> None:
        world = self.worlds[0]
        bits = {robot: world.own_bit(robot) for robot in self.model.roots}
        assert {robot for robot, bit in bits.items() if bit} == set(self.paths)
        assert len({bits[robot] for robot in self.paths}) == len(self.paths)
        chosen = {robot: world.candidates(robot).tolist() for robot in self.paths}
        for body in self.model.items:
            mask = bits.get(self.model.root(body), 0)
            for robot, candidates in chosen.items():
                mask |= bits[robot] if body in candidates else 0
            assert world.mask(body) == mask


TestWorld = WorldMachine.TestCase
TestWorld.settings = settings(max_examples=25, stateful_step_count=20)


@pytest.mark.slow
def test_long_lives() -> None:
    run_state_machine_as_test(
        WorldMachine,
        settings=settings(
            max_examples=25 * CASES,
            stateful_step_count=60,
            suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
        ),
    )

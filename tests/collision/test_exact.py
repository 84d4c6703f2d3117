"""`exact` on real meshes against python-fcl and coal, with disagreements settled exactly."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.independent import (
    coal_verdicts,
    fcl_checker,
    is_inside,
    is_marginal,
    one_is_inside,
    surfaces_meet,
)
from support import CASES
from support.meshes import MeshPair, pairs

from fgenv.arrays import Floats
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import NEAR, USUAL, random_poses_batched
from fgenv.bench.common.solids import somewhere
from fgenv.collision import Shape, collide

FEW = pairs(12, largest=3000, seed=1)
MANY = pairs(120, seed=2)

pytestmark = pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")


class Jury:
    """A pair of meshes, its poses and the results for them."""

    def __init__(self, pair: MeshPair, count: int, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self.mesh_a, self.mesh_b = pair.load()
        self.a, self.b = (Shape(m.vertices, m.faces) for m in (self.mesh_a, self.mesh_b))
        self.pose_a = somewhere(rng)
        self.fcl = fcl_checker(self.mesh_a, self.mesh_b, self.pose_a)
        # half of them near contact, down to 1e-7 of the size
        parts = [self._place(count // 2, rng, decades) for decades in (NEAR, USUAL)]
        self.poses = np.concatenate(parts)
        self.verdicts = collide(self.a, self.pose_a, self.b, self.poses)
        self.disputes: Counter[str] = Counter()  # disagreements of other libraries, by kind

    def _place(self, count: int, rng: np.random.Generator, decades: tuple[float, float]) -> Floats:
        def judge(poses: Floats) -> NDArray[np.bool_]:
            return np.asarray(collide(self.a, self.pose_a, self.b, poses, threads=1))

        meshes = self.mesh_a, self.mesh_b
        return random_poses_batched(*meshes, self.pose_a, count, judge, rng, decades)

    def wrong(self) -> list[str]:
        """Results that disagree with another library and are not confirmed exactly."""
        found = []
        for name, verdicts in (
            ("python-fcl", self.fcl.collide_all(self.poses)),
            ("coal", coal_verdicts(self.mesh_a, self.mesh_b, self.pose_a, self.poses)),
        ):
            for i in np.flatnonzero(verdicts != self.verdicts).tolist():
                self.disputes[f"{name}, {self.kind(i)}"] += 1
                if not self.is_right(i):
                    found.append(f"{name}: pose {i} {self.poses[i].tolist()}")
        return found

    def kind(self, i: int) -> str:
        """Pose i in integer arithmetic: surfaces meet, or one body is inside the other."""
        if surfaces_meet(self.mesh_a, self.pose_a, self.mesh_b, self.poses[i]):
            return "surfaces meet"
        inside = one_is_inside(self.a, self.pose_a, self.b, self.poses[i])
        return "one inside" if inside else "free"

    def is_right(self, i: int) -> bool:
        """Whether result i is confirmed, by solid angles or in integers."""
        place = self.mesh_a, self.pose_a, self.mesh_b, self.poses[i]
        if surfaces_meet(*place):
            return bool(self.verdicts[i]) or is_marginal(*place)
        inside = one_is_inside(self.a, self.pose_a, self.b, self.poses[i])
        return bool(self.verdicts[i]) == inside or is_marginal(*place)

    def missed_inside(self) -> list[str]:
        """Poses reported as free although a vertex of one body is inside the other."""
        found = []
        relative = np.linalg.inv(self.pose_a) @ self.poses[~self.verdicts]
        for inner, outer, place in (
            (self.b, self.a, relative),
            (self.a, self.b, np.linalg.inv(relative)),
        ):
            points = place[:, :3, :3] @ inner.vertices[inner.faces[0, 0]] + place[:, :3, 3]
            near = ((points > outer.bounds[0]) & (points < outer.bounds[1])).all(axis=1)
            if outer.watertight and near.any():
                found += [str(p) for p in place[near][is_inside(outer, points[near])]]
        return found


@pytest.mark.parametrize("pair", FEW, ids=lambda pair: pair.name)
def test_no_verdict_is_wrong(pair: MeshPair) -> None:
    jury = Jury(pair, 1700, seed=3)
    assert 0.25 < jury.verdicts.mean() < 0.6
    assert jury.wrong() == []
    assert jury.missed_inside() == []


@pytest.mark.slow
def test_no_verdict_on_many_poses_is_wrong() -> None:
    """A hundred thousand poses; a million in .ci/nightly."""
    tally: Counter[str] = Counter()
    for seed, pair in enumerate(MANY):
        jury = Jury(pair, 850 * CASES, seed=seed)
        tally.update(poses=len(jury.poses), hits=int(jury.verdicts.sum()), pairs=1)
        assert jury.wrong() + jury.missed_inside() == [], pair
        tally.update(jury.disputes)
        print(pair.name, dict(tally), flush=True)  # seen with -s
    assert tally["poses"] >= 100_000 * CASES
    assert tally["pairs"] >= 100
    assert 0.3 < tally["hits"] / tally["poses"] < 0.5


def test_the_pairs_come_from_several_packages() -> None:
    packages = {source.package for pair in MANY for source in (pair.a, pair.b)}
    assert len(packages) >= 2
    assert len(set(MANY)) >= 100


@pytest.mark.parametrize("pair", FEW[1:5], ids=lambda pair: pair.name)
def test_verdicts_agree_with_whole_numbers(pair: MeshPair) -> None:
    """A few poses of each pair, as close as 1e-7 of the size, against exact integers."""
    jury = Jury(pair, 40, seed=5)
    assert all(jury.is_right(i) for i in range(len(jury.poses)))


@pytest.mark.parametrize("pair", FEW[:4], ids=lambda pair: pair.name)
def test_order_and_common_motion_change_nothing(pair: MeshPair) -> None:
    jury = Jury(pair, 300, seed=6)
    swapped = collide(jury.b, jury.poses, jury.a, jury.pose_a)
    assert (swapped == jury.verdicts).all()
    # a common quarter turn is exact in doubles
    quarter = np.array([[0.0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    turned = collide(jury.a, quarter @ jury.pose_a, jury.b, quarter @ jury.poses)
    assert (turned == jury.verdicts).all()


@pytest.mark.parametrize("pair", FEW[:2], ids=lambda pair: pair.name)
def test_tolerance_zero_is_exact(pair: MeshPair) -> None:
    jury = Jury(pair, 300, seed=7)
    a, b = (Shape(m.vertices, m.faces, tolerance=0.0) for m in (jury.mesh_a, jury.mesh_b))
    assert (collide(a, jury.pose_a, b, jury.poses) == jury.verdicts).all()


def test_triangles_alone_agree_with_whole_numbers() -> None:
    """Single triangles with small integer coordinates often touch, lie flush or cross."""
    rng = np.random.default_rng(8)
    met = 0
    for _ in range(1500):
        first, second = rng.integers(-2, 3, size=(2, 3, 3)).astype(float)
        meshes = [Mesh("", v, np.array([[0, 1, 2]], np.int32)) for v in (first, second)]
        if any(np.linalg.matrix_rank(m.vertices[1:] - m.vertices[0]) < 2 for m in meshes):
            continue
        a, b = (Shape(m.vertices, m.faces) for m in meshes)
        expected = surfaces_meet(meshes[0], np.eye(4), meshes[1], np.eye(4))
        assert collide(a, np.eye(4), b, np.eye(4)) == expected, (first, second)
        met += expected
    assert met > 200

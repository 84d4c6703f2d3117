"""Measurements of ``fgenv compare``: each collision method on the same poses of real meshes.

Feature graphs (published, by crease, by tolerance, exact) against boxes, sphere, hull and grid.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from fgenv.arrays import Flags, Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import random_poses, random_rotations
from fgenv.bench.common.timing import each_call
from fgenv.bench.pairs.catalog import GYM, ROBOTS, TOOLBOX, Pair, Source
from fgenv.bench.peers.ground_truth import Truth
from fgenv.collision import Shape, collide
from fgenv.paper.baselines import BASELINES, Baseline

BLOCK = 20  # poses per turn of a method
KITCHEN = "kitchen_franka/kitchen_assets/meshes"
IRB140 = "xacro/abb_irb140_description/meshes/irb140/collision"

PAIRS = (
    Pair(
        "so100 jaws",
        Source(ROBOTS, "so_arm_description/meshes/so100/Fixed_Jaw.stl"),
        Source(ROBOTS, "so_arm_description/meshes/so100/Moving_Jaw.stl"),
    ),
    Pair(
        "wx200 arm, hinge handle",
        Source(TOOLBOX, "xacro/trossen_descriptions/meshes/meshes_wx200/WXA-200-M-3-UA.stl", 1e-3),
        Source(GYM, f"{KITCHEN}/hingehandle.stl"),
    ),
    Pair(
        "pr2 shoulder, cabinet",
        Source(ROBOTS, "pr2_description/meshes/shoulder_v0/shoulder_yaw.stl"),
        Source(GYM, f"{KITCHEN}/hingecabinet.stl"),
    ),
    Pair(
        "quadrotor, frame",
        Source(ROBOTS, "hector_description/meshes/quadrotor/quadrotor_base.stl"),
        Source(ROBOTS, "finger_edu_description/meshes/frame_wall.stl"),
    ),
    Pair(
        "allegro link, pr2 laser",
        Source(ROBOTS, "allegro_hand_description/meshes/link_14.0.STL"),
        Source(ROBOTS, "pr2_description/meshes/tilting_laser_v0/hok_tilt.stl"),
    ),
    Pair(
        "irb140 links",
        Source(TOOLBOX, f"{IRB140}/link_1.stl"),
        Source(TOOLBOX, f"{IRB140}/link_2.stl"),
    ),
)


class FeatureGraphs:
    """A feature-graph method on one pair of shapes; the first is the moving body.

    `tests`: edges times faces of the walk as published, without a tree.
    """

    def __init__(self, a: Shape, b: Shape) -> None:
        self._a, self._b = a, b
        self.tests = len(a.graph.edges) * len(b.faces)
        if a.method != "loop":  # edges of both bodies
            self.tests += len(b.graph.edges) * len(a.faces)

    def collides(self, Ta: Poses, Tb: Poses) -> bool:
        """The verdict at two world poses (4, 4)."""
        return bool(collide(self._a, Ta, self._b, Tb))


def methods(a: Mesh, b: Mesh, tolerance: float) -> dict[str, Baseline]:
    """Every method on one pair, by name; `tolerance` is relative to the size of each body."""

    def graphs(method: str) -> FeatureGraphs:
        return FeatureGraphs(*(Shape(m.vertices, m.faces, method) for m in (a, b)))

    bounded = (Shape(m.vertices, m.faces, tolerance=tolerance * m.size) for m in (a, b))
    return {
        "loop": graphs("loop"),
        "crease": graphs("crease"),
        "tolerance": FeatureGraphs(*bounded),
        "exact": graphs("exact"),
        **{name: kind(a, b) for name, kind in BASELINES.items()},
    }


@dataclass
class Measurements:
    """Verdicts, elementary tests and seconds of each query of one method."""

    verdicts: list[bool] = field(default_factory=list)
    tests: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Row:
    """The results of one method; a ratio without a denominator is None."""

    method: str
    hits: int  # correct verdicts 'collision'
    false_hits: int
    missed: int
    tests: float  # mean per query
    microseconds: float  # median of a single call

    @property
    def precision(self) -> float | None:
        """Share of the reported collisions that are true."""
        return _ratio(self.hits, self.false_hits)

    @property
    def recall(self) -> float | None:
        """Share of the true collisions that are reported."""
        return _ratio(self.hits, self.missed)


@dataclass(frozen=True)
class PairResult:
    """The results on one pair of meshes, a row for each method."""

    pair: str
    triangles: tuple[int, int]
    poses: int
    hit_share: float
    contained: int  # poses with one body inside the other and no surface contact
    rows: tuple[Row, ...]


def compare_pairs(
    count: int, seed: int, tolerance: float, pairs: Sequence[Pair] = PAIRS
) -> Iterator[PairResult]:
    """Measure each pair on `count` poses; the same seed gives the same poses."""
    for k, pair in enumerate(pairs):
        yield compare_pair(pair, count, np.random.default_rng((seed, k)), tolerance)


def compare_pair(pair: Pair, count: int, rng: np.random.Generator, tolerance: float) -> PairResult:
    """Measure every method on `count` poses of a pair near contact, about 40 % of them hits."""
    a, b = pair.a.load(), pair.b.load()
    pose_a = np.eye(4)
    pose_a[:3, :3], pose_a[:3, 3] = random_rotations(rng, 1)[0], rng.normal(size=3)
    truth = Truth(a, b, pose_a)
    poses = random_poses(a, b, pose_a, count, truth.collides, rng)
    inside = np.array([not truth.touches(p) and truth.contains(p) for p in poses])
    hits = inside | np.array([truth.touches(p) for p in poses])
    measured = measure(methods(a, b, tolerance), pose_a, poses)
    rows = tuple(_row(name, measurements, hits) for name, measurements in measured.items())
    triangles = len(a.faces), len(b.faces)
    return PairResult(pair.name, triangles, count, float(hits.mean()), int(inside.sum()), rows)


def measure(methods: dict[str, Baseline], pose_a: Poses, poses: Poses) -> dict[str, Measurements]:
    """Run all methods on all poses (n, 4, 4), in turns of a block with a rotating order."""
    measured = {name: Measurements() for name in methods}
    names = list(methods)
    for turn, start in enumerate(range(0, len(poses), BLOCK)):
        block, first = poses[start : start + BLOCK], turn % len(names)
        for name in names[first:] + names[:first]:
            _measure_block(methods[name], pose_a, block, measured[name])
    return measured


def _measure_block(method: Baseline, pose_a: Poses, poses: Poses, target: Measurements) -> None:
    for pose in poses:
        target.verdicts.append(method.collides(pose_a, pose))
        target.tests.append(method.tests)
    call: Callable[[Poses], bool] = lambda pose: method.collides(pose_a, pose)  # noqa: E731
    target.seconds.extend(each_call(call, poses))


def _row(name: str, measurements: Measurements, truth: Flags) -> Row:
    verdicts = np.array(measurements.verdicts, np.bool_)
    return Row(
        name,
        int(np.sum(verdicts & truth)),
        int(np.sum(verdicts & ~truth)),
        int(np.sum(~verdicts & truth)),
        float(np.mean(measurements.tests)),
        1e6 * float(np.median(measurements.seconds)),
    )


def overall(results: Sequence[PairResult]) -> list[Row]:
    """A row for each method over all pairs: sums of counts, geometric means of tests and times."""
    return [
        Row(
            rows[0].method,
            sum(row.hits for row in rows),
            sum(row.false_hits for row in rows),
            sum(row.missed for row in rows),
            _geometric_mean([row.tests for row in rows]),
            _geometric_mean([row.microseconds for row in rows]),
        )
        for rows in zip(*(result.rows for result in results), strict=True)
    ]


def _geometric_mean(values: Sequence[float]) -> float:
    return float(np.exp(np.mean(np.log(np.maximum(values, 1e-12)))))


def _ratio(hits: int, wrong: int) -> float | None:
    return hits / (hits + wrong) if hits + wrong else None

"""`fgenv bench pairs` on few poses: counts, ratios and reports."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from fgenv.bench.common.machine import machine
from fgenv.bench.common.memory import kept_bytes
from fgenv.bench.common.poses import (
    random_directions,
    random_poses_batched,
    random_rotations,
    surface_points,
)
from fgenv.bench.common.records import geometric_means
from fgenv.bench.common.timing import each_call, race
from fgenv.bench.pairs.catalog import PAIRS, select_pairs
from fgenv.bench.pairs.report import peer_table, plot_times, ratio_table
from fgenv.bench.pairs.run import bench_pairs
from fgenv.bench.peers import installed, peer

pytestmark = pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")


def test_a_record_holds_every_number(tmp_path: Path) -> None:
    names = installed()
    assert names[:2] == ["fgenv", "python-fcl"]
    (record,) = bench_pairs(which="panda link5", peers=names, poses=60)
    assert 0.2 < record["hit_share"] < 0.6
    for name in names:
        found = record["peers"][name]
        assert found["batch"].keys() == {"mean", "free", "hit"}
        assert 0 < found["call"]["mean"] <= found["call"]["p99"]
        if found["truth"] == "meshes":
            assert found["differ"] == 0
    own = record["peers"]["fgenv"]
    assert own["bytes_per_triangle"] <= 200
    assert own["build"] > 0
    assert own["distance"] > 0
    assert record["threads_2"] > 0
    ratio = record["ratio"]
    assert ratio.keys() >= {"mean", "free", "hit", "call", "p99", "distance", "build"}
    overall = geometric_means([record])
    assert overall["mean"]["mean"] == pytest.approx(ratio["mean"])
    json.dumps({"machine": machine(), "pairs": [record], "summary": overall})
    assert peer_table(record).row_count == len(names)
    assert ratio_table([record], overall).row_count == 3
    path = tmp_path / "times.png"
    plot_times([record], path)
    assert path.stat().st_size > 1000


def test_pairs_are_selected_by_name() -> None:
    assert len(PAIRS) >= 12
    assert {pair.name for pair in select_pairs("quick")} <= {
        pair.name for pair in select_pairs("all")
    }
    assert [pair.name for pair in select_pairs("solo")] == ["solo legs"]
    with pytest.raises(ValueError, match="pairs: got 'nothing', expected"):
        select_pairs("nothing")
    with pytest.raises(ValueError, match="peers: got 'bullet', expected"):
        peer("bullet")


def test_poses_are_the_same_for_the_same_seed() -> None:
    pair = select_pairs("panda link5")[0]
    a, b = pair.a.load(), pair.b.load()
    fcl = peer("python-fcl")
    checker = fcl.pair(fcl.build(a), fcl.build(b), np.eye(4))
    one, two, other = (
        random_poses_batched(a, b, np.eye(4), 50, checker.collide_all, np.random.default_rng(seed))
        for seed in (1, 1, 2)
    )
    assert (one == two).all()
    assert (one != other).any()
    assert 0.25 < checker.collide_all(one).mean() < 0.6


def test_what_poses_are_made_of() -> None:
    rng = np.random.default_rng(3)
    turns = random_rotations(rng, 200)
    assert np.allclose(turns @ turns.transpose(0, 2, 1), np.eye(3), atol=1e-14)
    assert np.linalg.det(turns) == pytest.approx(1.0)
    assert np.abs(turns.mean(axis=0)).max() < 0.15
    assert np.linalg.norm(random_directions(rng, 50), axis=1) == pytest.approx(1.0)
    mesh = select_pairs("panda link5")[0].a.load()
    points = surface_points(rng, mesh, 100)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    assert ((points >= low - 1e-12) & (points <= high + 1e-12)).all()


def test_a_race_weighs_every_pose() -> None:
    seen: list[int] = []
    ticks = iter(range(10**6))

    def job(poses: np.ndarray) -> None:
        seen.append(len(poses))

    times = race({"a": job, "b": job}, np.zeros((30, 4, 4)), 3, 1e9, chunk=20, clock=ticks.__next__)
    assert times.keys() == {"a", "b"}
    assert seen.count(20) == seen.count(10) == 6
    assert times["a"] == pytest.approx((20 / 20 + 10 / 10) / 30)


def test_single_calls_are_timed_one_by_one() -> None:
    seconds = each_call(lambda pose: sum(range(int(pose[0, 0]))), np.ones((5, 4, 4)) * 2000)
    assert seconds.shape == (5,)
    assert (seconds > 1e-6).all()


def test_kept_bytes_are_those_of_the_allocator() -> None:
    found = kept_bytes(lambda: np.ones(1_000_000))
    if found is None:
        pytest.skip("this C library does not report it")
    assert found == pytest.approx(8e6, rel=0.01)

"""`fgenv bench world` on few bodies and few motions."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fgenv.bench.common.meshes import Mesh
from fgenv.bench.world.crowd import DRIFT, MESHES, TURN, crowd
from fgenv.bench.world.goals import goals
from fgenv.bench.world.motions import bench_motions, bullets, real_motions, steps
from fgenv.bench.world.movers import along, bench_movers, bench_threads, between
from fgenv.bench.world.peers import MANAGERS, managers, quaternions
from fgenv.bench.world.report import plot, table_of
from fgenv.bench.world.steps import Cost, Limits, bench_steps, decide, growth
from fgenv.cli import app

pytestmark = pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return MESHES[188].load()


def test_a_crowd_keeps_its_density_and_its_walls(mesh: Mesh) -> None:
    few, many = (crowd(mesh, n, np.random.default_rng(0)) for n in (100, 800))
    assert many.side == pytest.approx(2 * few.side)
    for step in (0, 1, 500):
        poses = few.poses(step)
        assert (poses[:, :3, 3] >= 0).all()
        assert (poses[:, :3, 3] <= few.side).all()
        assert np.allclose(poses[:, :3, :3] @ poses[:, :3, :3].swapaxes(1, 2), np.eye(3))
    moved = few.poses(1)[:, :3, 3] - few.poses(0)[:, :3, 3]
    assert np.median(np.linalg.norm(moved, axis=1)) == pytest.approx(DRIFT * mesh.size)
    turn = few.poses(1)[:, :3, :3] @ few.poses(0)[:, :3, :3].swapaxes(1, 2)
    assert np.allclose(np.trace(turn, axis1=1, axis2=2), 1 + 2 * np.cos(TURN))
    out = np.abs(many.start - many.middle).max(axis=1)
    assert (np.diff(out) >= 0).all()  # so the first bodies fill the middle
    assert 60 < (out < few.side / 2).sum() < 150


def test_all_libraries_find_the_same_pairs(mesh: Mesh) -> None:
    moving = crowd(mesh, 60, np.random.default_rng(1))
    held = {m.name: (m, m.make(mesh, moving.poses(0))) for m in managers()}
    for step in (1, 40):
        poses = moving.poses(step)
        found = {name: bodies.pairs(poses) for name, (_, bodies) in held.items()}
        assert len(found["fgenv"]) > 0
        for name, (manager, _) in held.items():
            if manager.truth == "meshes":
                assert found[name] == found["fgenv"]
            else:
                assert found[name] >= found["fgenv"]  # hulls hit wherever meshes do
    yes, no = next(iter(found["fgenv"])), (0, 1)
    assert decide(mesh, poses, {yes}) == ({yes}, set())
    assert no in decide(mesh, poses, {no})[no not in found["fgenv"]]


def test_quaternions_are_the_rotations() -> None:
    from fgenv.bench.common.poses import random_rotations

    turns = random_rotations(np.random.default_rng(2), 500)
    w, *vector = quaternions(turns).T
    v = np.stack(vector, axis=-1)
    x = np.array([0.3, -0.5, 0.8])
    assert np.allclose(x + 2 * np.cross(v, np.cross(v, x) + w[:, None] * x), turns @ x)


def test_poses_along_a_motion_are_even() -> None:
    motions = next(real_motions(5, 0))
    poses = between(motions.T0[0], motions.T1[0], 10)
    assert np.allclose(along(motions.T0[0], motions.T1[0], np.array([1.0]))[0], motions.T1[0])
    turns = poses[1:, :3, :3] @ poses[:-1, :3, :3].swapaxes(1, 2)
    assert np.allclose(turns, turns[0])
    assert np.allclose(np.diff(poses[:, :3, 3], axis=0), poses[1, :3, 3] - poses[0, :3, 3])
    for some, travel in zip(steps(motions, 0.01), motions.travel(), strict=True):
        points = motions.b.vertices @ some[:, :3, :3].swapaxes(1, 2) + some[:, None, :3, 3]
        assert np.linalg.norm(np.diff(points, axis=0), axis=2).max() <= 0.01 + 1e-12
        assert len(some) == max(1, np.ceil(travel / 0.01)) + 1


def test_records_hold_every_number(mesh: Mesh, tmp_path: Path) -> None:
    costs: dict[str, Cost] = {}
    rows = [bench_steps(mesh, count, managers(), 0, Limits(2, 20.0), costs) for count in (100, 200)]
    names = [m.name for m in managers()]
    for row in rows:
        assert list(row["peers"]) == names
        assert 0 < row["colliding"] < row["near"]
        assert row["disputed"]["fgenv_wrong"] == 0
        for found in row["peers"].values():
            assert found["step"] > 0
            if found["truth"] == "meshes":
                assert found["differ"] == 0
    assert set(growth(rows)) == {"from", "to", "times", "n_log_n"}
    movers = bench_movers(mesh, [100, 200], 0, rounds=1)
    assert movers["free"] > 0.8
    for row in movers["rows"]:
        assert row["tests"]["path"] < row["tests"]["off"] / 3
        assert row["bytes_per_body"] < 2000
        assert all(row[job] > 0 for job in ("set_path", "collides", "check_motion"))
    # Around the same paths stand the same bodies.
    assert movers["rows"][0]["tests"]["path"] == movers["rows"][1]["tests"]["path"]
    threads = bench_threads(mesh, 100, 0, rounds=1)
    assert set(threads) == {"contacts", "collides", "check_motion"}
    pairs = [bench_motions(m, 1, 0.1) for m in (next(real_motions(12, 0)), bullets(20, 0))]
    for record in pairs:
        assert record["truth"]["contradicted"] == 0
        assert record["truth"]["contacts_confirmed"] == record["truth"]["contacts"]
        assert record["ways"]["continuous"]["missed"] == 0
        assert record["ways"]["any contact"]["false_alarms"] == 0
    assert 0 < pairs[0]["free"] < 12
    assert pairs[1]["ways"]["discrete 1 cm"]["missed"] > 0  # it tunnels
    assert pairs[1]["ways"]["FCL naive"]["missed"] > 0
    done = {"steps": rows, "movers": [movers], "threads": [threads], "motions": pairs}
    reached = goals(done)
    assert len(reached) == 1 + 1 + 2 + 3 + 2
    json.dumps([done, reached])
    for kind, records in done.items():
        assert table_of(kind, records).row_count > 0
    assert table_of("truths", pairs).row_count == 2
    assert table_of("goals", [reached]).row_count == len(reached)
    plot(done, tmp_path / "world.png")
    assert (tmp_path / "world.png").stat().st_size > 1000


def test_what_is_dear_or_refuses_is_left_out(mesh: Mesh) -> None:
    fgenv, fcl = MANAGERS[:2]

    def refuse(mesh: Mesh, poses: object) -> object:
        raise RuntimeError("no more than two\nand so on")

    broken = type(fgenv)("broken", "fgenv", "meshes", refuse)  # type: ignore[arg-type]
    costs: dict[str, Cost] = {"python-fcl": (1.0, 0.0)}  # a second for each body
    row = bench_steps(mesh, 5, [fgenv, fcl, broken], 0, Limits(1, 2.0), costs)
    assert list(row["peers"]) == ["fgenv", "broken"]
    assert row["peers"]["broken"]["refused"] == "no more than two"
    assert costs["broken"] == (np.inf, np.inf)
    assert table_of("steps", [row]).row_count == 1


@pytest.mark.slow
def test_the_command_gives_one_document() -> None:
    done = CliRunner().invoke(app, ["bench", "world", "--quick", "--json"])
    assert done.exit_code == 0
    said = json.loads(done.stdout)
    assert said["settings"] == {"seed": 0, "quick": True}
    assert [row["bodies"] for row in said["steps"]] == [10, 100, 1000] * 2
    assert len(said["movers"]) == 2
    assert len(said["motions"]) >= 3
    (reached,) = said["goals"]
    assert all(goal["measured"] > 0 for goal in reached.values())

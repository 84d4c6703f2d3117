"""The comparison: its truth against other libraries, its counts, and the command's output."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

from fgenv.bench.common.meshes import Mesh
from fgenv.bench.comparison import PAIRS, PairResult, Row, compare_pair, overall
from fgenv.bench.peers.ground_truth import Truth, part_points, winding_numbers
from fgenv.cli import app


def body(mesh: trimesh.Trimesh) -> Mesh:
    return Mesh("", np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int32))


@pytest.fixture(scope="module")
def results() -> list[PairResult]:
    """The two pairs with the fewest triangles, 60 poses each."""
    return [compare_pair(PAIRS[k], 60, np.random.default_rng(k), 1e-3) for k in (1, 3)]


def row(result: PairResult, method: str) -> Row:
    return next(row for row in result.rows if row.method == method)


def test_winding_numbers_of_nested_shells() -> None:
    outer, inner = trimesh.creation.box(), trimesh.creation.icosphere(2, 0.3)
    both = body(outer + inner)
    points = np.array([[0.0, 0, 0], [0.4, 0.4, 0.4], [0.6, 0, 0], [5, 5, 5]])
    assert winding_numbers(points, both) == pytest.approx([2, 1, 0, 0], abs=1e-9)
    inner.invert()
    hollow = body(outer + inner)
    assert winding_numbers(points, hollow) == pytest.approx([0, 1, 0, 0], abs=1e-9)
    assert len(part_points(hollow)) == 2


def test_winding_numbers_agree_with_signed_distance_on_a_real_mesh() -> None:
    from igl import signed_distance

    mesh = PAIRS[2].b.load()
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    points = np.random.default_rng(0).uniform(low, high, size=(200, 3))
    signed = signed_distance(points, mesh.vertices, mesh.faces.astype(np.int64))[0]
    assert ((np.abs(winding_numbers(points, mesh)) > 0.5) == (signed < 0)).all()


def test_truth_includes_containment_both_ways_and_of_each_part() -> None:
    at = np.eye(4)
    ball, core = body(trimesh.creation.icosphere(2)), body(trimesh.creation.icosphere(1, 0.1))
    assert Truth(ball, core, at).collides(at)
    assert Truth(core, ball, at).collides(at)
    assert not Truth(ball, core, at).touches(at)
    far = trimesh.creation.icosphere(1, 0.1)
    far.apply_translation((3, 0, 0))
    pair = body(far + trimesh.creation.icosphere(1, 0.1))
    assert Truth(ball, pair, at).collides(at)
    open_ball = Mesh("", ball.vertices, ball.faces[1:])
    assert not Truth(open_ball, core, at).collides(at)


def test_six_pairs_of_different_watertight_concave_meshes_from_three_packages() -> None:
    sources = [source for pair in PAIRS for source in (pair.a, pair.b)]
    assert len(PAIRS) >= 6
    assert len({source.path for source in sources}) == len(sources)
    assert len({source.package for source in sources}) == 3
    for source in sources:
        mesh = source.load()
        solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        assert solid.is_watertight
        assert abs(solid.volume) < 0.75 * solid.convex_hull.volume


def test_errors_of_each_method_are_as_documented(results: list[PairResult]) -> None:
    for result in results:
        assert 0.3 <= result.hit_share <= 0.5
        assert (row(result, "exact").precision, row(result, "exact").recall) == (1.0, 1.0)
        for method in ("crease", "tolerance"):
            assert row(result, method).false_hits == 0
        for method in ("AABB", "OBB", "sphere", "hull", "grid"):
            if not result.contained:
                assert row(result, method).missed == 0
            assert row(result, method).false_hits > row(result, "exact").false_hits
        assert row(result, "hull").false_hits <= row(result, "OBB").false_hits
    total = {row.method: row for row in overall(results)}
    assert total["loop"].recall is not None
    assert total["loop"].recall < 1.0
    assert total["loop"].false_hits > 0


def test_counts_add_up_and_tests_are_the_published_walk(results: list[PairResult]) -> None:
    for result in results:
        hits = round(result.hit_share * result.poses)
        assert all(row.hits + row.missed == hits for row in result.rows)
        assert all(row.microseconds > 0.0 for row in result.rows)
        assert [row(result, m).tests for m in ("AABB", "OBB", "sphere", "hull")] == [1, 1, 1, 1]
        counts = [row(result, m).tests for m in ("loop", "crease", "tolerance", "exact")]
        assert counts == sorted(counts)
    total = overall(results)
    for k, merged in enumerate(total):
        assert merged.hits == sum(result.rows[k].hits for result in results)


def test_same_seed_same_verdicts(results: list[PairResult]) -> None:
    again = compare_pair(PAIRS[3], 60, np.random.default_rng(3), 1e-3)
    counts = [
        [(row.method, row.hits, row.false_hits, row.missed, row.tests) for row in result.rows]
        for result in (again, results[1])
    ]
    assert counts[0] == counts[1]


def test_ratios_without_a_denominator_are_none() -> None:
    assert Row("none", 0, 0, 5, 1.0, 1.0).precision is None
    assert Row("none", 0, 0, 5, 1.0, 1.0).recall == 0.0
    assert Row("none", 0, 3, 0, 1.0, 1.0).recall is None


def test_command_writes_json_csv_and_a_picture(tmp_path: Path) -> None:
    table, picture = tmp_path / "table.csv", tmp_path / "bars.png"
    arguments = ["compare", "--poses", "10", "--json", "--csv", table, "--plot", picture]
    done = CliRunner().invoke(app, list(map(str, arguments)))
    assert done.exit_code == 0, done.output
    document = json.loads(done.stdout)
    assert [pair["pair"] for pair in document["pairs"]] == [pair.name for pair in PAIRS]
    methods = [found["method"] for found in document["overall"]]
    assert methods == [
        "loop",
        "crease",
        "tolerance",
        "exact",
        "AABB",
        "OBB",
        "sphere",
        "hull",
        "grid",
    ]
    with table.open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert len(lines) == len(PAIRS) * len(methods)
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_command_refuses_a_tolerance_of_zero() -> None:
    done = CliRunner().invoke(app, ["compare", "--tolerance", "0"])
    assert isinstance(done.exception, ValueError)
    assert "tolerance: got 0.0" in str(done.exception)

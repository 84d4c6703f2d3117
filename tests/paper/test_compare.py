"""The comparison: its truth against others, its counts, and what the command prints and writes."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

from fgenv.bench.common.meshes import Mesh
from fgenv.bench.comparison import PAIRS, Outcome, Row, compare_pair, over_all
from fgenv.bench.peers.ground_truth import Truth, part_points, winding_numbers
from fgenv.cli import app


def body(mesh: trimesh.Trimesh) -> Mesh:
    return Mesh("", np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int32))


@pytest.fixture(scope="module")
def outcomes() -> list[Outcome]:
    """The two pairs with the fewest triangles, 60 poses each."""
    return [compare_pair(PAIRS[k], 60, np.random.default_rng(k), 1e-3) for k in (1, 3)]


def row(outcome: Outcome, method: str) -> Row:
    return next(row for row in outcome.rows if row.method == method)


def test_winding_numbers_of_nested_shells() -> None:
    outer, inner = trimesh.creation.box(), trimesh.creation.icosphere(2, 0.3)
    both = body(trimesh.util.concatenate([outer, inner]))
    points = np.array([[0.0, 0, 0], [0.4, 0.4, 0.4], [0.6, 0, 0], [5, 5, 5]])
    assert winding_numbers(points, both) == pytest.approx([2, 1, 0, 0], abs=1e-9)
    inner.invert()
    hollow = body(trimesh.util.concatenate([outer, inner]))
    assert winding_numbers(points, hollow) == pytest.approx([0, 1, 0, 0], abs=1e-9)
    assert len(part_points(hollow)) == 2


def test_winding_numbers_agree_with_signed_distance_on_a_real_mesh() -> None:
    from igl import signed_distance

    mesh = PAIRS[2].b.load()
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    points = np.random.default_rng(0).uniform(low, high, size=(200, 3))
    signed = signed_distance(points, mesh.vertices, mesh.faces.astype(np.int64))[0]
    assert ((np.abs(winding_numbers(points, mesh)) > 0.5) == (signed < 0)).all()


def test_truth_knows_containment_both_ways_and_of_each_part() -> None:
    at = np.eye(4)
    ball, core = body(trimesh.creation.icosphere(2)), body(trimesh.creation.icosphere(1, 0.1))
    assert Truth(ball, core, at).collides(at)
    assert Truth(core, ball, at).collides(at)
    assert not Truth(ball, core, at).touches(at)
    far = trimesh.creation.icosphere(1, 0.1)
    far.apply_translation((3, 0, 0))
    pair = body(trimesh.util.concatenate([far, trimesh.creation.icosphere(1, 0.1)]))
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


def test_methods_are_as_the_method_page_says(outcomes: list[Outcome]) -> None:
    for outcome in outcomes:
        assert 0.3 <= outcome.hit_share <= 0.5
        assert (row(outcome, "exact").precision, row(outcome, "exact").recall) == (1.0, 1.0)
        for method in ("crease", "tolerance"):
            assert row(outcome, method).false_hits == 0
        for method in ("AABB", "OBB", "sphere", "hull", "grid"):
            if not outcome.contained:
                assert row(outcome, method).missed == 0
            assert row(outcome, method).false_hits > row(outcome, "exact").false_hits
        assert row(outcome, "hull").false_hits <= row(outcome, "OBB").false_hits
    overall = {row.method: row for row in over_all(outcomes)}
    assert overall["loop"].recall is not None
    assert overall["loop"].recall < 1.0
    assert overall["loop"].false_hits > 0


def test_counts_add_up_and_tests_are_the_published_walk(outcomes: list[Outcome]) -> None:
    for outcome in outcomes:
        hits = round(outcome.hit_share * outcome.poses)
        assert all(row.hits + row.missed == hits for row in outcome.rows)
        assert all(row.microseconds > 0.0 for row in outcome.rows)
        assert [row(outcome, m).tests for m in ("AABB", "OBB", "sphere", "hull")] == [1, 1, 1, 1]
        counts = [row(outcome, m).tests for m in ("loop", "crease", "tolerance", "exact")]
        assert counts == sorted(counts)
    total = over_all(outcomes)
    for k, merged in enumerate(total):
        assert merged.hits == sum(outcome.rows[k].hits for outcome in outcomes)


def test_same_seed_same_verdicts(outcomes: list[Outcome]) -> None:
    again = compare_pair(PAIRS[3], 60, np.random.default_rng(3), 1e-3)
    counts = [
        [(row.method, row.hits, row.false_hits, row.missed, row.tests) for row in outcome.rows]
        for outcome in (again, outcomes[1])
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


def test_command_refuses_a_tolerance_that_is_none() -> None:
    done = CliRunner().invoke(app, ["compare", "--tolerance", "0"])
    assert isinstance(done.exception, ValueError)
    assert "tolerance is 0.0" in str(done.exception)

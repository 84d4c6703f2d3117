"""The race of methods over frozen sets: its counts hold, and bad input is reported."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from fgenv.bench.fleets.report import table_of
from fgenv.bench.fleets.run import attempt, bench_fleets
from fgenv.bench.fleets.sets import FLEETS, Fleet, select_fleets
from fgenv.cli import app
from fgenv.planners.methods import METHODS
from fgenv.scenarios import Scenario

SMALL = Fleet("doorway, 2", "doorway", {"n": 2}, 20.0)


def test_every_method_solves_a_small_set() -> None:
    rows = list(bench_fleets((SMALL,), 2))
    assert [row["method"] for row in rows] == list(SMALL.methods)
    for row in rows:
        assert row["solved"] == row["cases"] == 2
        assert row["failed"] == []
        assert 0 < row["makespan"] <= row["sum_of_costs"]
        assert row["least"] >= 0
        assert len(row["set"]) == 64
    assert rows[0]["search"] is not None
    assert table_of(rows).row_count == 3


def test_what_is_not_solved_says_why() -> None:
    found = attempt(Scenario.load("swap", n=20), "composite", 0.1)
    assert not found["solved"]
    assert "no path for robot 1" in found["why"]


def test_fleets_are_chosen_by_words() -> None:
    assert {fleet.scenario for fleet in select_fleets("Pandas,forest")} == {"cell", "forest"}
    assert select_fleets("all") == FLEETS
    assert {method for fleet in FLEETS for method in fleet.methods} <= set(METHODS)
    with pytest.raises(ValueError, match="fleets: got 'trucks', expected a part of: swap"):
        select_fleets("trucks")


def test_the_command_tells_in_json() -> None:
    done = CliRunner().invoke(
        app, ["bench", "fleets", "--fleets", "doorway", "--cases", "1", "--json"]
    )
    assert done.exit_code == 0
    rows = json.loads(done.stdout)["rows"]
    assert [row["method"] for row in rows] == ["composite", "prioritized", "conflict_based"]

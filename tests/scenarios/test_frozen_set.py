"""Frozen evaluation sets: the same cases everywhere, known by a hash."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from fgenv.cli import app
from fgenv.scenarios import Scenario, ScenarioError, frozen

GOLDEN: dict[str, tuple[dict[str, Any], str]] = {
    "swap": ({"n": 6, "jitter": 0.2}, "066f802ea4f37c6f"),
    "doorway": ({"n": 4}, "ac07ed56f9e9e12d"),
    "corridor": ({"n": 4}, "279c1deee0fa9a64"),
    "intersection": ({"n": 8}, "60a5f9002f2bb0ba"),
    "warehouse": ({"n": 16}, "d7bae7b0a2d0011c"),
    "forest": ({"n": 4}, "23d16671f6f6edf1"),
    "random": ({"n": 8}, "37a537b6e2c083f4"),
    "cell": ({"n": 2}, "c9df77c1f64ee2fb"),
    "three_tanks": ({}, "88b93b5fbd764bdb"),
}
CODE = """
from fgenv.scenarios import frozen
print(frozen("swap", cases=5, seed=0, n=6, jitter=0.2).id, frozen("cell", cases=5, seed=0, n=2).id)
"""


@pytest.mark.parametrize("name", GOLDEN)
def test_ids_are_golden(name: str) -> None:
    """Another id is another set: results with it are not comparable. Say so in the changelog."""
    ways, expected = GOLDEN[name]
    assert frozen(name, cases=5, seed=0, **ways).id[:16] == expected


@pytest.mark.parametrize("isa", ["baseline", ""])
def test_ids_do_not_depend_on_the_instruction_set(isa: str) -> None:
    setting = {**os.environ, "FGENV_ISA": isa, "FGENV_THREADS": "1"}
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, env=setting)
    assert [i[:16] for i in done.stdout.split()] == [GOLDEN["swap"][1], GOLDEN["cell"][1]]


@pytest.mark.parametrize("name", GOLDEN)
def test_a_set_comes_back_from_its_file(name: str, tmp_path: Path) -> None:
    ways, _ = GOLDEN[name]
    made = frozen(name, cases=4, seed=9, **ways)
    made.save(tmp_path / "set.npz")
    again = frozen(tmp_path / "set.npz", id=made.id[:10])
    assert again.id == made.id
    assert len(again) == 4
    for i, case in enumerate(again):
        assert case == Scenario.load(name, seed=9 + i, **ways).at(case.folder)
        assert case.problems() == ()
    with pytest.raises(IndexError, match="case 4 of 4"):
        again[4]


def test_a_set_is_small_on_disk(tmp_path: Path) -> None:
    made = frozen("warehouse", n=64, cases=20)
    made.save(tmp_path / "set.npz")
    assert (tmp_path / "set.npz").stat().st_size < 20 * 64 * 12


def test_what_is_damaged_or_another_set_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "set.npz"
    made = frozen("swap", cases=3)
    made.save(path)
    with pytest.raises(ScenarioError, match=r"has id .*, expected abc"):
        frozen(path, id="abc")
    with np.load(path) as file:
        arrays = dict(file)
    np.savez_compressed(path, **{**arrays, "starts": arrays["starts"] + 1})
    with pytest.raises(ScenarioError, match="damaged"):
        frozen(path)
    made.save(path)
    whole = path.read_bytes()
    for place in range(0, len(whole), 7):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0xFF]) + whole[place + 1 :])
        try:
            assert frozen(path).id == made.id  # the zip's own dates, and the like
        except ScenarioError as error:
            assert "damaged" in str(error)  # noqa: PT017
    for cut in (0, 10, len(whole) // 2, len(whole) - 3):
        path.write_bytes(whole[:cut])
        with pytest.raises(ScenarioError, match="damaged"):
            frozen(path)
    with pytest.raises(FileNotFoundError):
        frozen(tmp_path / "none.npz")
    with pytest.raises(TypeError, match="takes none"):
        frozen(path, n=3)
    with pytest.raises(ValueError, match="cases: got 0"):
        frozen("swap", cases=0)


def test_the_command_makes_one(tmp_path: Path) -> None:
    path = tmp_path / "set.npz"
    ways = ["swap", "--n", "6", "--set", "jitter=0.2", "--freeze", str(path), "--cases", "5"]
    done = CliRunner().invoke(app, ["scenarios", *ways, "--json"])
    said = json.loads(done.stdout)
    assert (done.exit_code, said["cases"], said["robots"]) == (0, 5, 6)
    assert said["id"] == frozen(path).id
    assert said["id"][:16] == GOLDEN["swap"][1]

"""`fgenv bench train`: rates, versions and plots."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

pytest.importorskip("stable_baselines3")

from fgenv.bench.train import run
from fgenv.cli import app


def test_parts_are_timed_by_the_clock() -> None:
    now = 0.0

    def clock() -> float:
        return now

    parts = run.Parts(clock)
    for _ in range(2):
        parts._on_rollout_start()
        now += 1.5
        parts._on_rollout_end()
        now += 4.0
    assert parts.gathering == 3.0


def test_rates_are_medians() -> None:
    class One:
        n_envs = 8

    found = run.record("x", One(), [(0.1, 0.5), (0.2, 0.2), (0.4, 0.25)])
    assert found == {"name": "x", "rows": 8, "gather": 5.0, "learn": 4.0}


def test_the_command_tells_rates_and_draws_them(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pytest.importorskip("supersuit")
    monkeypatch.setattr(run, "ROWS", {"fgenv": 2, "SuperSuit": 2})
    path = tmp_path / "rates.png"
    done = CliRunner().invoke(
        app, ["bench", "train", "--rounds", "1", "--json", "--plot", str(path)]
    )
    assert done.exit_code == 0, done.output
    assert path.stat().st_size > 1000
    rates = json.loads(done.stdout)["rates"]
    assert rates[0]["name"] == "fgenv"
    assert all(rate["rows"] == 16 and rate["gather"] > rate["learn"] > 0 for rate in rates)

"""``fgenv bench policies``: the goals as a table."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace as Namespace
from typing import Any

import pytest

from fgenv import cli
from fgenv.agents.weights import included
from fgenv.bench.policies.run import Trial, record, run, select_trials, trials


def test_what_comes_along_has_a_goal_and_a_safe_row() -> None:
    named = {trial.policy for trial in trials()}
    assert set(included()) <= named
    for trial in select_trials("shipped"):
        own = (f"mlp:{trial.policy}", f"safe:mlp:{trial.policy}")
        guided = ("orca:shortest",) if trial.scenario not in ("swap", "forest") else ()
        base = "goto" if trial.scenario == "forest" else "orca"
        assert trial.policies == (base, *guided, *own)
    assert len({trial.name for trial in trials()}) == len(list(trials()))


def test_more_than_orca_is_wanted_only_where_it_is_said() -> None:
    found: Any = Namespace(
        cases=Namespace(id=""),
        scores={name: score(share) for name, share in (("orca", 0.98), ("mine", 0.97))},
    )
    for above, goal in ((0.0, 0.9), (0.2, 1.0)):
        told = record(Trial("a", "swap", {}, "mine", 0.9, above), "mine", found)
        assert (told["goal"], told["met"]) == (goal, goal <= 0.97)


def test_drones_are_compared_with_who_flies_straight() -> None:
    rows = run(select_trials("forest 6")[0], 2, 1)
    assert [row["policy"] for row in rows][:1] == ["goto"]
    assert rows[0]["met"] is None


def score(share: float) -> Namespace:
    """One of so many successes."""
    some = Namespace(value=share)
    names = ("success", "robot_collision", "body_collision", "time_out", "extra_time")
    return Namespace(episodes=1, shared=1, **dict.fromkeys(names, some))


def test_a_set_that_is_none_is_told() -> None:
    with pytest.raises(ValueError, match="sets: got 'moon', expected a part of: swap"):
        select_trials("moon")


def test_the_command_tells_rows(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    plot = tmp_path / "shares.svg"
    line = ["bench", "policies", "--sets", "long 4 holonomic", "--cases", "3", "--json"]
    monkeypatch.setattr(sys, "argv", ["fgenv", *line, "--plot", str(plot)])
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    assert not stopped.value.code
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert "safe:mlp" in plot.read_text()  # a legend with the drawn policies
    assert [row["policy"] for row in rows] == [
        "orca",
        *select_trials("long 4 holonomic")[0].policies[1:],
    ]
    for row in rows:
        assert 0 <= row["success"][1] <= row["success"][0] <= row["success"][2] <= 1
        assert row["met"] == (None if row["policy"] == "orca" else row["success"][0] >= row["goal"])
    assert rows[2]["robot_collision"] == 0.0  # behind the filter

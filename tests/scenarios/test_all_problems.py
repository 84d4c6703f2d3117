"""Independent faults of one scenario are all reported in one run, sorted by line."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
import yaml

from fgenv.scenarios.load import validate

# Fault: robots, shapes and bodies that have it, and words of its report.
FAULTS: dict[str, tuple[dict[str, Any], str]] = {
    "schema": ({"shapes": {"flat": {"kind": "box", "size": [1, 1, -1]}}}, "shapes.flat.size[2]"),
    "key": ({"horizn": 3}, "horizn: is no known key; did you mean 'horizon'?"),
    "name": (
        {"robots": [{"name": "n", "model": "dics", "start": [3, 0, 0], "goal": [3, 1, 0]}]},
        "nothing is named 'dics'; did you mean 'disc'?",
    ),
    "file": ({"shapes": {"part": {"kind": "mesh", "file": "none.stl"}}}, "none.stl does not exist"),
    "limits": (
        {"robots": [{"name": "far", "model": "disc", "start": [99, 0, 0], "goal": [3, 3, 0]}]},
        "x is 99, outside the workspace",
    ),
    "contact": (
        {
            "robots": [{"name": "c", "model": "disc", "start": [-3, 0, 0], "goal": [-3, 3, 0]}],
            "bodies": [{"name": "wall", "shape": "cube", "position": [-3, 0, 0]}],
        },
        "meets 'wall'",
    ),
}
SETS = [c for size in (2, 3, 4, 5) for c in combinations(FAULTS, size)]


@pytest.mark.parametrize("faults", SETS, ids="+".join)
def test_all_faults_are_reported_in_one_run(tmp_path: Path, faults: tuple[str, ...]) -> None:
    cube = {"kind": "box", "size": [0.5, 0.5, 0.5]}
    data: dict[str, object] = {
        "version": 1,
        "name": "s",
        "workspace": {"low": [-5, -5], "high": [5, 5]},
    }
    shapes: dict[str, object] = {"cube": cube}
    lists: dict[str, list[object]] = {"robots": [], "bodies": []}
    for fault in faults:
        for key, value in FAULTS[fault][0].items():
            if key == "shapes":
                shapes |= value
            elif key in lists:
                lists[key] += value
            else:
                data[key] = value
    lists["robots"].append({"name": "r", "model": "disc", "start": [0, 0, 0], "goal": [0, 2, 0]})
    data |= {"shapes": shapes, "models": {"disc": {"base": "planar", "shape": "cube"}}, **lists}
    path = tmp_path / "s.yaml"
    path.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
    problems = validate(path)
    report = "\n".join(map(str, problems))
    assert len(problems) == len(faults), report
    for fault in faults:
        assert FAULTS[fault][1] in report
    lines = [problem.line or 0 for problem in problems]
    assert lines == sorted(lines)


def test_an_invalid_model_is_still_suggested(tmp_path: Path) -> None:
    path = tmp_path / "s.yaml"
    robot = "robots: [{name: a, model: dics, start: [0, 0, 0], goal: [1, 0, 0]}]\n"
    path.write_text(f"version: 1\nname: s\nmodels: {{disc: {{base: 3}}}}\n{robot}")
    assert "did you mean 'disc'?" in "\n".join(map(str, validate(path)))

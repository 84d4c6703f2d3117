"""Scenario files: all problems are reported at once, with lines and remedies."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import trimesh
import yaml
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from fgenv.cli import app
from fgenv.scenarios import Scenario, ScenarioError, validate

SOUND = """\
version: 1
name: two rooms
workspace: {low: [-5, -5], high: [5, 5]}
shapes:
  disc: {kind: disc, radius: 0.3}
  wall: {kind: box, size: [0.2, 4.0, 1.0]}
models:
  disc: {shape: disc, drive: {kind: differential, speed: 1.0, turn_rate: 2.0}}
robots:
- {name: a, model: disc, start: [-2, 0, 0], goal: [2, 0, 0]}
- {name: b, model: disc, start: [2, 1, 0], goal: [-2, 1, 0], groups: [guest]}
bodies:
- {name: wall, shape: wall, position: [0, 0, 0.5]}
"""
ARM = """\
version: 1
name: arm
models:
  arm: {urdf: 'package://fgenv/scenarios/library/arm.urdf', drive: {kind: joint_velocity}}
robots:
- {name: arm, model: arm, start: [0, 0, 0, 0, 0, 0], goal: [0, 0, 3.0, 0, 0, 0]}
"""


@pytest.fixture
def told(tmp_path: Path) -> Callable[[str], list[str]]:
    def problems(text: str) -> list[str]:
        (tmp_path / "s.yaml").write_text(text, encoding="utf-8")
        return [str(problem) for problem in validate(tmp_path / "s.yaml")]

    return problems


def test_a_sound_file_has_no_problems(told: Callable[[str], list[str]]) -> None:
    assert told(SOUND) == []


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("version: 1", "version: 2", "line 1: version: is 2; expected one of: 1"),
        ("version: 1\n", "", "line 1: version: is missing; add it: Version of this schema"),
        ("name: two", "nam: two", "line 2: nam: is no known key; did you mean 'name'?"),
        ("low: [-5", "low: [9", "line 3: workspace: low [9.0, -5.0] is not below high [5.0, 5.0]"),
        ("kind: disc", "kind: dics", "line 5: shapes.disc: kind 'dics' is unknown; did you mean"),
        ("kind: disc, ", "", "line 5: shapes.disc: has no kind; add kind:"),
        (
            "radius: 0.3",
            "radius: -1",
            "line 5: shapes.disc.radius: is -1, should be greater than 0",
        ),
        ("radius: 0.3", "radius: true", "line 5: shapes.disc.radius: is True, should be a valid"),
        ("radius: 0.3", "radius: yes", "line 5: got yes, which YAML 1.1 and YAML 1.2 read"),
        ("radius: 0.3", "radius: 1:30", "line 5: got 1:30, which YAML 1.1 and YAML 1.2 read"),
        ("radius: 0.3", "radius: .inf", "line 5: shapes.disc.radius: is inf, should be"),
        ("radius: 0.3", "height: 0.3", "line 5: shapes.disc.radius: is missing; add it: Radius"),
        ("speed: 1.0", "sped: 1.0", "line 8: models.disc.drive.sped: is no known key; did you"),
        ("{shape: disc, d", "{shape: dsc, d", "line 8: models.disc.shape: nothing is named 'dsc'"),
        ("{shape: disc, d", "{d", "line 8: models.disc: has no shape or urdf"),
        ("kind: differential", "kind: drone", "line 8: models.disc.drive: "),
        ("model: disc, start: [-2", "model: disk, start: [-2", "line 10: robots[0].model: nothing"),
        (
            "start: [-2, 0, 0]",
            "start: [-2, 0]",
            "line 10: robots[0].start: has 2 numbers, expected 3",
        ),
        (
            "start: [-2, 0, 0]",
            "start: [1.8, 0.8, 0]",
            "line 11: robots[1].start: overlaps the start",
        ),
        (
            "goal: [-2, 1, 0]",
            "goal: [2, 0.2, 0]",
            "line 11: robots[1].goal: overlaps the goal of 'a'",
        ),
        ("start: [-2, 0, 0]", "start: [0.3, 0, 0]", "line 10: robots[0].start: meets 'wall'; move"),
        (
            "goal: [2, 0, 0]",
            "goal: [0, 0, 0]",
            "line 10: robots[0].goal: meets 'wall'; move the goal",
        ),
        (
            "start: [-2, 0, 0]",
            "start: [-6, 0, 0]",
            "line 10: robots[0].start: x is -6, outside the",
        ),
        ("name: b", "name: a", "line 11: robots[1].name: 'a' names 2 robots or bodies"),
        ("name: b", "name: a/b", "line 11: robots[1].name: is 'a/b'"),
        (
            "shape: wall,",
            "shape: wal,",
            "line 13: bodies[0].shape: nothing is named 'wal'; did you",
        ),
        ("bodies:", "allowed: [[guest, wal]]\nbodies:", "line 12: allowed[0][1]: nothing is named"),
        (
            "bodies:",
            "time_step: 90\nbodies:",
            "line 12: time_step: is 90 s, longer than the horizon",
        ),
        (
            "bodies:",
            "name: again\nbodies:",
            "line 12: name: stands twice, first in line 2; keep one",
        ),
        ("robots:", "robots: 3\nx:", "line 9: robots: is 3, should be"),
        ("[0, 0, 0.5]", "[0, 0, 0.5", "line 13: is not YAML"),
        ("name: two rooms", "name: &a [*a]", "line 2: is not YAML: holds itself, by an alias"),
        ("name: two rooms", "name: !!python/none x", "line 2: is not YAML"),
    ],
)
def test_each_problem_has_its_line_and_remedy(
    told: Callable[[str], list[str]], old: str, new: str, expected: str
) -> None:
    assert old in SOUND
    found = told(SOUND.replace(old, new, 1))
    assert any(problem.startswith(expected) for problem in found), found


def test_all_are_told_at_once(told: Callable[[str], list[str]]) -> None:
    text = SOUND.replace("name: two", "nam: two").replace("radius: 0.3", "radius: 0.3, hue: red")
    text = text.replace("goal: [2, 0, 0]", "goal: [2, 0]").replace("[2, 1, 0]", "[0.1, 1, 0]")
    text += "- {name: bad, shape: none}\n- {name: worse, shape: wall, position: [a, 0, 0]}\n"
    lines = [problem.split(":")[0] for problem in told(text)]
    # A missing name is reported at the top of the file.
    assert lines == [f"line {n}" for n in (1, 2, 5, 10, 11, 14, 15)]


def test_joints_keep_their_limits_and_a_robot_its_distance_from_itself(
    told: Callable[[str], list[str]],
) -> None:
    (problem,) = told(ARM)
    assert problem.startswith(
        "line 6: robots[0].goal: elbow is 3, outside the joint's limits, -2.5"
    )
    (problem,) = told(ARM.replace("0, 0, 3.0, 0", "0, 1.9, 2.5, 0"))
    assert "touches itself" in problem
    (problem,) = told(ARM.replace("library/arm", "library/leg").replace("3.0", "1.0"))
    assert problem.startswith("line 4: models.arm: urdf: package://")


def test_goals_may_overlap_where_robots_vanish(told: Callable[[str], list[str]]) -> None:
    text = SOUND.replace("goal: [-2, 1, 0]", "goal: [2, 0.2, 0]")
    assert len(told(text)) == 1
    assert told(text + "at_goal: vanish\n") == []


def test_contacts_of_groups_may_be_allowed(told: Callable[[str], list[str]]) -> None:
    text = SOUND.replace("start: [2, 1, 0]", "start: [0, 1, 0]")
    assert len(told(text)) == 1
    assert told(text + "allowed: [[guest, static]]\n") == []


def own_mesh(folder: Path, more: str = "") -> tuple[Path, str]:
    trimesh.creation.box((300, 300, 300)).export(folder / "own.stl")
    text = SOUND.replace("{kind: disc, radius: 0.3}", "{kind: mesh, file: own.stl, scale: 1e-3X}")
    (folder / "s.yaml").write_text(text.replace("X", more), encoding="utf-8")
    return folder / "s.yaml", hashlib.sha256((folder / "own.stl").read_bytes()).hexdigest()


def test_meshes_are_found_beside_the_file_and_known_by_their_hash(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir("/")
    path, digest = own_mesh(tmp_path)
    assert validate(path) == []
    assert Scenario.load(path).build().robots[0].parts[0].shape.bounds[1, 0] == 0.15
    own_mesh(tmp_path, f", sha256: '{digest}'")
    assert len(Scenario.load(path).robots) == 2
    own_mesh(tmp_path, f", sha256: '{digest[:-1]}x'")
    assert "sha256: is" in str(validate(path)[0])
    own_mesh(tmp_path, f", sha256: '{digest[::-1]}'")
    assert "shapes.disc.sha256: sha256 of own.stl is" in str(validate(path)[0])
    with pytest.raises(ScenarioError, match=r"line 5: .*not as written"):
        Scenario.load(path)
    (tmp_path / "own.stl").unlink()
    (problem,) = validate(path)
    assert (problem.line, problem.where) == (5, "shapes.disc.file")
    assert "does not exist" in problem.text
    (tmp_path / "own.stl").write_text("solid nothing")
    own = SOUND.replace("{kind: disc, radius: 0.3}", "{kind: mesh, file: own.stl}")
    path.write_text(own, encoding="utf-8")
    assert "own.stl" in str(validate(path)[0])


def test_a_file_saved_elsewhere_still_finds_its_meshes(tmp_path: Path) -> None:
    path, _ = own_mesh(tmp_path)
    (tmp_path / "sub").mkdir()
    Scenario.load(path).save(tmp_path / "sub" / "s.yaml")
    assert "file: ../own.stl" in (tmp_path / "sub" / "s.yaml").read_text(encoding="utf-8")
    assert validate(tmp_path / "sub" / "s.yaml") == []


def test_numbers_may_have_an_exponent_and_values_defaults(tmp_path: Path) -> None:
    path = tmp_path / "s.yaml"
    path.write_text(SOUND.replace("radius: 0.3", "radius: 3e-1"), encoding="utf-8")
    scenario = Scenario.load(path, seed=8)
    assert scenario.shapes["disc"].radius == 0.3  # type: ignore[union-attr]
    assert (scenario.seed, scenario.time_step, scenario.at_goal) == (8, 0.1, "park")
    with pytest.raises(ScenarioError, match="n: is no known override"):
        Scenario.load(path, n=3)


# The command -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "code", "out"),
    [(SOUND, 0, "0 problems"), (ARM, 1, "line 6"), ("", 1, "holds nothing"), ("[", 1, "not YAML")],
)
def test_the_command_tells_by_its_exit_code(text: str, code: int, out: str, tmp_path: Path) -> None:
    path = tmp_path / "s.yaml"
    path.write_text(text, encoding="utf-8")
    done = CliRunner().invoke(app, ["validate", str(path)])
    assert done.exit_code == code
    assert out in done.stdout
    said = json.loads(CliRunner().invoke(app, ["validate", str(path), "--json"]).stdout)
    assert said["valid"] is (code == 0)
    assert all(p["line"] and p["text"] for p in said["problems"]) or text == "["


@pytest.mark.parametrize("name", [".", "none.yaml"])
def test_what_cannot_be_read_is_an_error(name: str, tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"No such file|directory"):
        validate(tmp_path / name)


# Nothing raises but with a message ---------------------------------------------------------------

VALUES: st.SearchStrategy[Any] = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.dates()
    | st.text(max_size=8)
    | st.sampled_from(["disc", "wall", "box", "mesh", "a", "package://fgenv/", "/", 10**400, -0.0]),
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=6), inner, max_size=3)
    ),
    max_leaves=6,
)


def spots(data: Any) -> list[tuple[Any, Any]]:
    """All places of a document: a collection, and an index or key."""
    keys = list(data) if isinstance(data, dict) else list(range(len(data)))
    inner = [(data, key) for key in keys]
    for key in keys:
        if isinstance(data[key], (dict, list)):
            inner += spots(data[key])
    return inner


@given(st.data(), st.sampled_from([SOUND, ARM]))
def test_other_values_never_end_in_a_traceback(
    tmp_path_factory: pytest.TempPathFactory, draw: st.DataObject, text: str
) -> None:
    data = yaml.safe_load(text)
    for _ in range(draw.draw(st.integers(1, 3))):
        around, key = draw.draw(st.sampled_from(spots(data)))
        what = draw.draw(st.sampled_from(["other", "gone", "more"]))
        if what == "gone":
            around.pop(key)
        elif what == "more" and isinstance(around, dict):
            around[draw.draw(st.text(max_size=5) | st.integers() | st.none())] = draw.draw(VALUES)
        else:
            around[key] = draw.draw(VALUES)
        if not spots(data):
            break
    check(tmp_path_factory, yaml.safe_dump(data, allow_unicode=True))


@given(st.data())
def test_other_text_never_ends_in_a_traceback(
    tmp_path_factory: pytest.TempPathFactory, draw: st.DataObject
) -> None:
    text = SOUND
    for _ in range(draw.draw(st.integers(1, 4))):
        at = draw.draw(st.integers(0, len(text)))
        cut = draw.draw(st.integers(0, 6))
        text = (
            text[:at]
            + draw.draw(st.text("[]{}:,-&*!|>%@`'\"# \n\tax0.e=?<~", max_size=4))
            + text[at + cut :]
        )
    check(tmp_path_factory, text)


def check(folder: pytest.TempPathFactory, text: str) -> None:
    """Either sound, and then it loads and saves; or problems, each with words."""
    path = folder.getbasetemp() / "mutant.yaml"
    path.write_text(text, encoding="utf-8", errors="replace")
    problems = validate(path)
    assert all(str(problem) for problem in problems)
    if problems:
        return
    scenario = Scenario.load(path)
    scenario.save(path)
    assert Scenario.load(path) == scenario

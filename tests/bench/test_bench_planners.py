"""`fgenv bench planners` on one small problem."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from fgenv.bench.planners import arm_run, recording, replay, rigid_run
from fgenv.bench.planners.coal_ import coal_bodies
from fgenv.bench.planners.fcl_ import fcl_bodies
from fgenv.bench.planners.goals import goals
from fgenv.bench.planners.methods import (
    CERTIFIED,
    COAL,
    DISCRETE,
    FCL,
    methods_of,
    plugin,
    python_checker,
)
from fgenv.bench.planners.report import tables_of
from fgenv.bench.planners.rigid import verdicts
from fgenv.bench.planners.run import PlannerBenchConfig, bench_planners, silent
from fgenv.bench.planners.search import path_check, run, seeded
from fgenv.bench.planners.task import Task
from fgenv.cli import app
from fgenv.cli.errors import describe, exit_code

LIMIT = 20.0  # seconds; the problem takes a hundredth of one


@pytest.fixture(autouse=True)
def quiet() -> Iterator[None]:
    with silent():
        yield


@pytest.fixture(scope="module")
def task() -> Task:
    return Task.of("cubicles")


@pytest.fixture(scope="module")
def pair() -> Task:
    return Task.of("cubicles:2")


@pytest.mark.parametrize("bodies", [fcl_bodies, coal_bodies])
@pytest.mark.parametrize("which", ["task", "pair"])
def test_the_libraries_say_what_the_world_says(
    bodies: Any, which: str, request: pytest.FixtureRequest
) -> None:
    task = request.getfixturevalue(which)
    row = np.empty(task.samples.shape[1])
    q = np.concatenate([task.samples[:300], task.ends])
    search = seeded(plugin(task.problem), 0)
    valid = np.asarray(search.validity._core.valid(q))
    hits = np.array(verdicts(bodies(task)(row), row, q))
    assert 0 < valid.sum() < len(q)
    # A body inside another without touching it is seen by the world alone.
    assert not (hits & valid).any()
    assert (hits != ~valid).mean() < 0.05
    assert valid[-2:].all()


def test_both_take_as_many_steps_in_the_mean(task: Task) -> None:
    search = seeded(python_checker(task, fcl_bodies(task)), 0)
    search.simple.setup()
    space, write = search.si.getStateSpace(), search.buffer.write
    a, b = search.si.allocState(), search.si.allocState()
    q0, q1 = np.split(task.samples, 2)
    ours_, theirs_ = [], []
    for x, y in zip(q0[:500], q1[:500], strict=True):
        theirs_.append(space.validSegmentCount(write(a, x), write(b, y)))
        ours_.append(task.steps(x, y, task.resolution))
    assert np.mean(theirs_) == pytest.approx(np.mean(ours_), rel=0.05)


def test_the_same_seed_searches_the_same_by_every_way(task: Task) -> None:
    found = {
        name: run(seeded(way, 2), LIMIT) for name, way in methods_of(task, [FCL, COAL]).items()
    }
    judge = path_check(task, fcl_bodies(task))
    own = found[CERTIFIED].path
    assert own is not None
    assert not judge(own)
    np.testing.assert_allclose(own[[0, -1]], task.ends, atol=1e-12)
    assert found[FCL].motions == found[COAL].motions > 0
    assert found[FCL].states == found[COAL].states > found[FCL].motions
    again = run(seeded(plugin(task.problem), 2), LIMIT)
    assert (again.motions, again.states) == (found[CERTIFIED].motions, found[CERTIFIED].states)


def test_the_judge_sees_a_wall_between_two_states(task: Task) -> None:
    start, _ = task.ends
    outside = start.copy()
    outside[2] = -1.0  # below the floor, which is 0.1 m thick
    search = seeded(plugin(task.problem), 0)
    assert search.validity._core.valid(np.array([start, outside])).all()
    assert path_check(task, fcl_bodies(task))(np.array([start, outside]))
    assert not path_check(task, fcl_bodies(task))(np.array([start, start]))


def test_the_floor_is_the_same_search(task: Task) -> None:
    way = plugin(task.problem)
    known = recording.record_checks(way, 2, LIMIT)
    found = run(seeded(way, 2), LIMIT, shorten=False)
    least = recording.run_floor(way, 2, LIMIT, known)
    assert least.motions == found.motions == len(known.free)
    assert least.states == found.states == len(known.valid)
    core = seeded(way, 2).simple.motions._core
    assert np.array_equal(core.free(known.starts, known.ends), known.free)


def test_a_problem_has_every_row(task: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(replay, "EDGES", 60)
    monkeypatch.setattr(replay, "ROUNDS", 1)
    expected = PlannerBenchConfig(("cubicles",), (2,), LIMIT, mbm=0)
    heard: list[str] = []
    done: dict[str, list[dict[str, Any]]] = {}
    for kind, record in bench_planners(expected, heard.append):
        done.setdefault(kind, []).append(record)
    assert list(done) == ["problems", "goals"]
    (record,), (reached,) = done["problems"], done["goals"]
    assert list(record["ways"]) == [CERTIFIED, DISCRETE, FCL, COAL]
    assert record["ways"][CERTIFIED]["hidden"] == 0
    assert all(way["solved"] == way["of"] == 1 for way in record["ways"].values())
    assert all(way["motions"] > 100 for way in record["ways"].values())
    assert record["edges"]["edges"] == 60
    for kind in ("all", "hit", "free", "states"):
        assert {CERTIFIED, DISCRETE, FCL, COAL} <= set(record["edges"][kind])
    assert record["floor"]["times"] > 0
    assert reached["hidden collisions"]["measured"] == 0
    assert len(reached) == 6
    assert heard[0] == "cubicles: seed 2, certified"
    json.dumps(done)
    rows = [table.row_count for table, _ in tables_of("problems", [record])]
    assert rows == [4, 4, 1]
    assert tables_of("goals", [reached])[0][0].row_count == len(reached)


@pytest.mark.parametrize("name", [CERTIFIED, FCL])
def test_a_search_ends_when_its_time_is_over(name: str) -> None:
    trap = Task.of("rings")
    found = run(seeded(methods_of(trap, [FCL])[name], 0), 0.2)
    assert found.path is not None or 0.15 < found.seconds < 3.0


def test_a_search_without_a_solution_took_for_ever(task: Task) -> None:
    record = rigid_run.race_trap(Task.of("bug_trap"), [0], 0.05, lambda doing: None)
    assert list(record["ways"]) == [CERTIFIED, FCL]
    if not record["ways"][CERTIFIED]["solved"]:
        assert record["ways"][CERTIFIED]["seconds"] is None
    assert tables_of("traps", [record])[0][0].row_count == 2
    assert rigid_run.ratios(record) == {} or record["ways"][FCL]["solved"]


def test_an_arm_against_pinocchio(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fgenv.bench.planners.search.FINER", 10)
    pytest.importorskip("pinocchio")
    pytest.importorskip("yourdfpy")
    record = arm_run.race_family("bookshelf_thin", [1], 0, LIMIT, lambda doing: None)
    own = record["ways"][CERTIFIED]
    assert own["solved"] == [True]
    assert own["hidden"] == 0
    found = arm_run.family_statistics([record])
    assert found[CERTIFIED]["median"] > 0
    assert tables_of("mbm", [record])[0][0].row_count == 4
    assert goals({"problems": [], "mbm": [record]})["mbm: share solved"]["measured"] == 1.0


@pytest.mark.parametrize(
    ("expected", "told"),
    [
        (
            PlannerBenchConfig(peers=("python-fcl", "bullet")),
            "'bullet', expected some of",
        ),
        (PlannerBenchConfig(peers=("coal",)), "expected python-fcl among them"),
        (PlannerBenchConfig(limit=0.0), "time_limit: got 0.0, expected seconds over 0"),
    ],
)
def test_what_makes_no_sense_is_told(expected: PlannerBenchConfig, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        expected.check()


@pytest.mark.parametrize("name", ["warehouse", "cubicles:two", "forest", "mbm"])
def test_other_problems_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match="problems: "):
        Task.of(name)


def test_resolution_is_checked() -> None:
    with pytest.raises(ValueError, match=r"resolution: got -1\.0, expected meters over 0"):
        Task.of("cubicles", -1.0)


def test_what_is_not_installed_is_told_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "fcl", None)
    with pytest.raises(ImportError) as raised:
        PlannerBenchConfig().check()
    assert describe(raised.value) == "fcl is not installed; remedy: pip install 'fgenv[bench]'"
    monkeypatch.undo()
    monkeypatch.setattr("fgenv.bench.planners.run.find_spec", lambda name: None)
    assert PlannerBenchConfig().arms == []
    with pytest.raises(ImportError) as raised:
        PlannerBenchConfig(mbm=2).check()
    assert describe(raised.value) == "pinocchio is not installed; remedy: pip install pin"
    assert exit_code(raised.value) == 2


def test_the_command_gives_one_document(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(replay, "EDGES", 40)
    monkeypatch.setattr(replay, "ROUNDS", 1)
    line = ["bench", "planners", "--quick", "--json", "--seed", "2"]
    done = CliRunner().invoke(app, line)
    assert done.exit_code == 0
    said = json.loads(done.stdout)
    assert said["settings"]["seeds"] == [2, 3]
    assert {"fgenv", "ompl", "python-fcl", "coal"} == set(said["versions"])
    assert [record["problem"] for record in said["problems"]] == ["cubicles"]
    assert "certified" in done.stderr

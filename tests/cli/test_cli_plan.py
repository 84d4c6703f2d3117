"""``fgenv plan``, ``fgenv verify`` and ``fgenv run --policy plan``: reports and errors."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from support.processes import wait_for_cpu
from support.shell import Shell

from fgenv.cli import errors
from fgenv.envs import Record, replay
from fgenv.planners import Plan
from fgenv.planners.plan import PLAN

SCRIPT = Path(sys.executable).with_name("fgenv")


def test_a_plan_is_reported_saved_certified_and_executed(shell: Shell) -> None:
    code, out, err = shell("plan", "doorway", "--n", 2, "--out", "p.npz")
    assert (code, err) == (0, "")
    for text in ("robot 1", "arrives (s)", "makespan", "proved free", "nearer", "written: p.npz"):
        assert text in out
    assert shell("verify", "p.npz")[0] == 0
    data = shell.json("run", "doorway", "--n", 2, "--policy", "plan:p.npz", "--record", "r.npz")
    plan = Plan.load("p.npz")
    assert (data["success_rate"], data["steps_in_contact"]) == (1.0, 0)
    assert data["tracking_error"] < 1e-9
    assert data["makespan"] <= plan.makespan + 1e-9
    replay(Record.load("r.npz"))


def test_json_equals_the_file(shell: Shell) -> None:
    data = shell.json("plan", "cell", "--method", "composite", "--seed", 2, "--out", "p.npz")
    plan = Plan.load("p.npz")
    assert (data["id"], data["seed"], data["written"]) == (plan.id, 2, ["p.npz"])
    assert data["makespan"] == plan.makespan
    assert [robot["arrival"] for robot in data["robots"]] == list(plan.arrivals)
    assert data["certificate"]["proved"]
    proof = shell.json("verify", "p.npz")
    assert (proof["id"], proof["steps"], proof["failed_step"]) == (plan.id, plan.steps, None)


def test_same_arguments_same_plan(shell: Shell) -> None:
    arguments = "plan", "swap", "--n", 3, "--method", "composite"
    one, two = (shell.json(*arguments, "--seed", 1) for _ in range(2))
    assert one["robots"] == two["robots"]
    assert one["robots"] != shell.json(*arguments, "--seed", 2)["robots"]


@pytest.mark.parametrize(
    ("start", "goal"), [("-1,0,0", "1,0,0"), ("-1,0,0,0,0,0,1", "1,0,0,0,0,1,0")]
)
def test_own_meshes_are_planned(shell: Shell, start: str, goal: str) -> None:
    trimesh.creation.box((400, 300, 200)).export("robot.stl")
    walls = [trimesh.creation.box((200, 2000, 2000)) for _ in range(2)]
    for side, wall in zip((-1, 1), walls, strict=True):
        wall.apply_translation((0, 1300 * side, 0))
    trimesh.util.concatenate(walls).export("room.stl")
    ends = f"--start={start}", f"--goal={goal}", "--scale", 0.001, "--out", "m.npz"
    data = shell.json("plan", "--mesh", "robot.stl", "--world", "room.stl", *ends)
    assert data["certificate"]["proved"]
    assert data["robots"][0]["path_length"] >= 2.0
    assert shell("verify", "m.npz")[0] == 0
    trimesh.creation.box((500, 300, 200)).export("robot.stl")
    code, _, err = shell("verify", "m.npz")
    assert code == errors.BAD_INPUT
    assert "robot.stl" in err


def test_margins_and_tampering_are_found(shell: Shell) -> None:
    assert shell("plan", "doorway", "--n", 2, "--method", "composite", "--out", "p.npz")[0] == 0
    code, out, err = shell("verify", "p.npz", "--margin", 0.3)
    assert (code, err) == (errors.FAILED_CHECK, "")
    assert "not proved: step" in out
    assert "robot" in out.rpartition("free: ")[2]
    with np.load("p.npz") as file:
        arrays = dict(file)
    arrays["configurations_0"][5, 1] += 1.0
    np.savez("q.npz", **arrays)
    assert shell("verify", "q.npz")[::2] == (
        2,
        "fgenv: q.npz: is damaged, or no plan; plan again\n",
    )
    texts = {name: str(arrays[name]) for name in ("scenario", "about")}
    rows = {
        f"{name}_{i}": arrays[f"{name}_{i}"]
        for name in ("configurations", "waypoints")
        for i in (0, 1)
    }
    np.savez("q.npz", **{**arrays, "id": PLAN.id(texts, rows)})
    code, _, err = shell("verify", "q.npz")
    assert code == errors.BAD_INPUT
    assert "'robot 1' goes where its drive cannot" in err


def test_no_plan_is_1_and_one_line(shell: Shell) -> None:
    for command in (
        ("plan", "swap", "--n", 3, "--margin", 5),
        ("plan", "corridor", "--n", 8, "--method", "composite", "--time-limit", 0.05),
    ):
        code, out, err = shell(*command)
        assert (code, out, err.count("\n")) == (errors.FAILED_CHECK, "", 1)
        assert err.startswith("fgenv: ")
    shell("plan", "swap", "--n", 2, "--out", "p.npz")
    code, out, err = shell("run", "swap", "--n", 3, "--policy", "plan:p.npz")
    assert (code, out) == (errors.FAILED_CHECK, "")
    assert "plan: got robots robot 1, robot 2, expected" in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("plan", "expected one, or --mesh"),
        ("plan swop", "'swop' is no built-in scenario; did you mean 'swap'?"),
        ("plan none.yaml", "none.yaml: No such file or directory"),
        ("plan swap --method compsite", "--method: got 'compsite'; did you mean 'composite'?"),
        ("plan swap --n 1 --planner RTT", "--planner: got 'RTT'; did you mean 'RRT'"),
        ("plan swap --planner PRM", "planner: got 'PRM' with the method 'prioritized', which does"),
        (
            "plan swap --no-simplify",
            "simplify: got False with the method 'prioritized'",
        ),
        ("plan swap --scale 2", "--scale: expected with --mesh"),
        ("run swap --policy plan:prioritized:PRM", "planner: got 'PRM' with the method"),
        (
            "plan swap --objective speed",
            "--objective: got 'speed'; expected one of: length, clearance, time",
        ),
        ("plan swap --time-limit 0", "--time-limit: got 0.0, expected finite seconds over 0"),
        ("plan swap --margin -1", "--margin: got -1.0, expected a finite number, 0 or more"),
        ("plan swap --out p.json", "--out: got p.json, expected a name that ends in .npz"),
        ("plan swap --out none/p.npz", "--out: none/p.npz: there is no folder none"),
        ("plan swap --start 1,2,3", "--start: expected with --mesh"),
        ("plan --mesh r.stl --start 1,2,3", "--mesh: expected with --start and --goal"),
        ("plan --mesh r.stl --start 1,2 --goal 1,2", "--start: got '1,2', expected x,y,yaw or"),
        ("plan --mesh r.stl --start a,b,c --goal 1,2,3", "--start: got 'a,b,c', expected numbers"),
        ("plan --mesh none.stl --start 1,2,3 --goal 1,2,3", "none.stl"),
        ("verify none.npz", "none.npz: No such file or directory"),
        ("run swap --policy plan:none.npz", "none.npz: No such file or directory"),
        ("run swap --policy plan:compsite", "method: got 'compsite', which is unknown"),
    ],
)
def test_bad_input_is_2_and_one_line(shell: Shell, arguments: str, message: str) -> None:
    code, out, err = shell(*arguments.split())
    assert (code, out, err.count("\n")) == (errors.BAD_INPUT, "", 1)
    assert message in err
    assert list(Path().iterdir()) == []


def test_a_file_that_is_no_plan_is_2(shell: Shell) -> None:
    Path("p.npz").write_text("no plan")
    assert shell("verify", "p.npz")[::2] == (
        2,
        "fgenv: p.npz: is damaged, or no plan; plan again\n",
    )
    assert shell("run", "swap", "--policy", "plan:p.npz")[0] == errors.BAD_INPUT


def test_an_interrupted_search_keeps_the_best_plan(tmp_path: Path) -> None:
    limits = "--planner", "RRTstar", "--method", "composite", "--time-limit", "60"
    out_file = str(tmp_path / "p.npz")
    command = [str(SCRIPT), "plan", "swap", "--n", "2", *limits, "--out", out_file]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
        wait_for_cpu(run, 5.0)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate()
    assert run.returncode == errors.INTERRUPTED
    assert err == b""
    if out:  # else there was no plan yet
        assert b"proved free" in out
        assert Plan.load(tmp_path / "p.npz").certificate


def test_tab_completes_methods() -> None:
    from fgenv.cli.completion import methods, policy_names

    assert "composite" in methods()
    assert {"plan", "plan:composite"} <= set(policy_names("plan"))


def test_planners_are_compared_over_seeds(shell: Shell, monkeypatch: pytest.MonkeyPatch) -> None:
    command = "plan", "swap", "--n", 1, "--planner", "RRTConnect", "--planner", "PRM"
    data = shell.json(*command, "--seeds", "0:3", "--csv", "r.csv")
    assert [(row["planner"], row["attempts"]) for row in data["rows"]] == [
        ("RRTConnect", 3),
        ("PRM", 3),
    ]
    assert all(row["success"][0] == 1.0 for row in data["rows"])
    assert all(
        low <= value <= high for row in data["rows"] for value, low, high in [row["seconds"]]
    )
    table = Path("r.csv").read_text()
    Path("r.csv").write_text(table + "cut off,RR")  # as a kill leaves it
    with monkeypatch.context() as patch:
        patch.setattr("fgenv.planners.planning.plan", None)  # nothing is planned again
        assert shell.json(*command, "--seeds", "0:3", "--csv", "r.csv")["rows"] == data["rows"]
    Path("r.csv").write_text(table)
    more = shell.json(*command, "--seeds", "1:5", "--csv", "r.csv")
    assert [row["attempts"] for row in more["rows"]] == [4, 4]
    assert len(Path("r.csv").read_text().splitlines()) == 1 + 2 * 5
    other = shell.json(*command, "--seeds", "0:1", "--csv", "r.csv", "--margin", 0.01)
    assert other["rows"][0]["attempts"] == 1
    assert len(Path("r.csv").read_text().splitlines()) == 1 + 2 * 6


def test_failures_of_seeds_have_a_reason(shell: Shell) -> None:
    data = shell.json("plan", "swap", "--n", 3, "--margin", 5, "--seeds", "0:2", "--csv", "r.csv")
    (row,) = data["rows"]
    assert (row["planner"], row["success"][0], row["seconds"]) == ("prioritized", 0.0, [None] * 3)
    assert "closer than the margin of 5 m" in Path("r.csv").read_text()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("--seeds 5", "--seeds: got '5', expected FIRST:END, such as 0:20"),
        ("--seeds 5:5", "--seeds: got '5:5', expected FIRST:END"),
        ("--seeds 0:2 --out p.npz", "--out: has no effect with --seeds"),
        ("--seeds 0:2 --seed 3", "--seed: has no effect with --seeds"),
        ("--csv r.csv", "--csv: expected with --seeds"),
        ("--planner PRM --planner RRT", "--planner: got several, expected one, or --seeds"),
        ("--seeds 0:2 --csv other.csv", "--csv: other.csv has other columns, expected setting,"),
    ],
)
def test_wrong_use_of_seeds(shell: Shell, arguments: str, message: str) -> None:
    Path("other.csv").write_text("a,b\n1,2\n")
    assert message in shell.refuses("plan", "swap", *arguments.split())

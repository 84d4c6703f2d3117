"""`fgenv bench files`: measures, verdicts and explanations; the command on a few files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh as tm
from support.shell import Shell

from fgenv.bench.files import mjcf, robots
from fgenv.bench.files.explanations import AGREES, READS, REFUSES, UNIT
from fgenv.bench.files.load_times import torus
from fgenv.bench.files.meshes import compare_file, files_with, verdict_of
from fgenv.bench.files.readers import PEERS, Measures
from fgenv.collision.mesh_files import READERS
from fgenv.robots import Robot


def box(*size: float) -> Measures:
    mesh = tm.creation.box(size)
    return Measures.of((np.asarray(mesh.vertices), np.asarray(mesh.faces)))


def test_measures_of_a_box() -> None:
    measures = box(3.0, 1.0, 2.0)
    assert measures.extents == (1.0, 2.0, 3.0)
    assert [measures.area, measures.volume] == pytest.approx([22.0, 6.0])
    half = measures.scaled(0.5)
    assert [half.area, half.volume] == pytest.approx([5.5, 0.75])


def test_vertices_without_faces_do_not_count() -> None:
    mesh = tm.creation.box()
    more = np.vstack([mesh.vertices, [[9.0, 9.0, 9.0]]])
    assert Measures.of((more, np.asarray(mesh.faces))) == box(1.0, 1.0, 1.0)


def test_each_measure_is_compared() -> None:
    one = box(1.0, 1.0, 1.0)
    assert one.difference(one) == ""
    assert one.difference(box(1.0, 1.0, 1.001)) == "extents"
    assert one.difference(Measures(12, 6.1, 1.0, one.extents)) == "area"
    assert one.difference(Measures(12, 6.0, 0.9, one.extents)) == "volume"


def test_verdicts() -> None:
    one = box(1.0, 1.0, 1.0)
    assert verdict_of(one, one, 1.0) == AGREES
    assert verdict_of(one, one.scaled(1000.0), 0.001) == UNIT
    assert verdict_of(one, one.scaled(1000.0), 1.0) == "extents"
    assert verdict_of(one, "ValueError: no", 1.0) == f"{REFUSES}: ValueError: no"
    assert verdict_of("no faces", one, 1.0) == READS


def test_a_difference_without_a_reason_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "box.stl"
    tm.creation.box().export(file)
    assert compare_file("box.stl", file)["unexplained"] == []
    wrong = tm.creation.box((1.0, 1.0, 2.0))
    monkeypatch.setitem(
        PEERS, "meshio", lambda path: (np.asarray(wrong.vertices), np.asarray(wrong.faces))
    )
    assert compare_file("box.stl", file)["unexplained"] == ["meshio"]


def test_files_are_listed_once_by_content() -> None:
    labels = [label for label, _ in files_with(READERS)]
    assert len(labels) == len(set(labels)) > 2000


def test_the_torus_is_closed() -> None:
    mesh = torus(2000)
    closed = tm.Trimesh(mesh.vertices, mesh.faces)
    assert closed.is_watertight
    assert closed.volume > 0
    assert abs(len(mesh.faces) - 2000) < 100


@pytest.mark.slow
def test_the_command_has_no_unexplained_row(shell: Shell) -> None:
    data = shell.json("bench", "files", "--quick")
    assert sum(row["files"] for row in data["meshes"]) > 90
    assert all(row["unexplained"] == [] for row in data["meshes"])
    (loading,) = data["loading"]
    assert loading["ratio"] > 0


ARM = """<robot name="arm"><link name="a"/><link name="b"/>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/><origin xyz="{x} 0 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


def test_a_robot_that_differs_from_pinocchio_is_unexplained(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(ARM.format(x=0.5))
    monkeypatch.setattr(robots, "files_with", lambda suffixes: [("arm", file)])
    (row,) = robots.bench_robots(False, print)
    assert (row["result"], row["files"], row["unexplained"]) == (robots.AGREES, 1, [])
    assert row["difference"] < 1e-15
    own = Robot.load(file)
    file.write_text(ARM.format(x=0.6))
    monkeypatch.setattr(Robot, "load", lambda path, **options: own)
    (row,) = robots.bench_robots(False, print)
    assert (row["result"], row["unexplained"]) == ("poses differ", ["arm"])


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("<robot name='r'/>", "no link"),
        ("robot", "no XML"),
        (
            ARM.format(x="none"),
            "a wrong number of numbers",
        ),
    ],
)
def test_reasons_of_refusals_are_counted(
    content: str, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(content)
    monkeypatch.setattr(robots, "files_with", lambda suffixes: [("arm", file)])
    (row,) = robots.bench_robots(False, print)
    assert (row["result"], row["unexplained"]) == (robots.REFUSED + reason, [])


@pytest.mark.slow
def test_every_urdf_file_agrees_or_is_refused_for_a_known_reason() -> None:
    rows = list(robots.bench_robots(False, print))
    assert [row for row in rows if row["unexplained"]] == []
    assert max(rows, key=lambda row: row["files"])["result"] == robots.AGREES


BODY = """<mujoco><worldbody><body name="a"><joint name="j" pos="{x} 0 0"/><geom size="1"/></body>
  </worldbody></mujoco>"""


def test_an_mjcf_file_that_differs_from_mujoco_is_unexplained(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "arm.xml"
    file.write_text(BODY.format(x=0.5))
    monkeypatch.setattr(mjcf, "files_with", lambda suffixes: [("arm", file)])
    (row,) = mjcf.bench_mjcf(False, print)
    assert (row["result"], row["files"], row["unexplained"]) == (robots.AGREES, 1, [])
    own = Robot.load(file)
    file.write_text(BODY.format(x=0.6))
    monkeypatch.setattr(Robot, "load", lambda path: own)
    (row,) = mjcf.bench_mjcf(False, print)
    assert (row["result"], row["unexplained"]) == ("poses differ", ["arm"])


@pytest.mark.slow
def test_every_mjcf_file_agrees_or_is_refused_for_a_known_reason() -> None:
    rows = list(mjcf.bench_mjcf(False, print))
    assert [row for row in rows if row["unexplained"]] == []
    assert max(rows, key=lambda row: row["files"])["result"] == robots.AGREES

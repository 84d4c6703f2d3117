"""``fgenv export``: files of each kind and format, and errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from support.robots import urdf
from support.shell import Shell

from fgenv.collision import Shape
from fgenv.robots import Robot
from fgenv.scenarios import Scenario


@pytest.mark.parametrize("to", ["glb", "obj", "stl"])
def test_a_mesh_with_its_unit(shell: Shell, to: str) -> None:
    trimesh.creation.box((100.0, 200.0, 300.0)).export("box.obj")
    data = shell.json("export", "box.obj", "--to", to, "--scale", 0.001, "--out", f"out.{to}")
    assert data == {"source": "box.obj", "kind": "mesh", "written": [f"out.{to}"]}
    assert Shape.load(f"out.{to}").report.extents == pytest.approx((0.1, 0.2, 0.3), rel=1e-7)


@pytest.mark.filterwarnings("ignore")
def test_a_robot_and_its_shapes_at_a_configuration(shell: Shell) -> None:
    file = urdf("z1_description/urdf/z1.urdf")
    data = shell.json("export", file, "--to", "urdf", "--out", "copy.urdf")
    assert data["written"][:2] == ["copy.urdf", "copy.srdf"]
    robot = Robot.load("copy.urdf", srdf="copy.srdf")
    assert np.allclose(robot.forward(robot.rest), Robot.load(file).forward(robot.rest))
    heights = []
    for second in (0.0, 1.0):
        q = np.zeros(robot.nq)
        q[1] = second
        text = ",".join(map(str, q.tolist()))
        shell.json("export", file, "--to", "stl", "--q", text, "--out", "at.stl")
        heights.append(Shape.load("at.stl").report.extents[2])
    assert heights[0] != heights[1]


def test_a_scenario(shell: Shell) -> None:
    for to in ("yaml", "glb", "obj", "stl"):
        assert shell.json("export", "doorway", "--n", 2, "--to", to)["written"] == [f"doorway.{to}"]
    assert Scenario.load("doorway.yaml") == Scenario.load("doorway", n=2).at(Path())
    starts = Path("doorway.obj").read_text()
    shell("export", "doorway.yaml", "--to", "obj", "--goals", "--out", "goals.obj")
    goals = Path("goals.obj").read_text()
    assert starts != goals
    assert starts.count("\no ") == goals.count("\no ")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("none.stl --to obj", "none.stl does not exist, expected a mesh file"),
        ("swop --to obj", "'swop' is no built-in scenario; did you mean 'swap'?"),
        ("box.obj --to urdf", "--to: got 'urdf' for a mesh, expected one of glb, obj, stl"),
        ("swap --to urdf", "--to: got 'urdf' for a scenario, expected one of yaml, glb, obj, stl"),
        ("swap --to dae", "--to: got 'dae'; expected one of: glb, obj, stl, urdf, yaml"),
        ("swap --to obj --scale 2", "--scale: has no effect on a scenario"),
        ("box.obj --to stl --goals", "--goals: has no effect on a mesh"),
        ("swap --to yaml --goals", "--goals: has no effect with --to yaml"),
        ("box.obj --to stl --out box.glb", "--out: got box.glb, expected a name that ends in .stl"),
        ("box.obj --to stl --out none/a.stl", "--out: none/a.stl: there is no folder none"),
    ],
)
def test_errors_are_one_line(shell: Shell, arguments: str, message: str) -> None:
    trimesh.creation.box().export("box.obj")
    assert message in shell.refuses("export", *arguments.split())
    assert [p.name for p in Path().iterdir()] == ["box.obj"]


def test_robots_of_other_formats_are_exported(shell: Shell) -> None:
    Path("arm.xml").write_text(
        '<mujoco model="arm"><worldbody><body name="base"><geom size="0.1"/><body name="tip">'
        '<joint name="turn" range="-90 90"/><geom type="box" size="1 1 1"/></body></body>'
        "</worldbody></mujoco>"
    )
    shell.json("export", "arm.xml", "--to", "urdf", "--out", "copy.urdf")
    robot, copy = Robot.load("arm.xml"), Robot.load("copy.urdf", srdf="copy.srdf")
    assert copy.coordinates == ("turn",)
    np.testing.assert_allclose(copy.upper, robot.upper)

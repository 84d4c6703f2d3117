"""``fgenv robot``: the report as text and as JSON, the picture, options, and errors."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image
from support.robots import urdf
from support.shell import Shell

URDF = """<robot name="arm">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="upper"><visual><geometry><sphere radius="0.1"/></geometry></visual></link>
  <link name="tip"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/>
    <limit lower="-1" upper="2" effort="1" velocity="3"/></joint>
  <joint name="slide" type="prismatic"><parent link="upper"/><child link="tip"/>
    <origin xyz="{x} 0 0"/><axis xyz="1 0 0"/><limit upper="0.5" effort="1" velocity="0"/></joint>
  <joint name="tool" type="fixed"><parent link="tip"/><child link="flange"/></joint>
  <link name="flange"/><foreign:sensor/>
</robot>"""
SRDF = """<robot name="arm">
  <group name="all"><joint name="turn"/><joint name="slide"/></group>
  <group_state name="out" group="all"><joint name="slide" value="0.4"/></group_state>
</robot>"""


@pytest.fixture
def arm() -> Path:
    Path("arm.srdf").write_text(SRDF)
    Path("arm.urdf").write_text(URDF.format(x=0.1))
    return Path("arm.urdf")


def test_the_report_has_joints_groups_states_and_notes(shell: Shell, arm: Path) -> None:
    code, out, err = shell("robot", arm, "--srdf", "arm.srdf")
    assert (code, err) == (0, "")
    assert out.splitlines() == [
        "arm: fixed base, 2 degrees of freedom",
        "4 links, 2 shapes, 24 faces",
        "  turn: revolute, -1 to 2",
        "  slide: prismatic, 0 to 0.5",
        "group all: turn, slide",
        "state out of group all",
        "note: Elements and attributes of other programs are left out: sensor.",
    ]
    data = shell.json("robot", arm, "--srdf", "arm.srdf")
    assert [joint["limits"] for joint in data["joints"]] == [[-1, 2], [0, 0.5], None]
    assert [joint["velocity"] for joint in data["joints"]] == [3, None, None]
    assert data["states"] == [{"group": "all", "name": "out", "slide": 0.4}]


def test_collisions_are_those_of_the_configuration(shell: Shell) -> None:
    Path("arm.srdf").write_text(SRDF)
    text = URDF.format(x=0.1).replace('<link name="upper">', '<link name="upper"/><link name="u">')
    text = text.replace('<child link="upper"/>', '<child link="upper"/>').replace(
        "</robot>",
        '<joint name="w" type="continuous"><parent link="tip"/><child link="u"/></joint></robot>',
    )
    Path("arm.urdf").write_text(text.replace("visual>", "collision>"))
    near = shell.json("robot", "arm.urdf")["self_collisions"]
    far = shell.json("robot", "arm.urdf", "--q", "0,0.4,0")["self_collisions"]
    named = shell.json("robot", "arm.urdf", "--srdf", "arm.srdf", "--q", "out")["self_collisions"]
    assert (near, far, named) == ([["base", "u"]], [], [])


def test_options_change_what_is_read(shell: Shell, arm: Path) -> None:
    visual = shell.json("robot", arm, "--visual", "--scale", 2)
    assert [link["shapes"] for link in visual["links"]] == [0, 1, 0, 0]
    assert visual["joints"][1]["limits"] == [0, 1]
    Path("parts").mkdir()
    Path("arm.xacro").write_text(
        '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:arg name="root" default="a"/><xacro:property name="at" value="$(find parts)"/>'
        '<link name="$(arg root)"/></robot>'
    )
    links = shell.json("robot", "arm.xacro", "--package", "parts=parts", "--arg", "root=b")["links"]
    assert [link["name"] for link in links] == ["b"]


def test_one_of_several_robots_of_a_file_is_chosen(shell: Shell) -> None:
    arm = '<body name="{0}"><joint name="{0}"/><geom size="0.1"/></body>'
    text = f"<mujoco><worldbody>{arm.format('left')}{arm.format('right')}</worldbody></mujoco>"
    Path("two.xml").write_text(text)
    assert "root" in shell.refuses("robot", "two.xml")
    joints = shell.json("robot", "two.xml", "--root", "right")["joints"]
    assert [joint["name"] for joint in joints] == ["right"]


def test_the_picture_shows_a_real_robot(shell: Shell) -> None:
    file = urdf("panda_description/urdf/panda.urdf")
    data = shell.json("robot", file, "--picture", "panda.png", "--q", "0,-1,0,-2,0,2,1,0.04")
    assert data["written"] == ["panda.png"]
    with Image.open("panda.png") as picture:
        assert picture.size == (640, 480)
        assert len(picture.convert("RGB").getcolors(1 << 20) or ()) > 10


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("none.urdf", "none.urdf does not exist"),
        ("arm.srdf", "got no <link>"),
        ("arm.urdf --q 1", "--q: got 1 numbers, expected 2: turn, slide"),
        ("arm.urdf --q out", "--q: got 'out', expected numbers"),
        ("arm.urdf --arg a=1", "xacro_args: got"),
        ("arm.xacro --arg a", "--arg: got 'a', expected NAME=VALUE"),
        ("arm.xacro --arg a=1 --arg a=2", "--arg: got 'a' twice"),
        ("arm.urdf --package none", "--package: got 'none', expected a folder"),
        ("arm.urdf --package . --package a=.", "folders with and without names"),
        ("arm.urdf --picture arm.jpg", "--picture: got arm.jpg, expected a name that ends in .png"),
    ],
)
def test_errors_are_one_line(shell: Shell, arm: Path, arguments: str, message: str) -> None:
    assert message in shell.refuses("robot", *arguments.split())


def test_a_picture_needs_shapes(shell: Shell) -> None:
    Path("bare.urdf").write_text('<robot name="bare"><link name="a"/></robot>')
    assert "got a robot without shapes" in shell.refuses("robot", "bare.urdf", "--picture", "a.png")

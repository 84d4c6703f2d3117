"""`Robot.load`: one robot in each format, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fgenv.robots import Robot

URDF = """<robot name="arm">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="tip"><collision><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.1 0.1"/></geometry>
  </collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="tip"/>
    <origin xyz="0 0 0.3"/><axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="1" velocity="0"/>
  </joint>
</robot>"""
MJCF = """<mujoco model="arm"><compiler angle="radian"/><worldbody>
  <body name="base"><geom type="box" size="0.1 0.1 0.1"/>
    <body name="tip" pos="0 0 0.3"><joint name="turn" axis="0 1 0" range="-1 2"/>
      <geom type="box" size="0.3 0.05 0.05" pos="0.3 0 0"/></body>
  </body></worldbody></mujoco>"""
SDF = """<sdf version="1.9"><model name="arm"><static>false</static>
  <joint name="hold" type="fixed"><parent>world</parent><child>base</child></joint>
  <link name="base"><collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
  </collision></link>
  <link name="tip"><pose>0 0 0.3 0 0 0</pose><collision name="c"><pose>0.3 0 0 0 0 0</pose>
    <geometry><box><size>0.6 0.1 0.1</size></box></geometry></collision></link>
  <joint name="turn" type="revolute"><parent>base</parent><child>tip</child>
    <axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>2</upper></limit></axis></joint>
</model></sdf>"""
FILES = {"arm.urdf": URDF, "arm.xml": MJCF, "arm.sdf": SDF, "arm.xacro": URDF, "arm.robot": URDF}


@pytest.mark.parametrize("name", FILES)
def test_each_format_gives_the_same_robot(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text(FILES[name])
    robot = Robot.load(path)
    assert (robot.name, robot.base, robot.coordinates) == ("arm", "fixed", ("turn",))
    np.testing.assert_allclose([robot.lower[0], robot.upper[0]], [-1, 2], rtol=1e-15)
    reference = tmp_path / "reference.urdf"
    reference.write_text(URDF)
    expected = Robot.load(reference)
    for q in ([-0.5], [1.2]):
        at, there = robot.forward(q), expected.forward(q)
        for link in ("base", "tip"):
            own, other = robot.link_index(link), expected.link_index(link)
            np.testing.assert_allclose(at[own], there[other], atol=1e-12)
    corners = [
        np.unique(np.round(part.origin[:3, :3] @ v + part.origin[:3, 3], 9))
        for part in robot.parts
        for v in [part.shape.vertices.max(axis=0)]
    ]
    assert len(corners) == 2


@pytest.mark.parametrize(
    ("name", "options", "label"),
    [
        ("arm.xml", {"package_dirs": ["."]}, "package_dirs"),
        ("arm.xml", {"soft_limits": True}, "soft_limits"),
        ("arm.xml", {"xacro_args": {"a": "1"}}, "xacro_args"),
        ("arm.sdf", {"soft_limits": True}, "soft_limits"),
        ("arm.sdf", {"root": "base"}, "root"),
        ("arm.urdf", {"root": "base"}, "root"),
        ("arm.urdf", {"xacro_args": {"a": "1"}}, "xacro_args"),
    ],
)
def test_options_that_a_format_does_not_have_are_refused(
    name: str, options: dict[str, Any], label: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_text(FILES[name])
    with pytest.raises(ValueError, match=f"^{label}: got"):
        Robot.load(tmp_path / name, **options)


@pytest.mark.parametrize("suffix", [".usd", ".usda", ".USDC", ".usdz"])
def test_usd_is_refused_with_a_remedy(suffix: str, tmp_path: Path) -> None:
    (tmp_path / f"arm{suffix}").write_text("#usda 1.0")
    with pytest.raises(ValueError, match="is USD, which is not read; export it as URDF or MJCF"):
        Robot.load(tmp_path / f"arm{suffix}")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<scene/>", "got <scene>, expected a robot as URDF, xacro, MJCF or SDF"),
        ("", "is empty, expected a robot"),
        ("no xml", "arm.xml"),
    ],
)
def test_other_files_are_refused(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(text)
    with pytest.raises(ValueError, match=message):
        Robot.load(tmp_path / "arm.xml")


def test_limits_of_mimic_joints_hold_in_each_format(tmp_path: Path) -> None:
    """In MJCF an equality constraint couples two joints."""
    path = tmp_path / "hand.xml"
    finger = '<body name="{0}" pos="{1} 0 0"><joint name="{0}" axis="0 1 0" range="{2}"/>'
    path.write_text(
        '<mujoco><compiler angle="radian"/><worldbody><body name="palm"><geom size="0.01"/>'
        + finger.format("left", 0.1, "0 1") + '<geom size="0.01"/></body>'
        + finger.format("right", -0.1, "0 0.4") + '<geom size="0.01"/></body>'
        + '</body></worldbody><equality><joint joint1="right" joint2="left" polycoef="0 0.5"/>'
        + "</equality></mujoco>"
    )  # fmt: skip
    hand = Robot.load(path)
    assert hand.coordinates == ("left",)
    np.testing.assert_allclose(hand.upper, [0.8])


def test_a_mount_replaces_that_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(MJCF.replace('name="base"', 'name="base" pos="1 2 3"'))
    np.testing.assert_array_equal(Robot.load(path).mount[:3, 3], [1, 2, 3])
    np.testing.assert_array_equal(Robot.load(path, mount=np.eye(4)).mount, np.eye(4))


@pytest.mark.parametrize("name", ["arm.urdf", "arm.sdf"])
def test_a_robot_with_the_other_geometry_alone_is_reported(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(FILES[name].replace("collision", "visual"))
    with pytest.warns(UserWarning, match=r"nothing collides; give collision=False") as caught:
        Robot.load(tmp_path / name)
    assert caught[0].filename == __file__

"""Robots from xacro files: macros, arguments, packages, and bounds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import fgenv.robots.xacro_files as xacro_files
from fgenv.robots import Robot

ARM = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="height" default="0.4"/>
  <xacro:arg name="links" default="3"/>
  <xacro:property name="length" value="$(arg height)"/>
  <xacro:include filename="$(find parts_description)/macros.xacro"/>
  <link name="link0"/>
  <xacro:chain k="1" n="$(arg links)"/>
</robot>
"""
MACROS = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="chain" params="k n">
    <link name="link${k}">
      <collision><geometry><box size="0.1 0.1 ${length}"/></geometry></collision>
    </link>
    <joint name="joint${k}" type="revolute">
      <parent link="link${k - 1}"/><child link="link${k}"/>
      <origin xyz="0 0 ${length}"/><axis xyz="0 1 0"/>
      <limit lower="${-pi / 2}" upper="${pi / 2}" effort="1" velocity="1"/>
    </joint>
    <xacro:if value="${k &lt; n}"><xacro:chain k="${k + 1}" n="${n}"/></xacro:if>
  </xacro:macro>
</robot>
"""


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """A file whose macros are in a package; the package's folder has another name."""
    package = tmp_path / "parts-main"
    package.mkdir()
    (package / "package.xml").write_text("<package><name>parts_description</name></package>")
    (package / "macros.xacro").write_text(MACROS)
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(ARM)
    return path


def test_macros_includes_and_arguments_are_expanded(arm: Path) -> None:
    robot = Robot.load(arm)
    assert (robot.name, robot.nq) == ("arm", 3)
    np.testing.assert_allclose(robot.upper, np.pi / 2, rtol=1e-15)
    np.testing.assert_allclose(robot.forward(np.zeros(3), "link3")[:3, 3], [0, 0, 1.2])
    longer = Robot.load(arm, xacro_args={"height": "1.5", "links": "5"})
    np.testing.assert_allclose(longer.forward(np.zeros(5), "link5")[:3, 3], [0, 0, 7.5])


def test_packages_are_those_of_meshes(arm: Path, tmp_path: Path) -> None:
    hidden = tmp_path / "deep" / "down" / "parts"
    hidden.parent.mkdir(parents=True)
    (tmp_path / "parts-main").rename(hidden)
    with pytest.raises(ValueError, match=r"no package 'parts_description' .* package_dirs"):
        Robot.load(arm)
    for packages in ([hidden.parent], {"parts_description": hidden}):
        assert Robot.load(arm, package_dirs=packages).nq == 3


def test_arguments_that_a_file_does_not_have_are_refused(arm: Path) -> None:
    with pytest.raises(ValueError, match="no argument 'lenght'; remove it from xacro_args"):
        Robot.load(arm, xacro_args={"lenght": "2"})
    plain = arm.with_name("plain.urdf")
    plain.write_text('<robot name="r"><link name="a"/></robot>')
    with pytest.raises(ValueError, match=r"xacro_args: got some for .*plain.urdf"):
        Robot.load(plain, xacro_args={"height": "1"})


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("$(arg height)", "${0.2 * missing}", "missing"),
        ("$(arg height)", "${().__class__}", "invalid name"),
        ("xacro:chain k", "xacro:chian k", "chian"),
        ("</robot>", "", "no element found"),
        ("$(arg height)", "${len('x' * 10**11)}", "MemoryError when evaluating"),
        (
            "$(arg height)",
            "none",
            r"line 1: origin: xyz: got '0 0 none'.*lines of the expanded file",
        ),
        ('<link name="link0"/>', "<xacro:chain k='1' n='9'/>", "link1': got two of this name"),
    ],
)
def test_faults_are_named(old: str, new: str, message: str, arm: Path) -> None:
    arm.write_text(ARM.replace(old, new))
    with pytest.raises(ValueError, match=message) as error:
        Robot.load(arm)
    assert "arm.urdf.xacro" in str(error.value)


def test_a_file_that_does_not_end_is_stopped(arm: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xacro_files, "MAX_SECONDS", 2)
    arm.write_text(ARM.replace("$(arg height)", "${9**9**9}"))
    with pytest.raises(ValueError, match=r"not expanded in 2 s"):
        Robot.load(arm)


def test_a_macro_without_end_is_refused(arm: Path) -> None:
    arm.write_text(ARM.replace('n="$(arg links)"', 'n="100000"'))
    with pytest.raises(ValueError, match=r"arm.urdf.xacro: .*recursion|arm.urdf.xacro"):
        Robot.load(arm)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"none.xacro is no file"):
        Robot.load(tmp_path / "none.xacro")

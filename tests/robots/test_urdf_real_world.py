"""What real URDF files have beside the format's plain core: each is read, noted or refused."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from fgenv.robots import Robot
from fgenv.robots.urdf import rotation, rotation_of_quaternion

BOX = '<collision><geometry><box size="1 1 1"/></geometry></collision>'


def robot(tmp_path: Path, body: str, head: str = '<robot name="r">', **options: object) -> Robot:
    file = tmp_path / "r.urdf"
    file.write_text(f"{head}{body}</robot>", encoding="utf-8")
    return Robot.load(file, **options)  # type: ignore[arg-type]


def joint(limit: str, kind: str = "revolute", extra: str = "") -> str:
    return (
        f'<link name="a">{BOX}</link><link name="b"/><joint name="j" type="{kind}">'
        f'<parent link="a"/><child link="b"/>{limit}{extra}</joint>'
    )


def test_a_version_of_xml_that_does_not_exist_is_noted(tmp_path: Path) -> None:
    """24 files of PyBullet's data declare version 0.0."""
    made = robot(
        tmp_path, f'<link name="a">{BOX}</link>', '<?xml version="0.0" ?>\n<robot name="r">'
    )
    assert made.notes == ("The XML declares version 0.0; it is read as version 1.0.",)


def test_a_default_namespace_is_noted(tmp_path: Path) -> None:
    made = robot(tmp_path, f'<link name="a">{BOX}</link>', '<robot name="r" xmlns="http://x.org">')
    assert made.notes == ("The default namespace http://x.org is ignored.",)
    assert len(made.parts) == 1


def test_elements_of_other_programs_are_noted(tmp_path: Path) -> None:
    body = f'<link name="a" drake:x="1">{BOX}</link><drake:joint name="q"/>'
    made = robot(tmp_path, body)
    assert made.notes == ("Elements and attributes of other programs are left out: x, joint.",)


@pytest.mark.parametrize("declared", ["", ' xmlns:xacro="http://www.ros.org/wiki/xacro"'])
def test_xacro_is_refused_with_its_line(tmp_path: Path, declared: str) -> None:
    """A robot of one link was read of a file whose macros make the others."""
    with pytest.raises(ValueError, match=r"line 2: got <xacro:bar>, expected URDF; name it"):
        robot(tmp_path, f'<link name="a">{BOX}</link>\n<xacro:bar/>', f'<robot name="r"{declared}>')


@pytest.mark.parametrize("collision", [True, False])
def test_faults_in_geometry_that_is_not_used_do_not_matter(tmp_path: Path, collision: bool) -> None:
    used, other = ("collision", "visual") if collision else ("visual", "collision")
    bad = f'<{other}><geometry><mesh filename="none.stl" scale="1 1"/></geometry></{other}>'
    good = BOX.replace("collision", used)
    made = robot(tmp_path, f'<link name="a">{bad}{good}</link>', collision=collision)
    assert len(made.parts) == 1
    with pytest.raises(ValueError, match=r"mesh scale: got '1 1', expected 3 or 1 numbers"):
        robot(tmp_path, f'<link name="a">{bad}{good}</link>', collision=not collision)


@pytest.mark.parametrize(
    ("limit", "expected"),
    [
        ('<limit upper="0.5"/>', (0.0, 0.5)),
        ('<limit lower="-0.5"/>', (-0.5, 0.0)),
        ('<limit lower="-1e16" upper="1e16"/>', (-math.inf, math.inf)),
        ('<limit lower="-2" upper="1e16"/>', (-2.0, math.inf)),
        ('<limit effort="1" velocity="1"/>', (-math.inf, math.inf)),
    ],
)
def test_limits(tmp_path: Path, limit: str, expected: tuple[float, float]) -> None:
    """A missing limit is 0; limits of 1e16 gave random values that `forward` refused."""
    made = robot(tmp_path, joint(limit, "prismatic"))
    assert (made.joints[0].lower, made.joints[0].upper) == expected
    assert bool(made.notes) == any(map(math.isinf, expected))


@pytest.mark.parametrize(("soft", "expected"), [(False, (-1.0, 2.0)), (True, (-0.5, 1.5))])
def test_soft_limits_by_a_switch(tmp_path: Path, soft: bool, expected: tuple[float, float]) -> None:
    controller = '<safety_controller soft_lower_limit="-0.5" soft_upper_limit="1.5"/>'
    body = joint('<limit lower="-1" upper="2"/>', extra=controller)
    made = robot(tmp_path, body, soft_limits=soft)
    assert (made.joints[0].lower, made.joints[0].upper) == expected


@given(st.tuples(*[st.floats(-3.0, 3.0)] * 3))
def test_rotations_by_quaternions_agree_with_angles(rpy: tuple[float, float, float]) -> None:
    r, p, y = (angle / 2 for angle in rpy)
    (cr, cp, cy), (sr, sp, sy) = map(np.cos, (r, p, y)), map(np.sin, (r, p, y))
    quaternion = (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
    turned = rotation_of_quaternion(*map(float, quaternion))
    assert np.allclose(turned, rotation(rpy)[:3, :3], rtol=0, atol=1e-14)


def test_a_quaternion_of_urdf_1_1(tmp_path: Path) -> None:
    """A half turn was lost."""
    made = robot(tmp_path, joint("", "fixed", '<origin xyz="1 0 0" quat_xyzw="0 0 1 0"/>'))
    assert np.allclose(made.joints[0].origin[:3, :3], np.diag([-1.0, -1.0, 1.0]))
    for origin, message in (
        ('quat_xyzw="0 0 2 0"', "quat_xyzw: got length 2, expected 1"),
        ('quat_xyzw="0 0 1"', "quat_xyzw: got '0 0 1', expected four numbers"),
        ('quat_xyzw="0 0 1 0" rpy="0 0 0"', "got rpy and quat_xyzw, expected one of them"),
    ):
        with pytest.raises(ValueError, match=message):
            robot(tmp_path, joint("", "fixed", f"<origin {origin}/>"))


@pytest.mark.parametrize(
    ("geometry", "message"),
    [
        ('<box size="1 2"/>', "box size: got '1 2', expected 3 numbers"),
        ("<sphere/>", "sphere radius: got None, expected 1 numbers"),
        ('<cylinder radius="1"/>', "cylinder length: got None, expected 1 numbers"),
        ('<sphere radius="nan"/>', "sphere radius: got 'nan', expected 1 numbers"),
    ],
)
def test_wrong_sizes_name_line_link_and_attribute(
    tmp_path: Path, geometry: str, message: str
) -> None:
    body = f'\n<link name="a"><collision><geometry>{geometry}</geometry></collision></link>'
    with pytest.raises(ValueError, match=rf"r\.urdf: line 2: link 'a': {message}"):
        robot(tmp_path, body)


def package(folder: Path, name: str, mesh: str = "box.stl") -> None:
    (folder / "meshes").mkdir(parents=True)
    trimesh.creation.box().export(folder / "meshes" / mesh)
    (folder / "package.xml").write_text(f"<package><name>{name}</name></package>")


def with_mesh(uri: str) -> str:
    geometry = f'<geometry><mesh filename="{uri}"/></geometry>'
    return f'<link name="a"><collision>{geometry}</collision></link>'


@pytest.mark.parametrize("scheme", ["package", "model"])
def test_a_package_is_known_by_its_package_xml(tmp_path: Path, scheme: str) -> None:
    """An archive of a host unpacks to NAME-main, which no name of a folder matched."""
    package(tmp_path / "x" / "arm_description-main", "arm_description")
    body = with_mesh(f"{scheme}://arm_description/meshes/box.stl")
    folders = tmp_path / "x", tmp_path / "x" / "arm_description-main"
    for given_folder in folders:
        assert len(robot(tmp_path, body, package_dirs=given_folder).parts) == 1
    named = {"arm_description": folders[1]}
    assert len(robot(tmp_path, body, package_dirs=named).parts) == 1
    with pytest.raises(FileNotFoundError, match=r"give package_dirs=.*'arm_description'"):
        robot(tmp_path, body)


def test_packages_in_environments(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package(tmp_path / "ros" / "arm", "arm")
    package(tmp_path / "ament" / "share" / "hand", "hand")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros"))
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "ament"))
    (tmp_path / "urdf").mkdir()
    for name in ("arm", "hand"):
        assert robot(tmp_path / "urdf", with_mesh(f"package://{name}/meshes/box.stl")).parts


def test_encoded_names_and_file_uris(tmp_path: Path) -> None:
    package(tmp_path / "my pack", "my pack", "a box.stl")
    mesh = tmp_path / "my pack" / "meshes" / "a box.stl"
    for uri in (
        "package://my%20pack/meshes/a%20box.stl",
        "my pack/meshes/a%20box.stl",
        f"file://{mesh}",
    ):
        assert len(robot(tmp_path, with_mesh(uri)).parts) == 1


def test_space_before_the_xml_declaration_is_noted(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(
        '\n<?xml version="1.0"?><robot name="r"><link name="a"/></robot>'
    )
    assert "does not begin" in Robot.load(tmp_path / "r.urdf").notes[0]


GRIPPER = """
  <link name="a"/><link name="b"/><link name="c"/>
  <joint name="left" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.8" velocity="1" effort="1"/></joint>
  <joint name="right" type="revolute"><parent link="a"/><child link="c"/><axis xyz="0 0 1"/>
    <limit lower="{low}" upper="{high}" velocity="1" effort="1"/>
    <mimic joint="left" multiplier="-2" offset="0.1"/></joint>
"""


def test_limits_of_a_mimic_joint_hold(tmp_path: Path) -> None:
    """`valid` accepted 0.8, which turns the other finger beyond its limit."""
    gripper = robot(tmp_path, GRIPPER.format(low=-0.9, high=0.05))
    np.testing.assert_allclose([gripper.lower[0], gripper.upper[0]], [0.025, 0.5])
    assert gripper.notes == ()
    assert [gripper.valid([q]) for q in (0.02, 0.03, 0.49, 0.51)] == [False, True, True, False]
    assert gripper.valid(gripper.random(np.random.default_rng(0), 100)).all()


def test_limits_of_a_mimic_joint_that_leave_no_room_are_left_out(tmp_path: Path) -> None:
    """Files of grippers give the finger that turns the other way the limits of the first."""
    gripper = robot(tmp_path, GRIPPER.format(low=0.5, high=0.8))
    np.testing.assert_array_equal([gripper.lower[0], gripper.upper[0]], [0, 0.8])
    assert gripper.notes == (
        "The limits of joint 'right' contradict those of 'left', which it mimics; they are left"
        " out.",
    )


def test_errors_of_the_tree_name_the_file(tmp_path: Path) -> None:
    links = '<link name="a"/><link name="a"/>'
    with pytest.raises(ValueError, match=r"r\.urdf: link 'a': got two of this name"):
        robot(tmp_path, links)


@pytest.mark.parametrize("uri", ["a\n\tb.stl", "file:///no\x1b[31m.stl", "package://p\u202e/a.stl"])
def test_names_of_files_in_messages_have_no_control_characters(tmp_path: Path, uri: str) -> None:
    """A fuzzer's SDF had a line break in the name of a mesh, and the message had three lines."""
    text = "".join(f"&#{ord(c)};" if not c.isprintable() and c != "\x1b" else c for c in uri)
    geometry = f'<geometry><mesh filename="{text}"/></geometry>'
    with pytest.raises((ValueError, FileNotFoundError)) as error:
        robot(tmp_path, f'<link name="a"><collision>{geometry}</collision></link>')
    assert str(error.value).isprintable()

"""SRDF: allowed collisions, groups, named states; what is left out is noted."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import numpy as np
import pytest

from fgenv.robots import Robot

LINKS = ("base", "upper", "fore", "hand", "finger")
URDF = (
    '<robot name="arm">'
    + "".join(
        f'<link name="{name}"><collision><geometry><box size="1 1 1"/></geometry></collision>'
        "</link>"
        for name in LINKS
    )
    + "".join(
        f'<joint name="{name}" type="revolute"><parent link="{a}"/><child link="{b}"/>'
        '<origin xyz="3 0 0"/><axis xyz="0 0 1"/><limit lower="-2" upper="2"/></joint>'
        for name, (a, b) in zip(("j1", "j2", "j3", "j4"), itertools.pairwise(LINKS), strict=True)
    )
    + "</robot>"
)
ADJACENT = set(itertools.pairwise(LINKS))


def robot_with(folder: Path, srdf: str, name: str = "arm") -> Robot:
    """The arm with the elements of an SRDF."""
    (folder / "arm.urdf").write_text(URDF)
    (folder / "arm.srdf").write_text(f'<robot name="{name}">\n{srdf}\n</robot>')
    return Robot.load(folder / "arm.urdf", srdf=folder / "arm.srdf")


def allowed(robot: Robot) -> set[frozenset[str]]:
    return set(map(frozenset, robot.allowed))


def pairs(*names: str) -> set[frozenset[str]]:
    """Pairs `a-b`, and the adjacent links."""
    return {frozenset(name.split("-")) for name in names} | set(map(frozenset, ADJACENT))


def test_pairs_are_disabled_and_enabled_in_the_order_of_moveit(tmp_path: Path) -> None:
    """Defaults first, then enabled pairs, then disabled ones, in whichever order they stand."""
    text = """
      <disable_collisions link1="hand" link2="base" reason="Never"/>
      <enable_collisions link1="finger" link2="upper"/>
      <enable_collisions link1="finger" link2="base"/>
      <disable_collisions link1="finger" link2="base"/>
      <disable_default_collisions link="finger"/>
    """
    robot = robot_with(tmp_path, text)
    assert allowed(robot) == pairs("hand-base", "finger-base", "finger-fore", "finger-hand")
    assert any("'finger'" in note and "other bodies" in note for note in robot.notes)


def test_groups_list_joints_links_chains_and_groups(tmp_path: Path) -> None:
    text = """
      <virtual_joint name="world" type="fixed" parent_frame="map" child_link="base"/>
      <group name="arm"><chain base_link="base" tip_link="fore"/></group>
      <group name="gripper"><link name="finger"/><passive_joint name="j4"/></group>
      <group name="all"><joint name="j3"/><group name="gripper"/><joint name="world"/>
        <group name="arm"/></group>
      <end_effector name="hand" parent_link="hand" group="gripper" parent_group="arm"/>
    """
    semantics = robot_with(tmp_path, text).semantics
    assert semantics.groups == {
        "arm": ("j1", "j2"),
        "gripper": ("j4",),
        "all": ("world", "j1", "j2", "j3", "j4"),
    }
    effector = semantics.end_effectors["hand"]
    assert (effector.parent_link, effector.group, effector.parent_group) == (
        "hand",
        "gripper",
        "arm",
    )
    assert semantics.virtual_joints["world"].child_link == "base"


@pytest.mark.parametrize(
    ("inside", "fault"),
    [
        ('<joint name="j9"/>', "joint 'j9'"),
        ('<link name="thumb"/>', "link 'thumb'"),
        ('<chain base_link="hand" tip_link="base"/>', "chain from 'hand' to 'base'"),
        ('<group name="none"/>', "'none' does not exist"),
        ('<group name="broken"/>', "'broken' contains itself"),
        ('<links name="base"/>', "got <links>"),
    ],
)
def test_a_group_of_another_robot_is_left_out_with_its_reason(
    inside: str, fault: str, tmp_path: Path
) -> None:
    text = f"""<group name="broken">{inside}</group><group name="good"><joint name="j1"/></group>
      <group_state name="home" group="broken"><joint name="j1" value="1"/></group_state>"""
    robot = robot_with(tmp_path, text)
    assert list(robot.semantics.groups) == ["good"]
    assert fault in robot.semantics.faulty_groups["broken"]
    assert any(fault in note for note in robot.notes)
    assert any("'home'" in note for note in robot.notes)


def test_named_states_are_configurations(tmp_path: Path) -> None:
    text = """
      <group name="arm"><joint name="j1"/><joint name="j2"/></group>
      <group name="wrist"><joint name="j3"/></group>
      <group_state name="home" group="arm">
        <joint name="j1" value="0.5"/><joint name="j2" value="-1"/><joint name="j3" value="1"/>
      </group_state>
      <group_state name="home" group="wrist"><joint name="j3" value="1.5"/></group_state>
      <group_state name="bent" group="wrist"><joint name="j3" value="2"/></group_state>
    """
    robot = robot_with(tmp_path, text)
    np.testing.assert_array_equal(robot.named_state("home", "arm"), [0.5, -1, 0, 0])
    np.testing.assert_array_equal(robot.named_state("bent"), [0, 0, 2, 0])
    with pytest.raises(ValueError, match=r"state: got 'home', expected one of 'arm': .*'wrist'"):
        robot.named_state("home")
    with pytest.raises(ValueError, match="state: got 'up' of 'arm'"):
        robot.named_state("up", "arm")
    assert any("no value in the group: j3" in note for note in robot.notes)


@pytest.mark.parametrize(
    ("text", "note"),
    [
        ('<disable_collisions link1="base" link2="thumb"/>', "'thumb' of the SRDF"),
        ('<group name="g"><passive_joint name="j1"/></group>', "Passive joints.*j1"),
        ('<link_sphere_approximation link="base"/>', "<link_sphere_approximation> has no effect"),
        ('<disable_colisions link1="base" link2="hand"/>', "<disable_colisions> is no element"),
        (
            '<virtual_joint name="w" type="floating" parent_frame="map" child_link="base"/>',
            "'w' is floating, the base is fixed",
        ),
    ],
)
def test_what_has_no_effect_is_noted(text: str, note: str, tmp_path: Path) -> None:
    notes = robot_with(tmp_path, text).notes
    assert any(re.search(note, sentence) for sentence in notes), notes


def test_the_file_of_another_robot_is_noted(tmp_path: Path) -> None:
    assert robot_with(tmp_path, "", "leg").notes == ("The SRDF is of robot 'leg', not 'arm'.",)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('<disable_collisions link1="base"/>', "line 2: <disable_collisions>: got no link2"),
        ('<group_state group="g"/>', "line 2: <group_state>: got no name"),
        (
            '<group name="g"><joint name="j1"/></group><group_state name="s" group="g">'
            '<joint name="j1" value="x"/>'
            "</group_state>",
            "line 2: joint 'j1': value: got 'x', expected a number",
        ),
        ("<group", "expected XML"),
    ],
)
def test_errors_name_file_line_and_element(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=message) as error:
        robot_with(tmp_path, text)
    assert "arm.srdf" in str(error.value)


def test_entities_are_refused(tmp_path: Path) -> None:
    robot_with(tmp_path, "")
    path = tmp_path / "arm.srdf"
    path.write_text('<!DOCTYPE r [<!ENTITY a "x">]><robot name="&a;"/>')
    with pytest.raises(ValueError, match=r"arm\.srdf: got a document type"):
        Robot.load(tmp_path / "arm.urdf", srdf=path)

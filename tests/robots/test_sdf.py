"""Robots from SDF: kinematics against pinocchio on the same robot as URDF, frames, and errors."""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio
import pytest
import trimesh

from fgenv.robots import Robot
from fgenv.robots.mesh_location import PackagePaths
from fgenv.robots.robot_file import RobotFile
from fgenv.robots.sdf import read_sdf

pytestmark = pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")


def read(path: Path, **options: Any) -> RobotFile:
    defaults = {"collision": True, "scale": 1.0, "error": 1e-3, "shape_options": {}}
    return read_sdf(path, PackagePaths(), **{**defaults, **options})


def robot_of(file: RobotFile) -> Robot:
    tree = tuple(file.links), tuple(file.joints), file.base, file.mount
    return Robot(file.name, *tree, allowed=tuple(file.allowed), notes=tuple(file.notes))


def written(folder: Path, model: str, version: str = "1.9", head: str = "name='m'") -> Path:
    path = folder / "model.sdf"
    path.write_text(f"<sdf version='{version}'><model {head}>{model}</model></sdf>")
    return path


def loaded(folder: Path, model: str, **options: Any) -> Robot:
    return robot_of(read(written(folder, model), **options))


BALL = "<collision name='c'><geometry><sphere><radius>.1</radius></sphere></geometry></collision>"


def link(name: str, pose: str = "", inside: str = BALL) -> str:
    return f"<link name='{name}'><pose>{pose}</pose>{inside}</link>"


def joint(
    name: str, kind: str, parent: str, child: str, axis: str = "0 0 1", more: str = ""
) -> str:
    ends = f"<parent>{parent}</parent><child>{child}</child>"
    text = "" if kind == "fixed" else f"<axis><xyz>{axis}</xyz>{more}</axis>"
    return f"<joint name='{name}' type='{kind}'>{ends}{text}</joint>"


# Generated robots, as SDF with random frames and as URDF, compared with pinocchio


def turn(rpy: Any) -> Any:
    return pinocchio.rpy.rpyToMatrix(*rpy)


def pose(xyz: Any, rpy: Any) -> Any:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn(rpy), xyz
    return matrix


class Generated:
    """A random robot.

    Attributes:
        sdf, urdf: texts. Links of the URDF have the joints' frames.
        offsets: pose of each link of the SDF in that of the URDF.
    """

    def __init__(self, seed: int) -> None:
        self.rng = random.Random(seed)
        self.count = self.rng.randint(2, 7)
        self.at = {"__model__": np.eye(4)}  # frames in the model
        self.offsets: dict[str, Any] = {}
        held = self.rng.random() < 0.5
        self.model_pose = self.random_pose()
        urdf, body = ["<link name='l0'/>"], []
        self.at["l0"] = self.offsets["l0"] = self.random_pose()
        body.append(f"<link name='l0'>{self.written('l0')}</link>")
        if held:
            body.append(joint("hold", "fixed", "world", "l0"))
        frames = {"l0": np.eye(4)}  # of links of the URDF in the model
        for i in range(1, self.count):
            parent = f"l{self.rng.randrange(i)}"
            self.add(f"l{i}", parent, frames, urdf, body)
        self.held = held
        self.rng.shuffle(body)
        text = self.pose_text(self.model_pose) + "".join(body)
        self.sdf = f"<sdf version='1.9'><model name='m' canonical_link='l0'>{text}</model></sdf>"
        self.urdf = f"<robot name='m'>{''.join(urdf)}</robot>"

    def add(
        self, name: str, parent: str, frames: dict[str, Any], urdf: list[str], body: list[str]
    ) -> None:
        """Add a link and its joint."""
        rng, label = self.rng, f"j{name[1:]}"
        xyz, rpy = self.vector(), self.vector(math.pi)
        frames[name] = frames[parent] @ pose(xyz, rpy)
        axis = self.vector()
        kind = rng.choice(["revolute", "continuous", "prismatic", "fixed"])
        urdf.append(f"<link name='{name}'/><joint name='{label}' type='{kind}'>")
        urdf.append(f"<parent link='{parent}'/><child link='{name}'/>")
        urdf.append(f"<origin xyz='{text_of(xyz)}' rpy='{text_of(rpy)}'/>")
        urdf.append(f"<axis xyz='{text_of(axis / np.linalg.norm(axis))}'/>")
        urdf.append("<limit lower='-1' upper='2' velocity='3' effort='1'/></joint>")
        self.offsets[name] = self.random_pose() if rng.random() < 0.5 else np.eye(4)
        self.at[name] = frames[name] @ self.offsets[name]
        at_joint = pose(frames[name][:3, 3], self.vector(math.pi))  # any rotation is valid
        if like_urdf := rng.random() < 0.3:  # the joint in the parent, the link in the joint
            self.at[label] = at_joint
            body.append(f"<link name='{name}'>{self.written(name, base=label)}</link>")
        else:
            body.append(f"<link name='{name}'>{self.written(name)}</link>")
        frame, ends = f"f{name[1:]}", (parent, name)
        if rng.random() < 0.5:  # a frame on the child, which the joint names
            self.at[frame] = self.random_pose()
            inside = self.written(frame, default=name)
            body.append(f"<frame name='{frame}' attached_to='{name}'>{inside}</frame>")
            ends = parent, frame
        self.at[label] = at_joint
        base = parent if like_urdf else None
        at_text = self.written(label, default=ends[1], base=base)
        expressed = rng.choice(["", "__model__", parent, name])
        xyz_in = self.at[expressed or label][:3, :3].T @ frames[name][:3, :3] @ axis
        body.append(
            f"<joint name='{label}' type='{kind}'><parent>{ends[0]}</parent>"
            f"<child>{ends[1]}</child>{at_text}<axis>"
            f"<xyz expressed_in='{expressed}'>{text_of(xyz_in)}</xyz><limit><lower>-1</lower>"
            "<upper>2</upper><velocity>3</velocity></limit></axis></joint>"
        )

    def vector(self, size: float = 1.0) -> Any:
        return np.array([self.rng.uniform(-size, size) for _ in range(3)])

    def random_pose(self) -> Any:
        return pose(self.vector(), self.vector(math.pi))

    def written(self, name: str, default: str = "__model__", base: str | None = None) -> str:
        """The pose of a frame, relative to a base or to a random frame that is already there."""
        if base is None:
            base = self.rng.choice(["", *(k for k in self.at if k not in (name, default))])
        relative = np.linalg.inv(self.at[base or default]) @ self.at[name]
        return self.pose_text(relative, f"relative_to='{base}'")

    def pose_text(self, matrix: Any, attributes: str = "") -> str:
        xyz, style = text_of(matrix[:3, 3]), self.rng.choice(["rpy", "degrees", "quaternion"])
        if style == "quaternion":
            turned = text_of(pinocchio.Quaternion(matrix[:3, :3]).coeffs())
            return f"<pose {attributes} rotation_format='quat_xyzw'>{xyz} {turned}</pose>"
        rpy = pinocchio.rpy.matrixToRpy(matrix[:3, :3])
        if style == "degrees":
            return f"<pose {attributes} degrees='true'>{xyz} {text_of(np.degrees(rpy))}</pose>"
        return f"<pose {attributes}>{xyz} {text_of(rpy)}</pose>"


def text_of(values: Any) -> str:
    return " ".join(repr(float(value)) for value in values)


@pytest.mark.parametrize("seed", range(40))
def test_poses_of_generated_models_are_those_of_pinocchio(tmp_path: Path, seed: int) -> None:
    robot_texts = Generated(seed)
    path = tmp_path / "model.sdf"
    path.write_text(robot_texts.sdf)
    robot = robot_of(read(path))
    model = pinocchio.buildModelFromXML(robot_texts.urdf)
    data, rng = model.createData(), np.random.default_rng(seed)
    assert robot.base == ("fixed" if robot_texts.held else "free")
    start = robot_texts.model_pose  # of the URDF's first link, in the world
    for _ in range(3):
        values = {name: rng.uniform(-1, 2) for name in robot.coordinates if name[0] == "j"}
        q = np.array([values.get(name, 0.0) for name in robot.coordinates])
        if robot.base == "free":
            q[:3], q[6] = rng.uniform(-1, 1, 3), 1.0
            start = pose(q[:3], (0, 0, 0)) @ np.linalg.inv(robot_texts.offsets["l0"])
        pinocchio.framesForwardKinematics(model, data, pinocchio_q(model, values))
        for name, offset in robot_texts.offsets.items():
            at = data.oMf[model.getFrameId(name)].homogeneous
            np.testing.assert_allclose(robot.forward(q, name), start @ at @ offset, atol=1e-9)


def pinocchio_q(model: Any, values: dict[str, float]) -> Any:
    q = pinocchio.neutral(model)
    for name, value in values.items():
        joint = model.joints[model.getJointId(name)]
        both = [math.cos(value), math.sin(value)]
        q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else both
    return q


# Kinematics


QUARTER = f"0 0 0 {math.pi / 2} 0 0"
TWO = link("a") + link("b", "0 0 1 0 0 0")


def test_all_elements_of_a_model(tmp_path: Path) -> None:
    limits = "<limit><lower>-1</lower><upper>2</upper><velocity>3</velocity></limit>"
    model = f"<pose>1 2 3 0 0 0</pose>{TWO}{joint('w', 'fixed', 'world', 'a')}"
    robot = loaded(tmp_path, model + joint("j", "revolute", "a", "b", "0 1 0", limits))
    assert (robot.name, robot.base, robot.root) == ("m", "fixed", "a")
    assert robot.coordinates == ("j",)
    assert (robot.lower[0], robot.upper[0], robot.velocity[0]) == (-1, 2, 3)
    np.testing.assert_array_equal(robot.mount[:3, 3], [1, 2, 3])
    np.testing.assert_allclose(robot.forward([0.5], "b")[:3, 3], [1, 2, 4])
    assert [len(link.shapes) for link in robot.links] == [1, 1]


@pytest.mark.parametrize(
    ("version", "more", "axis"),
    [
        ("1.4", "", [0, 1, 0]),
        ("1.6", "<use_parent_model_frame>1</use_parent_model_frame>", [0, 1, 0]),
        ("1.6", "<use_parent_model_frame>false</use_parent_model_frame>", [0, 0, 1]),
        ("1.5", "", [0, 0, 1]),
        ("1.11", "", [0, 0, 1]),
    ],
)
def test_frame_of_an_axis_by_version(
    tmp_path: Path, version: str, more: str, axis: list[float]
) -> None:
    """An axis was in the model's frame up to 1.4; it is in the joint's frame since."""
    model = link("a") + link("b", QUARTER) + joint("j", "prismatic", "a", "b", "0 1 0", more)
    robot = robot_of(read(written(tmp_path, model, version)))
    moved = robot.forward([0, 0, 0, 0, 0, 0, 1, 1.0], "b")
    np.testing.assert_allclose(moved[:3, 3], axis, atol=1e-12)


def test_an_axis_expressed_in_another_frame(tmp_path: Path) -> None:
    axis = "<axis><xyz expressed_in='f'>0 1 0</xyz></axis>"
    ends = "<parent>a</parent><child>b</child>"
    frame = f"<frame name='f' attached_to='b'><pose relative_to='a'>{QUARTER}</pose></frame>"
    text = f"{TWO}{frame}<joint name='j' type='prismatic'>{ends}{axis}</joint>"
    robot = loaded(tmp_path, text)
    moved = robot.forward([0, 0, 0, 0, 0, 0, 1, 2.0], "b")
    np.testing.assert_allclose(moved[:3, 3], [0, 0, 3], atol=1e-12)


def test_a_universal_joint_is_two_revolute_joints(tmp_path: Path) -> None:
    second = "<axis2><xyz>0 1 0</xyz></axis2>"
    text = joint("u", "universal", "a", "b", "1 0 0").replace("</joint>", f"{second}</joint>")
    robot = loaded(tmp_path, TWO + text)
    assert robot.coordinates[7:] == ("u", "u@axis2")
    at = robot.forward([0, 0, 0, 0, 0, 0, 1, 0.3, 0.4], "b")
    expected = turn([0.3, 0, 0]) @ turn([0, 0.4, 0])
    np.testing.assert_allclose(at[:3, :3], expected, atol=1e-12)


def test_a_mimic_follows_from_its_reference(tmp_path: Path) -> None:
    numbers = "<multiplier>2</multiplier><offset>.3</offset><reference>.1</reference>"
    mimic = f"<mimic joint='j'>{numbers}</mimic>"
    limits = "<limit><lower>0</lower><upper>1</upper></limit>"
    model = TWO + link("c") + joint("j", "revolute", "a", "b", more=limits)
    robot = loaded(tmp_path, model + joint("k", "prismatic", "b", "c", more=mimic))
    assert robot.coordinates[7:] == ("j",)
    source, multiplier, offset = robot.mimic_sources["k"]
    assert (source.name, multiplier) == ("j", 2)
    assert offset == pytest.approx(0.1)  # 2 (q - 0.1) + 0.3


def test_a_free_base_has_the_place_of_the_file(tmp_path: Path) -> None:
    file = read(written(tmp_path, "<pose>1 2 3 0 0 0</pose>" + link("a", "0 0 1 0 0 0")))
    assert file.base == "free"
    np.testing.assert_array_equal(file.mount, np.eye(4))
    np.testing.assert_array_equal(file.placement[:3, 3], [1, 2, 4])


def test_a_static_model_does_not_move(tmp_path: Path) -> None:
    model = "<static>true</static><pose>0 0 5 0 0 0</pose>" + TWO
    robot = loaded(tmp_path, model + joint("j", "revolute", "a", "b"))
    assert (robot.base, robot.nq) == ("fixed", 0)
    assert robot.forward([], "b")[2, 3] == 6
    assert any("static" in note for note in robot.notes)


def test_links_of_a_static_model_need_no_joints(tmp_path: Path) -> None:
    robot = loaded(tmp_path, f"<static>1</static>{TWO}")
    assert (robot.base, robot.nq, robot.root) == ("fixed", 0, "world")
    assert robot.forward([], "b")[2, 3] == 1


def test_a_moving_joint_to_the_world_has_a_link_for_the_world(tmp_path: Path) -> None:
    model = f"<pose>0 0 5 0 0 0</pose>{TWO}{joint('j', 'revolute', 'a', 'b')}"
    robot = loaded(tmp_path, model + joint("w", "prismatic", "world", "a", "1 0 0"))
    assert (robot.base, robot.root, robot.coordinates) == ("fixed", "world", ("j", "w"))
    np.testing.assert_allclose(robot.forward([0, 2.0], "b")[:3, 3], [2, 0, 6])


def test_the_placement_frame_has_the_pose_of_the_model(tmp_path: Path) -> None:
    model = f"<pose>1 2 3 0 0 0</pose>{TWO}{joint('j', 'fixed', 'a', 'b')}"
    path = written(tmp_path, model + joint("w", "fixed", "world", "a"), "1.9")
    path.write_text(path.read_text().replace("name='m'", "name='m' placement_frame='b'", 1))
    robot = robot_of(read(path))
    np.testing.assert_array_equal(robot.forward([], "b")[:3, 3], [1, 2, 3])


@pytest.mark.parametrize("bound", ["1e16", "inf", "1e300"])
def test_huge_limits_are_none(tmp_path: Path, bound: str) -> None:
    limits = f"<limit><lower>-{bound}</lower><upper>{bound}</upper></limit>"
    robot = loaded(tmp_path, TWO + joint("j", "revolute", "a", "b", more=limits))
    assert robot.joints[0].kind == "continuous"


def test_scale_multiplies_all_lengths(tmp_path: Path) -> None:
    limits = "<limit><lower>0</lower><upper>1</upper><velocity>2</velocity></limit>"
    model = TWO + joint("j", "prismatic", "a", "b", more=limits)
    robot = loaded(tmp_path, model, scale=10.0)
    assert robot.forward(robot.rest, "b")[2, 3] == 10
    assert (robot.upper[7], robot.velocity[-1]) == (10, 20)
    (placed,) = robot.links[0].shapes
    assert np.abs(placed.shape.vertices).max() == pytest.approx(1, abs=2e-3)


def test_one_model_in_a_world_is_read(tmp_path: Path) -> None:
    path = written(tmp_path, TWO + joint("j", "fixed", "a", "b"))
    text = path.read_text().replace("<model", "<world name='w'><physics/><model")
    path.write_text(text.replace("</model>", "</model></world>"))
    assert any("world" in note for note in read(path).notes)


# Geometry


@pytest.mark.parametrize(
    ("form", "volume"),
    [
        ("<box><size>.1 .2 .3</size></box>", 0.006),
        ("<sphere><radius>.1</radius></sphere>", 4 / 3 * math.pi * 1e-3),
        ("<cylinder><radius>.1</radius><length>.4</length></cylinder>", math.pi * 4e-3),
        (
            "<capsule><radius>.1</radius><length>.4</length></capsule>",
            math.pi * (4e-3 + 4e-3 / 3),
        ),
        ("<ellipsoid><radii>.1 .2 .3</radii></ellipsoid>", 4 / 3 * math.pi * 6e-3),
    ],
)
def test_solids_enclose_the_exact_ones_closely(tmp_path: Path, form: str, volume: float) -> None:
    item = f"<collision name='c'><geometry>{form}</geometry></collision>"
    (placed,) = loaded(tmp_path, link("a", "", item)).links[0].shapes
    mesh = trimesh.Trimesh(placed.shape.vertices, placed.shape.faces, process=False)
    assert placed.excess <= 1e-3
    most = volume + placed.excess * mesh.area
    assert volume * (1 - 1e-12) <= mesh.volume <= most * (1 + 1e-12)


def test_a_mesh_is_scaled_mirrored_and_placed(tmp_path: Path) -> None:
    folder = tmp_path / "models/part"
    folder.mkdir(parents=True)
    trimesh.creation.box((1, 2, 3)).export(folder / "box part.stl")
    place = "<pose relative_to='f'>0 0 2 0 0 0</pose>"
    mesh = "<mesh><uri>model://part/box%20part.stl</uri><scale>-1 2 1</scale></mesh>"
    item = f"<collision name='c'>{place}<geometry>{mesh}</geometry></collision>"
    frame = f"<frame name='f' attached_to='a'><pose>1 0 0 {math.pi / 2} 0 0</pose></frame>"
    path = written(tmp_path, link("a", "5 5 5 0 0 0", item) + frame)
    file = read_sdf(
        path,
        PackagePaths((tmp_path / "models",)),
        collision=True,
        scale=1.0,
        error=1e-3,
        shape_options={},
    )
    (placed,) = file.links[0].shapes
    np.testing.assert_allclose(placed.origin[:3, 3], [1, -2, 0], atol=1e-12)
    solid = trimesh.Trimesh(placed.shape.vertices, placed.shape.faces, process=False)
    np.testing.assert_allclose(solid.volume, 12)
    np.testing.assert_allclose(solid.extents, [1, 4, 3])


def test_only_the_chosen_kind_of_geometry_matters(tmp_path: Path) -> None:
    visual = "<visual name='v'><geometry><mesh><uri>no.stl</uri></mesh></geometry></visual>"
    path = written(tmp_path, link("a", "", BALL + visual))
    assert len(read(path).links[0].shapes) == 1
    with pytest.raises(FileNotFoundError, match=r"link 'a': mesh 'no\.stl'"):
        read(path, collision=False)
    assert read(path).other_geometry
    assert not read(written(tmp_path, link("a", "", BALL))).other_geometry


def test_bits_of_contacts_allow_collisions(tmp_path: Path) -> None:
    def ball(bits: str) -> str:
        contact = f"<contact><collide_bitmask>{bits}</collide_bitmask></contact>"
        return BALL.replace("</collision>", f"<surface>{contact}</surface></collision>")

    model = link("a", "", ball("0x01")) + link("b", "", ball("2")) + link("c", "", ball("3"))
    model += link("d", "", ball("0")) + joint("i", "fixed", "a", "b")
    model += joint("j", "revolute", "b", "c") + joint("k", "revolute", "c", "d")
    file = read(written(tmp_path, model))
    assert file.allowed == [("a", "b")]
    assert [len(link.shapes) for link in file.links] == [1, 1, 1, 0]


# Errors


@pytest.mark.parametrize(
    ("model", "match"),
    [
        ("", "got 0 links"),
        (TWO, "links 'a', 'b': got no joint to a parent"),
        (TWO.replace("</link>", "<colision/></link>", 1), "<colision>.*did you mean <collision>"),
        (TWO + joint("j", "ball", "a", "b"), "type: got 'ball'.*three revolute joints"),
        (TWO + joint("j", "screw", "a", "b"), "type: got 'screw'"),
        (TWO + joint("j", "revolute", "a", "no"), "got the frame 'no'"),
        (TWO + joint("j", "revolute", "a", "x::b"), "nested models are not read"),
        (TWO + joint("j", "revolute", "a", "b", "0 0 0"), "xyz: got 0 0 0"),
        (TWO + joint("j", "revolute", "a", "b", "0 0"), "got '0 0', expected 3 numbers"),
        (TWO + joint("j", "revolute", "a", "b", "nan 0 0"), "expected 3 numbers"),
        (TWO + joint("j", "revolute", "a", "b") + joint("j", "fixed", "a", "b"), "two of this"),
        (TWO + joint("j", "revolute", "a", "b") + joint("k", "fixed", "a", "b"), "two parent"),
        (TWO + joint("j", "revolute", "a", "b") + joint("k", "fixed", "b", "a"), "got a loop"),
        (
            TWO + joint("j", "revolute", "a", "b", more="<mimic joint='b'/>"),
            "joint: got 'b', expected a joint",
        ),
        (
            TWO
            + joint(
                "j",
                "revolute",
                "a",
                "b",
                more="<limit><lower>2</lower><upper>1</upper></limit>",
            ),
            "got lower 2 over upper 1",
        ),
        (link("a", "1 2 3"), "got '1 2 3', expected 6 numbers"),
        (link("a", "0 0 0 0 0 x"), "expected 6 numbers"),
        ("<link name='a'><pose relative_to='a'/></link>", "got a loop of poses"),
        ("<link name='a'><pose frame='b'/></link>", "got frame=, expected relative_to="),
        ("<link name='a'><pose rotation_format='quat_xyzw'>0 0 0 0 0 0 0</pose></link>", "length"),
        ("<link name='a'><pose degrees='maybe'/></link>", "expected true or false"),
        (
            "<frame name='f' attached_to='g'/><frame name='g' attached_to='f'/>"
            + TWO
            + joint("j", "fixed", "f", "b"),
            "got a loop of frames",
        ),
        ("<include><uri>model://arm</uri></include>" + TWO, "<include>.*paste the model"),
        ("<model name='n'/>" + TWO, "<model 'n'>.*move its links"),
        (link("a", "", BALL.replace("sphere", "plane")), "got <plane>, expected one of box"),
        (link("a", "", BALL.replace(".1", "-1")), "link 'a': line 1: sphere: radius: got -1"),
        (link("a", "", "<collision name='c'/>"), "geometry of <link 'a'>: got nothing"),
        ("<link/>", "got no name"),
    ],
)
def test_invalid_models_give_one_error_with_the_file(
    tmp_path: Path, model: str, match: str
) -> None:
    path = written(tmp_path, model)
    with pytest.raises(ValueError, match=match) as error:
        read(path)
    assert str(path) in str(error.value)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "is empty"),
        ("<sdf", "malformed XML"),
        ("<robot name='r'/>", "got <robot>, expected an SDF file"),
        ("<sdf/>", "version: got ''"),
        ("<sdf version='1.9'/>", "got 0 models"),
        ("<sdf version='1.9'><model name='a'/><model name='b'/></sdf>", "got 2 models"),
        ("<sdf version='1.9'><world><include/></world></sdf>", "1 includes"),
        ("<!DOCTYPE m [<!ENTITY e 'x'>]><sdf version='1.9'>&e;</sdf>", "document type"),
    ],
)
def test_invalid_documents_give_one_error(tmp_path: Path, text: str, match: str) -> None:
    path = tmp_path / "model.sdf"
    path.write_text(text)
    with pytest.raises(ValueError, match=match) as error:
        read(path)
    assert str(path) in str(error.value)
    with pytest.raises(FileNotFoundError):
        read(tmp_path)


def test_elements_of_other_programs_are_left_out_with_a_note(tmp_path: Path) -> None:
    path = written(tmp_path, link("a", "", f"<x:y/>{BALL}") + "<plugin name='p'/>")
    path.write_text(path.read_text().replace("<sdf ", "<sdf xmlns:x='urn:x' "))
    file = read(path)
    assert any("other programs" in note and " y" in note for note in file.notes)
    assert any("plugin" in note for note in file.notes)
    assert any("self_collide" in note for note in file.notes)


def test_damaged_files_are_read_or_refused(tmp_path: Path) -> None:
    words = ["", "-1", "1e308", "0", "l1", "<pose>", "/>", "world", "__model__", "'", "inf", "nan"]
    path = tmp_path / "model.sdf"
    refused = 0
    for seed in range(300):
        rng = random.Random(seed)
        text = Generated(seed % 8).sdf
        for _ in range(rng.randint(1, 3)):
            i = rng.randrange(len(text))
            text = text[:i] + rng.choice(words) + text[i + rng.randint(0, 8) :]
        path.write_text(text)
        try:
            robot_of(read(path))
        except ValueError as error:
            refused += "model.sdf" in str(error)
    assert refused > 100

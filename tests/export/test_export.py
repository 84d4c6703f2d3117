"""Round trips: a file that is written and read back is equal within the precision of its format."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from support.mesh_files import MeshCase, mesh_cases
from support.robots import BOX, URDFS, real

from fgenv.collision import Shape
from fgenv.collision.mesh_files.content import MeshSource
from fgenv.collision.mesh_files.obj import read_obj
from fgenv.export import (
    PlacedMesh,
    mesh_parts,
    robot_parts,
    scenario_parts,
    write_meshes,
    write_urdf,
)
from fgenv.export.meshes import obj
from fgenv.export.urdf import roll_pitch_yaw
from fgenv.robots import Joint, Link, LinkShape, Mimic, Robot
from fgenv.robots.urdf import rotation
from fgenv.scenarios import Scenario

SINGLE = 2.0**-24  # relative rounding of single precision


def sorted_faces(shape: Shape) -> np.ndarray:
    """Corners of the triangles (n, 9), in an order that does not depend on the file's."""
    corners = shape.vertices[shape.faces]
    first = np.lexsort(np.moveaxis(corners, 2, 0)[::-1])[:, 0]
    turned = np.stack([np.roll(c, -k, axis=0) for c, k in zip(corners, first, strict=True)])
    rows = turned.reshape(-1, 9)
    return np.asarray(rows[np.lexsort(rows.T[::-1])])


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("suffix", [".obj", ".stl", ".glb"])
@pytest.mark.parametrize("case", mesh_cases(), ids=lambda case: case.name)
def test_meshes_of_the_generator(case: MeshCase, suffix: str, tmp_path: Path) -> None:
    file, copy = tmp_path / case.name, tmp_path / f"copy{suffix}"
    file.write_bytes(case.content)
    shape = Shape.load(file)
    write_meshes(mesh_parts(shape), copy)
    again = Shape.load(copy)
    expected = sorted_faces(shape)
    if suffix != ".obj":
        expected = expected.astype(np.float32).astype(np.float64)
    assert np.array_equal(sorted_faces(again), expected)
    assert again.watertight == shape.watertight
    assert again.report.file is not None
    assert again.report.file.notes == ()


@given(st.lists(st.floats(-1e30, 1e30), min_size=9, max_size=9, unique=True))
def test_coordinates_of_obj_are_exact(numbers: list[float]) -> None:
    vertices = np.reshape(numbers, (3, 3))
    text = obj([PlacedMesh("m", vertices, np.array([[0, 1, 2]]), np.eye(4))])
    assert np.array_equal(read_obj(MeshSource(Path("m.obj"), ".obj", text)).vertices, vertices)


@given(st.tuples(*[st.floats(-7.0, 7.0)] * 3))
def test_angles_of_a_rotation(rpy: tuple[float, float, float]) -> None:
    pose = rotation(rpy)
    assert np.allclose(rotation(roll_pitch_yaw(pose)), pose, rtol=0, atol=1e-15)


def arm(**joint: Any) -> Robot:
    box = trimesh.creation.box((0.1, 0.1, 0.5))
    shape = Shape(box.vertices, box.faces, name="bar")
    tilted = rotation((0.3, -0.2, 0.1))
    links = Link("a", LinkShape(shape, tilted)), Link("b b", shape), Link("c", shape)
    values = {"kind": "revolute", "lower": -1.0, "upper": 2.0, **joint}
    first = Joint("j", parent="a", child="b b", origin=tilted, **values)
    follows = Joint("k", "prismatic", "b b", "c", lower=0, upper=1, mimic=Mimic("j", 0.5, 0.1))
    return Robot("arm <&>", links, (first, follows))


def assert_equal_robots(one: Robot, two: Robot) -> None:
    assert two.name == one.name
    assert two.coordinates == one.coordinates
    assert np.array_equal(two.lower, one.lower)
    assert np.array_equal(two.upper, one.upper)
    for a, b in zip(one.joints, two.joints, strict=True):
        assert (b.name, b.mimic) == (a.name, a.mimic)
        assert b.velocity == a.velocity or not a.moves
    assert two.allowed == one.allowed
    for q in one.random(np.random.default_rng(0), 3):
        assert np.allclose(two.forward(q), one.forward(q), rtol=0, atol=1e-12)
    for first, second in zip(one.parts, two.parts, strict=True):
        assert np.allclose(first.origin, second.origin, rtol=0, atol=1e-14)
        assert np.array_equal(sorted_faces(first.shape), sorted_faces(second.shape))


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("path", URDFS)
def test_robots_of_real_urdf_files(path: str, tmp_path: Path) -> None:
    robot = real(path)
    write_urdf(robot, tmp_path / "copy.urdf")
    assert_equal_robots(robot, Robot.load(tmp_path / "copy.urdf", srdf=tmp_path / "copy.srdf"))


def test_a_robot_with_a_mimic_joint_and_markup_in_its_names(tmp_path: Path) -> None:
    robot = arm(velocity=3.0)
    files = write_urdf(robot, tmp_path / "arm.urdf")
    assert sorted(files) == sorted(p for p in tmp_path.rglob("*") if p.is_file())
    assert len(files) == 3  # URDF, SRDF, and the one shape of all links
    assert_equal_robots(robot, Robot.load(tmp_path / "arm.urdf", srdf=tmp_path / "arm.srdf"))


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ({"acceleration": 2.0}, "joint 'j': got a limit of acceleration, expected none"),
        ({"lower": -np.inf}, "joint 'j': got limits -inf and 2, expected finite ones"),
        ({"kind": "prismatic", "lower": -np.inf, "upper": np.inf}, "got limits -inf and inf"),
    ],
)
def test_joints_that_urdf_cannot_hold(joint: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=message):
        write_urdf(arm(**joint), tmp_path / "arm.urdf")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("suffix", [".obj", ".glb"])
def test_a_scenario_keeps_its_bodies_apart(suffix: str, tmp_path: Path) -> None:
    parts = scenario_parts(Scenario.load("warehouse", n=3))
    names = [part.name for part in parts]
    assert len(set(names)) == len(names)
    file = tmp_path / f"scene{suffix}"
    write_meshes(parts, file)
    if suffix == ".glb":
        assert set(names) <= set(trimesh.load_scene(file).graph.nodes)
    else:
        lines = file.read_text().splitlines()
        assert [f"o {name}" for name in names] == [x for x in lines if x.startswith("o ")]
    points = np.concatenate([part.points for part in parts])
    box = [points.min(axis=0), points.max(axis=0)]
    tolerance = 32 * SINGLE if suffix == ".glb" else 0.0
    assert np.allclose(Shape.load(file).bounds, box, rtol=0, atol=tolerance)


@pytest.mark.filterwarnings("ignore")
def test_a_robot_at_a_configuration(tmp_path: Path) -> None:
    robot = arm()
    write_meshes(robot_parts(robot, [1.0]), tmp_path / "arm.stl")
    points = np.concatenate([part.points for part in robot_parts(robot, [1.0])])
    bounds = Shape.load(tmp_path / "arm.stl").bounds
    assert np.allclose(bounds, [points.min(axis=0), points.max(axis=0)], rtol=0, atol=SINGLE)
    with pytest.raises(ValueError, match=r"q: got \(2,\) configurations, expected one, \(1,\)"):
        robot_parts(robot, [[1.0], [2.0]])


def test_bytes_are_the_same_each_time(tmp_path: Path) -> None:
    parts = scenario_parts(Scenario.load("doorway", n=2))
    for suffix in (".stl", ".obj", ".glb"):
        files = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
        for file in files:
            write_meshes(parts, file)
        assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.filterwarnings("ignore")
def test_wrong_targets(tmp_path: Path) -> None:
    parts = robot_parts(arm())
    with pytest.raises(ValueError, match=r"expected a name that ends in one of .stl, .obj, .glb"):
        write_meshes(parts, tmp_path / "a.dae")
    with pytest.raises(ValueError, match=r"expected a name that ends in .urdf"):
        write_urdf(arm(), tmp_path / "a.xml")
    with pytest.raises(ValueError, match="meshes: got none"):
        write_meshes([], tmp_path / "a.stl")
    with pytest.raises(FileNotFoundError):
        write_meshes(parts, tmp_path / "none" / "a.stl")


HOSTILE = (
    *("</link><link name='x'>", "]]>", "&amp;", 'a"b', "a\nb", "a\tb", "../../up", "$(touch x)"),
    *("\u202eb", "é 漢"),
)


@pytest.mark.parametrize("name", HOSTILE)
def test_names_of_links_and_joints_come_back(name: str, tmp_path: Path) -> None:
    """Nothing is written outside the folder, whatever the names."""
    pair = [Link("a", BOX), Link(f"{name}L", BOX)]
    joint = Joint(f"{name}J", "revolute", "a", f"{name}L", lower=-1.0, upper=1.0)
    inside = tmp_path / "inside"
    inside.mkdir()
    write_urdf(Robot(name, pair, [joint]), inside / "r.urdf")
    back = Robot.load(inside / "r.urdf", srdf=inside / "r.srdf")
    assert (back.name, back.links[1].name, back.joints[0].name) == (name, f"{name}L", f"{name}J")
    assert [path for path in tmp_path.iterdir() if path != inside] == []


@pytest.mark.parametrize("character", ["\0", "\x1b", "\x07", "\ufffe"])
def test_names_that_xml_cannot_hold_are_refused(character: str, tmp_path: Path) -> None:
    """A file was written that no reader accepts."""
    robot = Robot("r", [Link(f"a{character}", BOX)])
    with pytest.raises(ValueError, match=r"link: got the name .*, expected no control characters"):
        write_urdf(robot, tmp_path / "r.urdf")
    assert list(tmp_path.iterdir()) == []

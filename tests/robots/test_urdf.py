"""Robots from URDF: geometry, packages, allowed collisions, errors of invalid files."""

from __future__ import annotations

import hashlib
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio
import pytest
import trimesh
from support.robots import URDFS, real, urdf

from fgenv.bench.common.meshes import folder
from fgenv.collision import Shape
from fgenv.robots import Robot, primitives
from fgenv.robots.urdf import rotation

pytestmark = pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")

ARM = """<?xml version="1.0"?>
<robot name="arm">
  <link name="base">
    <collision><geometry><box size="0.2 0.3 0.4"/></geometry></collision>
    <visual><geometry><sphere radius="0.1"/></geometry></visual>
  </link>
  <link name="upper">
    <collision>
      <origin xyz="0 0 0.25" rpy="0.1 0.2 0.3"/>
      <geometry><cylinder radius="0.05" length="0.5"/></geometry>
    </collision>
    <collision><geometry><sphere radius="0.06"/></geometry></collision>
  </link>
  <link name="hand">
    <collision><geometry><mesh filename="{mesh}" {scale}/></geometry></collision>
  </link>
  <link name="finger"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/>
    <origin xyz="0.1 -0.2 0.3" rpy="0.4 0.5 0.6"/><axis xyz="0 1 1"/>
    <limit lower="-1.5" upper="2" velocity="3" effort="1"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="upper"/><child link="hand"/><origin xyz="0 0 0.5"/>
    <limit lower="0" upper="0.2" velocity="0" effort="1"/>
  </joint>
  <joint name="grip" type="prismatic">
    <parent link="hand"/><child link="finger"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.15" velocity="1" effort="1"/>
    <mimic joint="slide" multiplier="0.5" offset="0.01"/>
  </joint>
</robot>
"""


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """A file with the text ARM and a mesh in its folder."""
    trimesh.creation.box((0.1, 0.2, 0.3)).apply_translation((1, 0, 0)).export(tmp_path / "hand.stl")
    return written(tmp_path, ARM.format(mesh="hand.stl", scale=""))


def written(folder: Path, text: str, name: str = "arm.urdf") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_all_elements_of_a_file(arm: Path) -> None:
    robot = Robot.load(arm)
    assert robot.coordinates == ("shoulder", "slide")
    assert [link.name for link in robot.links] == ["base", "upper", "hand", "finger"]
    assert [len(link.shapes) for link in robot.links] == [1, 2, 1, 0]
    np.testing.assert_array_equal(robot.lower, [-1.5, 0])
    np.testing.assert_array_equal(robot.upper, [2, 0.2])
    np.testing.assert_array_equal(robot.velocity, [3, np.inf])
    box, tube, ball, hand = (part.shape for part in robot.parts)
    assert volume(box) == pytest.approx(0.2 * 0.3 * 0.4)
    np.testing.assert_allclose(np.ptp(box.vertices, axis=0), [0.2, 0.3, 0.4])
    np.testing.assert_allclose(np.ptp(tube.vertices, axis=0)[2], 0.5)
    np.testing.assert_allclose(np.ptp(ball.vertices, axis=0), 0.12, atol=2e-3)
    np.testing.assert_allclose(hand.vertices.mean(axis=0), [1, 0, 0], atol=1e-6)
    placed = robot.links[1].shapes[0]
    np.testing.assert_allclose(placed.origin[:3, 3], [0, 0, 0.25])
    expected = pinocchio.rpy.rpyToMatrix(0.1, 0.2, 0.3)
    np.testing.assert_allclose(placed.origin[:3, :3], expected, atol=1e-15)
    finger = robot.forward([0.0, 0.1], "finger") @ np.linalg.inv(robot.forward([0.0, 0.1], "hand"))
    assert np.linalg.norm(finger[:3, 3]) == pytest.approx(0.06)
    visual = Robot.load(arm, collision=False)
    assert [len(link.shapes) for link in visual.links] == [1, 0, 0, 0]


def test_a_tolerance_is_that_of_all_shapes(arm: Path) -> None:
    robot = Robot.load(arm, tolerance=0.01)
    assert {part.shape.method for part in robot.parts} == {"tolerance"}


def test_same_bits_on_every_machine(tmp_path: Path) -> None:
    """Sines of origins and joints are not the C library's: poses have their recorded bits."""
    text = ARM.replace('<mesh filename="{mesh}" {scale}/>', '<box size="1 1 1"/>')
    robot = Robot.load(written(tmp_path, text))
    t = np.arange(101)[:, None] / 100
    poses = robot.forward(robot.lower + t * (robot.upper - robot.lower))
    parts = [poses, *(a for part in robot.parts for a in (part.shape.vertices, part.origin))]
    digest = hashlib.sha256(b"".join(np.ascontiguousarray(p).tobytes() for p in parts))
    assert digest.hexdigest()[:16] == "099ffa678160f36c"


def test_scales_mirrors_and_a_factor_of_all_lengths(tmp_path: Path, arm: Path) -> None:
    text = ARM.format(mesh="hand.stl", scale='scale="2 -1 1"')
    mirrored = Robot.load(written(tmp_path, text, "mirrored.urdf")).parts[3].shape
    plain = Robot.load(arm)
    np.testing.assert_allclose(np.ptp(mirrored.vertices, axis=0), [0.2, 0.2, 0.3], rtol=1e-6)
    assert volume(mirrored) == pytest.approx(2 * volume(plain.parts[3].shape))
    assert volume(mirrored) > 0
    twice = Robot.load(arm, scale=2.0)
    q = np.array([0.7, 0.15])
    expected = plain.forward(q)
    expected[:, :3, 3] *= 2
    np.testing.assert_allclose(twice.forward(q * [1, 2]), expected, atol=1e-15)
    np.testing.assert_array_equal(twice.upper, plain.upper * [1, 2])
    for part, other in zip(plain.parts, twice.parts, strict=True):
        extent, double = (np.ptp(p.shape.vertices, axis=0) for p in (part, other))
        np.testing.assert_allclose(double, 2 * extent, atol=4e-3)


def volume(shape: Shape) -> float:
    a, b, c = (shape.vertices[shape.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize("followed", ["shoulder", "slide"])
def test_scale_applies_to_mimics(followed: str, tmp_path: Path) -> None:
    """A prismatic joint that mimics a revolute one, and the reverse."""
    text = ARM.replace('<mesh filename="{mesh}" {scale}/>', '<box size="1 1 1"/>')
    text = text.replace('mimic joint="slide"', f'mimic joint="{followed}"')
    if followed == "slide":
        text = text.replace('name="grip" type="prismatic"', 'name="grip" type="revolute"')
    path = written(tmp_path, text)
    q = np.array([0.7, 0.15])
    expected = Robot.load(path).forward(q)
    expected[:, :3, 3] *= 2
    twice = Robot.load(path, scale=2.0)
    np.testing.assert_allclose(twice.forward(q * [1, 2]), expected, atol=1e-15)


@pytest.mark.parametrize("place", ["beside", "above", "given", "ros", "absolute", "file"])
def test_meshes_are_found(
    place: str, tmp_path: Path, arm: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mesh = tmp_path / "hand.stl"
    package = tmp_path / "robots" / "arm_description"
    elsewhere = tmp_path / "elsewhere" / "arm_description"
    (package / "urdf").mkdir(parents=True)
    options: dict[str, Any] = {}
    name = "package://arm_description/meshes/hand.stl"
    home = {"above": package, "given": elsewhere, "ros": elsewhere}.get(place)
    if home is not None:
        (home / "meshes").mkdir(parents=True)
        mesh.rename(home / "meshes" / "hand.stl")
    if place == "beside":
        mesh.rename(package / "urdf" / "hand.stl")
        name = "hand.stl"
    if place == "given":
        options["package_dirs"] = elsewhere.parent
    if place == "ros":
        monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere:{elsewhere}")
    if place in ("absolute", "file"):
        name = {"absolute": "", "file": "file://"}[place] + str(mesh)
    path = written(package / "urdf", ARM.format(mesh=name, scale=""))
    assert len(Robot.load(path, **options).parts) == 4


def test_unit_of_collada_counts(tmp_path: Path) -> None:
    source = folder("example-robot-data") / "anymal_c_simple_description/meshes/battery.dae"
    text = source.read_text(encoding="utf-8")
    assert 'meter="1"' in text
    robots = []
    for unit in ("1", "0.01"):
        written(tmp_path, text.replace('meter="1"', f'meter="{unit}"'), "hand.dae")
        path = written(tmp_path, ARM.format(mesh="hand.dae", scale=""))
        robots.append(Robot.load(path).parts[3].shape)
    np.testing.assert_allclose(robots[1].vertices, 0.01 * robots[0].vertices)


# STL, DAE, OBJ; millimeters; mirrored; boxes, cylinders, spheres.
GEOMETRY = (URDFS[0], URDFS[2], URDFS[8], URDFS[9], URDFS[13], URDFS[14])


@pytest.mark.parametrize("path", GEOMETRY, ids=lambda path: path.split("/")[-1])
def test_geometry_of_real_robots_is_that_of_pinocchio(path: str) -> None:
    robot = real(path)
    model = pinocchio.buildModelFromUrdf(str(urdf(path)))
    roots = [str(folder("example-robot-data").parents[1])]
    known = pinocchio.buildGeomFromUrdf(
        model, str(urdf(path)), pinocchio.COLLISION, package_dirs=roots
    )
    for link in robot.links:
        frame = model.getFrameId(link.name, pinocchio.FrameType.BODY)
        there = [g for g in known.geometryObjects if g.parentFrame == frame]
        assert len(there) == len(link.shapes)
        for geometry, placed in zip(there, link.shapes, strict=True):
            origin = model.frames[frame].placement.actInv(geometry.placement).homogeneous
            np.testing.assert_allclose(placed.origin, origin, rtol=0, atol=1e-9)
            geometry.geometry.computeLocalAABB()
            box = geometry.geometry.aabb_local
            low, high = placed.shape.vertices.min(axis=0), placed.shape.vertices.max(axis=0)
            within = 1e-6 + placed.excess
            np.testing.assert_allclose(low, box.min_, rtol=0, atol=within)
            np.testing.assert_allclose(high, box.max_, rtol=0, atol=within)


def test_srdf_allows_pairs() -> None:
    srdf = folder("example-robot-data") / "talos_data/srdf/talos.srdf"
    plain, told = real(URDFS[10]), Robot.load(urdf(URDFS[10]), srdf=srdf)
    assert set(plain.allowed) < set(told.allowed)
    assert len(told.self_collisions()) <= len(plain.self_collisions())


# Round forms


@pytest.mark.parametrize("radius", [0.003, 0.05, 1.0, 20.0])
@pytest.mark.parametrize("error", [1e-4, 1e-3, 1e-2])
def test_round_shapes_are_enclosed(radius: float, error: float) -> None:
    for shape, excess in (
        primitives.sphere(radius, error),
        primitives.cylinder(radius, 2 * radius, error),
    ):
        assert shape.watertight
        a, b, c = (shape.vertices[shape.faces[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        heights = np.einsum("ij,ij->i", normals, a) / np.linalg.norm(normals, axis=1)
        assert heights.min() >= radius * (1 - 1e-15)  # every face's plane is outside
        across = 2 if shape.name == "cylinder" else 3
        beyond = np.linalg.norm(shape.vertices[:, :across], axis=1)
        assert beyond.max() - radius <= excess * (1 + 1e-9)
        round_as_can_be = len(shape.faces) >= 4 * 256 - 4
        assert excess <= error or round_as_can_be


def test_a_sphere_mesh_touches_like_the_sphere() -> None:
    """The inscribed mesh would be free here."""
    from fgenv.collision import collide

    ball, _ = primitives.sphere(0.1)
    wall = primitives.box((0.1, 1, 1))
    rng = np.random.default_rng(0)
    q = rng.normal(size=(200, 4))
    poses = np.tile(np.eye(4), (200, 1, 1))
    for pose, x in zip(poses, q / np.linalg.norm(q, axis=1)[:, None], strict=True):
        pose[:3, :3] = pinocchio.Quaternion(*x).matrix()
    away = np.eye(4)
    away[0, 3] = 0.15 - 1e-9
    assert collide(ball, poses, wall, away).all()


def test_rotation_is_exact_at_rest() -> None:
    np.testing.assert_array_equal(rotation([0.0, 0.0, 0.0]), np.eye(4))
    for rpy in np.random.default_rng(0).uniform(-7, 7, (50, 3)):
        expected = pinocchio.rpy.rpyToMatrix(*rpy)
        np.testing.assert_allclose(rotation(list(rpy))[:3, :3], expected, atol=1e-14)
    assert rotation([0, math.pi / 2, 0])[2, 0] == -1


# Bad files

FAULTS = [
    ("<robot", "<sdf", "<sdf>, expected a URDF file|Opening and ending tag"),
    ("</robot>", "", "line 33: .*, expected XML"),
    ('name="arm"', "", "line 2: <robot>: got no name"),
    (
        'type="revolute"',
        'type="ball"',
        "line 18: joint 'shoulder': type: got 'ball', expected one of",
    ),
    (
        'type="revolute"',
        'type="floating"',
        "is floating: begin at its child, with base='free'",
    ),
    ('<child link="upper"/>', "", "joint 'shoulder': got no child"),
    ('link="upper"/>', 'link="lower"/>', "joint 'shoulder': got 'lower'"),
    (
        "<box size=",
        "<capsule size=",
        "link 'base': collision geometry: got capsule, expected one of box",
    ),
    ('<box size="0.2 0.3 0.4"/>', "", "link 'base': collision geometry: got nothing"),
    (
        'size="0.2 0.3 0.4"',
        'size="0.2 0.3"',
        "link 'base': box size: got .*, expected 3 numbers",
    ),
    ('radius="0.05"', 'radius="-1"', "link 'upper': cylinder: radius: got -1.0, expected meters"),
    ('radius="0.05"', 'radius="wide"', "cylinder radius: got 'wide', expected 1 numbers"),
    (
        'rpy="0.4 0.5 0.6"',
        'rpy="0.4 0.5"',
        "line 20: origin: rpy: got '0.4 0.5', expected three numbers",
    ),
    ('axis xyz="0 1 1"', 'axis xyz="0 0 0"', "joint 'shoulder': axis"),
    ('lower="-1.5"', 'lower="5"', "joint 'shoulder': got lower 5 over upper 2"),
    ('mimic joint="slide"', 'mimic joint="glide"', "mimic: got 'glide', no such joint"),
    ('filename="hand.stl"', "", "link 'hand': got a mesh without filename"),
    ('"hand.stl"', '"foot.stl"', "link 'hand': mesh 'foot.stl': got no such file in .*; put it"),
    (
        '"hand.stl"',
        '"package://feet/foot.stl"',
        r"give package_dirs=\[the folder that holds 'feet'\]",
    ),
    (
        '"hand.stl" ',
        '"hand.stl" scale="1 0 1"',
        "link 'hand': mesh scale: got .*, expected numbers but 0",
    ),
]


@pytest.mark.parametrize(("old", "new", "message"), FAULTS, ids=[m[2][:40] for m in FAULTS])
def test_an_invalid_file_is_an_error(
    old: str, new: str, message: str, tmp_path: Path, arm: Path
) -> None:
    text = ARM.format(mesh="hand.stl", scale="")
    assert old in text
    bad = written(tmp_path, text.replace(old, new, 1), "bad.urdf")
    with pytest.raises((ValueError, FileNotFoundError), match=message):
        Robot.load(bad)


def test_other_bad_input(tmp_path: Path, arm: Path) -> None:
    with pytest.raises(FileNotFoundError, match="does not exist, expected a URDF file"):
        Robot.load(tmp_path / "none.urdf")
    with pytest.raises(FileNotFoundError, match="is a folder"):
        Robot.load(tmp_path)
    with pytest.raises(ValueError, match=r"Document is empty.*, expected a URDF file"):
        Robot.load(written(tmp_path, "", "empty.urdf"))
    with pytest.raises(ValueError, match=r"got a mesh, expected a robot; use mesh or export"):
        Robot.load(written(tmp_path, "solid x", "mesh.urdf"))
    with pytest.raises(ValueError, match=r"mesh\.urdf: line 1: got .*, expected XML"):
        Robot.load(written(tmp_path, "words", "mesh.urdf"))
    with pytest.raises(FileNotFoundError, match=r"path: .* does not exist, expected an SRDF file"):
        Robot.load(arm, srdf=tmp_path / "none.srdf")
    with pytest.raises(ValueError, match=r"path: .*expected XML|expected an SRDF file"):
        Robot.load(arm, srdf=written(tmp_path, "no", "arm.srdf"))
    with pytest.raises(ValueError, match="scale: got 0, expected a factor over 0"):
        Robot.load(arm, scale=0)
    with pytest.raises(ValueError, match="cylinder: error: got 0, expected meters, over 0"):
        Robot.load(arm, error=0)


def test_a_robot_without_collision_geometry_warns(tmp_path: Path) -> None:
    ball = "<visual><geometry><sphere radius='1'/></geometry></visual>"
    path = written(tmp_path, f"<robot name='r'><link name='a'>{ball}</link></robot>")
    with pytest.warns(UserWarning, match="no geometry but visual, so that nothing collides; give"):
        assert not Robot.load(path).parts
    assert len(Robot.load(path, collision=False).parts) == 1


def test_unknown_prefixes_are_skipped(tmp_path: Path, arm: Path) -> None:
    """Unknown prefixes, as in old files for Gazebo."""
    text = ARM.format(mesh="hand.stl", scale="").replace("</robot>", "<sensor:ray/></robot>")
    assert Robot.load(written(tmp_path, text)).dof == 2


def test_without_yourdfpy_the_error_has_a_remedy(arm: Path) -> None:
    code = (
        "import sys; sys.modules['yourdfpy'] = None\n"
        "from fgenv.robots import Robot\n"
        f"try: Robot.load({str(arm)!r})\n"
        "except ModuleNotFoundError as error: print(error)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "yourdfpy is needed; remedy: pip install 'fgenv[urdf]'" in run.stdout

"""Robots from MJCF: kinematics and geometry against MuJoCo, filters, and errors of files."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from fgenv.collision import Shape
from fgenv.robots import Robot
from fgenv.robots.mjcf import read_mjcf
from fgenv.robots.robot_file import RobotFile

pytestmark = pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")

ERROR = 1e-3


def read(path: Path, **options: Any) -> RobotFile:
    defaults = {"collision": True, "scale": 1.0, "error": ERROR, "shape_options": {}}
    return read_mjcf(path, **{**defaults, **options})


def robot_of(file: RobotFile) -> Robot:
    tree = tuple(file.links), tuple(file.joints), file.base, file.mount
    return Robot(file.name, *tree, allowed=tuple(file.allowed), notes=tuple(file.notes))


def written(folder: Path, body: str, head: str = "", tail: str = "") -> Path:
    path = folder / "robot.xml"
    path.write_text(f"<mujoco model='m'>{head}<worldbody>{body}</worldbody>{tail}</mujoco>")
    return path


def loaded(folder: Path, body: str, head: str = "", tail: str = "", **options: Any) -> Robot:
    return robot_of(read(written(folder, body, head, tail), **options))


BALL = "<geom type='sphere' size='0.1'/>"
ARM = f"""
<body name="base" pos="1 2 3" euler="10 20 30">{BALL}
  <body name="upper" pos="0 0 .5"><joint name="shoulder" axis="0 1 0" range="-90 45"/>{BALL}
    <body name="hand" pos="0 0 .5"><joint name="slide" type="slide" range="0 .2"/>{BALL}</body>
  </body>
</body>"""


# Generated models against MuJoCo


def generated(seed: int) -> str:
    """A random model: a tree with several joints per body, away from its origin, with ref."""
    rng = np.random.default_rng(seed)
    degrees = bool(rng.integers(2))
    names = iter(range(1000))

    def vector(size: int = 3, low: float = -1.0, high: float = 1.0) -> str:
        return " ".join(f"{x:.6f}" for x in rng.uniform(low, high, size))

    def turn() -> str:
        axis = f"{vector(3, 0.1)} {rng.uniform(0, 90 if degrees else 1.5):.4f}"
        return str(rng.choice([f"euler='{vector()}'", f"axisangle='{axis}'", ""]))

    def joint() -> str:
        name, kind = f"j{next(names)}", rng.choice(["hinge", "slide"])
        place = rng.choice([f"pos='{vector()}'", ""])
        ref = rng.choice([f"ref='{rng.uniform(-1, 1):.4f}'", ""])
        limits = rng.choice([f"range='{rng.uniform(-2, 0):.3f} {rng.uniform(0.1, 2):.3f}'", ""])
        return f"<joint name='{name}' type='{kind}' axis='{vector()}' {place} {ref} {limits}/>"

    def geom() -> str:
        kinds = ["box", "sphere", "capsule", "cylinder", "ellipsoid", "mesh", "line"]
        kind = rng.choice(kinds)
        if kind == "mesh":
            return f"<geom type='mesh' mesh='part' pos='{vector()}' {turn()}/>"
        if kind == "line":
            return f"<geom type='capsule' size='0.05' fromto='{vector(6)}'/>"
        return f"<geom type='{kind}' size='{vector(3, 0.05, 0.3)}' pos='{vector()}' {turn()}/>"

    def body(depth: int) -> str:
        name, count = f"b{next(names)}", int(rng.integers(0, 4))
        joints = "".join(joint() for _ in range(count))
        inside = "".join(body(depth - 1) for _ in range(rng.integers(0, 3))) if depth else ""
        text = f"<body name='{name}' pos='{vector()}' {turn()}>{joints}{geom()}{geom()}{inside}"
        return text + "</body>"

    start = "<freejoint name='root'/>" if rng.integers(2) else joint()
    text = f"<body name='torso' pos='{vector()}' {turn()}>{start}{geom()}{body(3)}{body(2)}</body>"
    vertices = "0 0 0 .3 0 0 0 .2 0 0 0 .4 .1 .1 .5"
    sequence = rng.choice(["xyz", "zyx", "XYZ", "ZXZ"])
    angle = "degree" if degrees else "radian"
    return (
        f"<mujoco><compiler angle='{angle}' eulerseq='{sequence}' fusestatic='true'/>"
        f"<asset><mesh name='part' scale='1 -1 2' vertex='{vertices}'/></asset>"
        f"<default><joint armature='1'/><geom density='100'/></default>"
        f"<worldbody><geom type='plane' size='1 1 1'/><frame pos='{vector()}' {turn()}>{text}"
        "</frame></worldbody></mujoco>"
    )


def check_poses(path: Path, scale: float = 1.0, samples: int = 5, root: str | None = None) -> Robot:
    """Compare poses of all bodies and geoms with MuJoCo's, on random configurations."""
    robot = robot_of(read(path, scale=scale, root=root))
    text = path.read_text().replace("fusestatic='true'", "")  # keeps the names of all bodies
    twin = path.with_name(f"{path.stem}_twin.xml")
    twin.write_text(text)
    model = mujoco.MjModel.from_xml_path(str(twin))
    twin.unlink()
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    for _ in range(samples):
        q = rng.uniform(np.maximum(robot.lower, -3), np.minimum(robot.upper, 3))
        if robot.base == "free":
            q[3:7] /= np.linalg.norm(q[3:7])
        set_coordinates(model, data, robot, q, scale)
        mujoco.mj_kinematics(model, data)
        compare(model, data, robot, q, scale)
    return robot


def set_coordinates(model: Any, data: Any, robot: Robot, q: Any, scale: float) -> None:
    data.qpos[:] = model.qpos0
    start = 0
    if robot.base == "free":
        at = model.joint(model.body(robot.root).jntadr[0]).qposadr[0]
        data.qpos[at : at + 7] = [*(q[:3] / scale), q[6], *q[3:6]]
        start = 7
    values = dict(zip(robot.coordinates[start:], q[start:], strict=True))
    for joint in robot.joints:
        if joint.moves:
            source, multiplier, offset = robot.mimic_sources[joint.name]
            value = multiplier * values[source.name] + offset
            length = scale if joint.kind == "prismatic" else 1.0
            data.qpos[model.joint(joint.name).qposadr[0]] = value / length


def compare(model: Any, data: Any, robot: Robot, q: Any, scale: float) -> None:
    poses, known = robot.forward(q), {model.body(i).name for i in range(1, model.nbody)}
    compared = 0
    for link, pose in zip(robot.links, poses, strict=True):
        if link.name not in known:  # unnamed in the file
            continue
        body = model.body(link.name)
        place, turn = data.body(link.name).xpos, data.body(link.name).xmat.reshape(3, 3)
        np.testing.assert_allclose(pose[:3, 3], scale * place, atol=1e-9)
        np.testing.assert_allclose(pose[:3, :3], turn, atol=1e-9)
        geoms = range(body.geomadr[0], body.geomadr[0] + body.geomnum[0])
        for geom, placed in zip(geoms, link.shapes, strict=True):
            at = pose @ placed.origin
            np.testing.assert_allclose(at[:3, 3], scale * data.geom_xpos[geom], atol=1e-9)
            np.testing.assert_allclose(at[:3, :3], data.geom_xmat[geom].reshape(3, 3), atol=1e-9)
        compared += 1
    assert compared == len(known - {""})


@pytest.mark.parametrize("seed", range(15))
def test_poses_of_generated_models_are_those_of_mujoco(tmp_path: Path, seed: int) -> None:
    path = tmp_path / "robot.xml"
    path.write_text(generated(seed))
    check_poses(path)
    check_poses(path, scale=0.25, samples=2)


def real_models() -> list[Path]:
    """Models of gymnasium with one robot."""
    import gymnasium

    assets = Path(gymnasium.__file__).parent / "envs/mujoco/assets"
    names = ("ant", "half_cheetah", "hopper", "humanoid", "inverted_pendulum", "walker2d_v5")
    return [assets / f"{name}.xml" for name in names]


@pytest.mark.parametrize("source", real_models(), ids=lambda path: path.stem)
def test_poses_of_real_models_are_those_of_mujoco(
    tmp_path: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its warnings there
    path = tmp_path / source.name
    path.write_bytes(source.read_bytes())
    check_poses(path)


# Kinematics


def test_all_elements_of_an_arm(tmp_path: Path) -> None:
    robot = loaded(tmp_path, ARM)
    assert robot.name == "m"
    assert robot.base == "fixed"
    assert robot.root == "base"
    assert robot.coordinates == ("shoulder", "slide")
    np.testing.assert_allclose(robot.lower, [-np.pi / 2, 0])
    np.testing.assert_allclose(robot.upper, [np.pi / 4, 0.2])
    np.testing.assert_allclose(robot.mount[:3, 3], [1, 2, 3])
    assert [len(link.shapes) for link in robot.links] == [1, 1, 1]
    check_poses(tmp_path / "robot.xml")


def test_a_free_joint_makes_a_free_base_with_poses_in_the_world(tmp_path: Path) -> None:
    robot = loaded(tmp_path, f"<body name='b' pos='1 2 3'><freejoint/>{BALL}</body>")
    assert robot.base == "free"
    q = [4, 5, 6, 0, 0, 0, 1]
    np.testing.assert_array_equal(robot.forward(q, "b")[:3, 3], [4, 5, 6])
    file = read(tmp_path / "robot.xml")
    np.testing.assert_array_equal(file.mount, np.eye(4))
    np.testing.assert_array_equal(file.placement[:3, 3], [1, 2, 3])


def test_files_in_folders_with_any_name(tmp_path: Path) -> None:
    folder = tmp_path / "größe 1"
    folder.mkdir()
    assert loaded(folder, ARM).nq == 2


def test_several_joints_of_a_body_are_links_in_their_order(tmp_path: Path) -> None:
    joints = "<joint name='x' type='slide' axis='1 0 0'/><joint name='t' pos='0 1 0'/>"
    robot = loaded(tmp_path, f"<body name='cart'>{joints}{BALL}</body>")
    assert [link.name for link in robot.links] == ["world", "cart@x", "cart@t", "cart"]
    assert [joint.kind for joint in robot.joints] == ["prismatic", "continuous", "fixed"]
    check_poses(tmp_path / "robot.xml")


def test_ref_is_the_coordinate_of_the_drawn_pose(tmp_path: Path) -> None:
    body = f"<body name='b'><joint name='j' ref='30' range='20 40'/>{BALL}</body>"
    robot = loaded(tmp_path, body)
    np.testing.assert_allclose(robot.forward([np.radians(30)], "b"), np.eye(4), atol=1e-15)
    np.testing.assert_allclose(robot.lower, np.radians(20))


def test_names_that_files_omit_are_unique(tmp_path: Path) -> None:
    inner = f"<body><joint/>{BALL}</body><body name='body2'><joint name='joint0'/>{BALL}</body>"
    robot = loaded(tmp_path, f"<body>{BALL}{inner}</body>")
    assert len({link.name for link in robot.links}) == 3
    assert len(set(robot.coordinates)) == 2


def two_hinges(first: str = "", second: str = "") -> str:
    outer = f"<body name='b'><joint name='a' {first}/>{BALL}<site name='x'/>"
    inner = f"<joint name='f' type='slide' axis='1 1 0' {second}/>{BALL}<site name='y'/>"
    return f"{outer}<body name='c' pos='0 0 1'>{inner}</body></body>"


def test_a_linear_coupling_is_a_mimic_joint(tmp_path: Path) -> None:
    tail = "<equality><joint joint1='f' joint2='a' polycoef='.1 .5 0 0 0'/></equality>"
    body = two_hinges("ref='20' range='-80 80'", "ref='.3'")
    robot = loaded(tmp_path, body, tail=tail)
    assert robot.coordinates == ("a",)
    source, multiplier, offset = robot.mimic_sources["f"]
    assert source.name == "a"
    # f - 0.3 = 0.1 + 0.5 (a - 20 degrees)
    np.testing.assert_allclose([multiplier, offset], [0.5, 0.4 - 0.5 * np.radians(20)])
    check_poses(tmp_path / "robot.xml")
    check_poses(tmp_path / "robot.xml", scale=2.0)


TENDONS = """<tendon><fixed name='t'><joint joint='a' coef='2'/><joint joint='f' coef='-4'/></fixed>
<fixed name='u'><joint joint='a' coef='1'/></fixed></tendon>"""


@pytest.mark.parametrize("second", ["", "tendon2='u' polycoef='.1 3 0 0 0'"])
def test_equalities_of_fixed_tendons_are_mimic_joints(tmp_path: Path, second: str) -> None:
    """Grippers couple their fingers by tendons. MuJoCo's own residual of the constraint is 0."""
    tail = f"{TENDONS}<equality><tendon tendon1='t' {second}/></equality>"
    path = written(tmp_path, two_hinges("ref='20' range='-90 90'", "ref='.3'"), tail=tail)
    robot = robot_of(read(path))
    assert robot.nq == 1
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    for value in (-0.3, 0.2):
        set_coordinates(model, data, robot, np.array([value]), 1.0)
        mujoco.mj_forward(model, data)
        constraints = np.flatnonzero(data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        assert len(constraints) == 1
        np.testing.assert_allclose(data.efc_pos[constraints], 0, atol=1e-12)


def test_a_coupling_to_no_joint_locks_it(tmp_path: Path) -> None:
    tail = "<equality><joint joint1='f' polycoef='.25 0 0 0 0'/></equality>"
    robot = loaded(tmp_path, two_hinges(second="ref='.5'"), tail=tail)
    assert robot.coordinates == ("a",)
    direction = np.array([1, 1, 0]) / np.sqrt(2)
    np.testing.assert_allclose(
        robot.forward([0.0], "c")[:3, 3], [0, 0, 1] + 0.25 * direction, atol=1e-12
    )


@pytest.mark.parametrize(
    ("constraint", "name"),
    [
        ("<joint joint1='f' joint2='a' polycoef='0 1 1 0 0'/>", "polycoef"),
        ("<connect name='loop' body1='c' body2='b' anchor='0 0 0'/>", "equality connect 'loop'"),
        ("<weld body1='c'/>", "equality weld 0"),
        ("<joint joint1='f' joint2='a'/><joint joint1='f'/>", "second coupling"),
        ("<tendon tendon1='s'/>", "equality tendon 0 .*tendon in space"),
    ],
)
def test_other_constraints_are_refused_by_name(tmp_path: Path, constraint: str, name: str) -> None:
    line = "<tendon><spatial name='s'><site site='x'/><site site='y'/></spatial></tendon>"
    path = written(tmp_path, two_hinges(), tail=f"{line}<equality>{constraint}</equality>")
    with pytest.raises(ValueError, match=name) as error:
        read(path)
    assert str(path) in str(error.value)


def test_inactive_constraints_and_those_to_other_bodies_are_notes(tmp_path: Path) -> None:
    mocap = f"<body name='m' mocap='true'>{BALL}</body>"
    tail = "<equality><weld name='w' body1='c' body2='m'/><weld active='false' body1='c'/>"
    file = read(written(tmp_path, two_hinges() + mocap, tail=tail + "</equality>"))
    assert sum("'w'" in note and "not of the robot" in note for note in file.notes) == 1
    assert sum("inactive" in note for note in file.notes) == 1


# Which tree is the robot


def test_scene_and_objects_are_left_out_with_a_note(tmp_path: Path) -> None:
    scene = f"<geom type='plane' size='1 1 1'/><body name='table'>{BALL}</body>"
    thing = f"<body name='mug'><freejoint/>{BALL}</body>"
    file = read(written(tmp_path, scene + ARM + thing))
    assert [link.name for link in file.links] == ["base", "upper", "hand"]
    assert any("geoms of the world (1)" in note and "'table', 'mug'" in note for note in file.notes)


def test_several_robots_need_the_name_of_one(tmp_path: Path) -> None:
    other = f"<body name='other'><joint name='o'/>{BALL}</body>"
    path = written(tmp_path, ARM + other)
    with pytest.raises(ValueError, match=r"2 trees with joints \('base', 'other'\).*root="):
        read(path)
    assert robot_of(read(path, root="other")).coordinates == ("o",)
    with pytest.raises(ValueError, match="root: got 'hand', expected a body of the world: 'base'"):
        read(path, root="hand")


def test_a_scene_without_bodies_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="got no body"):
        read(written(tmp_path, BALL))


# Geometry


def only_shape(folder: Path, geom: str, head: str = "", **options: Any) -> tuple[Shape, Any, float]:
    robot = loaded(folder, f"<body name='b'><joint/>{geom}</body>", head, **options)
    (placed,) = robot.links[-1].shapes
    return placed.shape, placed.origin, placed.excess


@pytest.mark.parametrize(
    ("geom", "volume"),
    [
        ("<geom type='box' size='.1 .2 .3'/>", 0.048),
        ("<geom type='sphere' size='.1'/>", 4 / 3 * np.pi * 1e-3),
        ("<geom type='capsule' size='.1 .2'/>", np.pi * (4e-3 + 4e-3 / 3)),
        ("<geom type='cylinder' size='.1 .2'/>", np.pi * 4e-3),
        ("<geom type='ellipsoid' size='.1 .2 .3'/>", 4 / 3 * np.pi * 6e-3),
    ],
)
def test_solids_enclose_the_exact_ones_closely(tmp_path: Path, geom: str, volume: float) -> None:
    shape, _, excess = only_shape(tmp_path, geom)
    mesh = trimesh.Trimesh(shape.vertices, shape.faces, process=False)
    assert mesh.is_watertight
    assert excess <= ERROR
    assert volume * (1 - 1e-12) <= mesh.volume <= (volume + excess * mesh.area) * (1 + 1e-12)


def test_a_mesh_file_keeps_its_place_scale_and_faces(tmp_path: Path) -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.2, 0.3, 2.0]])
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + ["f 4 3 2 1"]
    lines += ["f 1 2 5", "f 2 3 5", "f 3 4 5", "f 4 1 5"]
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/pyramid.obj").write_text("\n".join(lines))
    head = "<compiler meshdir='parts'/><asset><mesh file='pyramid.obj' scale='-1 2 1'/></asset>"
    geom = "<geom type='mesh' mesh='pyramid' pos='5 6 7' euler='0 0 90'/>"
    shape, origin, excess = only_shape(tmp_path, geom, head)
    assert (shape.name, excess) == ("pyramid", 0.0)
    at = shape.vertices @ origin[:3, :3].T + origin[:3, 3]
    scaled = corners * (-1, 2, 1)
    expected = np.column_stack([5 - scaled[:, 1], 6 + scaled[:, 0], 7 + scaled[:, 2]])
    order, right = np.lexsort(np.round(at, 4).T), np.lexsort(np.round(expected, 4).T)
    np.testing.assert_allclose(at[order], expected[right], atol=1e-6)
    mesh = trimesh.Trimesh(shape.vertices, shape.faces, process=False)
    np.testing.assert_allclose(mesh.volume, 2 * 2 / 3, rtol=1e-5)  # outward in the mirror


def test_a_flat_mesh_collides(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """MuJoCo refuses it, as it has no hull, and writes a page of text; fgenv needs no hull."""
    mesh = "<mesh name='m' inertia='shell' vertex='0 0 0 1 0 0 0 1 0 1 1 0' face='0 1 2 1 3 2'/>"
    shape, origin, _ = only_shape(
        tmp_path, "<geom type='mesh' mesh='m'/>", f"<asset>{mesh}</asset>"
    )
    at = shape.vertices @ origin[:3, :3].T + origin[:3, 3]
    np.testing.assert_allclose(np.ptp(at, axis=0), [1, 1, 0], atol=1e-6)
    assert not capfd.readouterr().err


def test_geoms_of_collision_and_for_the_eye(tmp_path: Path) -> None:
    seen = "<geom size='.2' contype='0' conaffinity='0' group='1'/>"
    hidden = "<geom type='box' size='.1 .1 .1' group='3'/>"
    body = f"<body name='b'><joint/>{seen}{hidden}</body>"
    for collision, name in ((True, "box"), (False, "sphere")):
        robot = loaded(tmp_path, body, collision=collision)
        assert [placed.shape.name for placed in robot.links[-1].shapes] == [name]


def test_a_geom_of_an_explicit_pair_collides(tmp_path: Path) -> None:
    off = "contype='0' conaffinity='0'"
    body = f"<body name='b'>{BALL}<body name='c'><joint/><geom name='g' size='.1' {off}/></body>"
    body += f"<body name='d' pos='1 0 0'><joint/><geom name='h' size='.1' {off}/></body></body>"
    tail = "<contact><pair geom1='g' geom2='h'/></contact>"
    robot = loaded(tmp_path, body, tail=tail)
    assert [len(link.shapes) for link in robot.links] == [1, 1, 1]
    assert ("c", "d") not in robot.allowed


def test_a_robot_without_geoms_that_collide_gives_a_warning(tmp_path: Path) -> None:
    body = "<body><joint/><geom size='.1' contype='0' conaffinity='0'/></body>"
    path = written(tmp_path, body)
    assert read(path).other_geometry
    with pytest.warns(UserWarning, match="collision=False"):
        Robot.load(path)


@pytest.mark.parametrize("kind", ["plane", "hfield"])
def test_geoms_that_are_no_solid_are_refused_by_name(tmp_path: Path, kind: str) -> None:
    rows = "elevation='0 1 0 1'"
    head = f"<asset><hfield name='h' nrow='2' ncol='2' size='1 1 1 1' {rows}/></asset>"
    more = "hfield='h'" if kind == "hfield" else "size='1 1 1'"
    path = written(tmp_path, f"<body name='b'><geom name='g' type='{kind}' {more}/></body>", head)
    with pytest.raises(ValueError, match=f"geom 'g' of body 'b': got type {kind}"):
        read(path)


def test_a_mesh_that_is_only_seen_may_be_missing(tmp_path: Path) -> None:
    head = "<asset><mesh name='skin' file='skin.stl'/></asset>"
    seen = "<geom type='mesh' mesh='skin' contype='0' conaffinity='0'/>"
    inner = f"<body name='c'><joint/>{seen}</body>"  # has no mass without its geom
    path = written(tmp_path, f"<body name='b'><joint/>{BALL}{seen}{inner}</body>", head)
    file = read(path)
    assert any("skin.stl" in note for note in file.notes)
    assert robot_of(file).nq == 2
    with pytest.raises(FileNotFoundError, match=r"skin\.stl"):
        read(path, collision=False)


def test_textures_do_not_matter(tmp_path: Path) -> None:
    head = "<asset><texture name='t' type='2d' file='no.png'/><texture type='cube' name='u'"
    head += " fileright='no.png'/><material name='k' texture='t'/></asset>"
    geoms = "<geom size='.1' material='k'/><geom size='.1' material='no_such'/>"
    robot = loaded(tmp_path, f"<body><joint/>{geoms}</body>", head)
    assert len(robot.links[-1].shapes) == 2


def test_warnings_of_mujoco_are_notes_and_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a handler, MuJoCo writes MUJOCO_LOG.TXT in the folder where a program runs."""
    monkeypatch.chdir(tmp_path)
    head = "<compiler settotalmass='3'/>"
    file = read(written(tmp_path, ARM, head))
    assert [path.name for path in tmp_path.iterdir()] == ["robot.xml"]
    if int(mujoco.__version__[0]) > 3:
        assert any("settotalmass" in note for note in file.notes)


# Allowed collisions


def chain(*masks: tuple[int, int]) -> str:
    """Bodies b0, b1, ... each on the one before, with one geom of (contype, conaffinity)."""
    text = ""
    for i, (kind, affinity) in reversed(list(enumerate(masks))):
        geom = f"<geom size='.1' contype='{kind}' conaffinity='{affinity}'/>"
        text = f"<body name='b{i}' pos='0 0 1'><joint/>{geom}{text}</body>"
    return text


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), min_size=3, max_size=5))
@settings(max_examples=30, deadline=None)
def test_masks_allow_what_mujoco_never_collides(
    tmp_path_factory: pytest.TempPathFactory, masks: list[tuple[int, int]]
) -> None:
    masks = [(3, 3), *masks]
    file = read(written(tmp_path_factory.mktemp("masks"), chain(*masks)))
    allowed = set(file.allowed)
    for i in range(len(masks)):
        for j in range(i):
            never = not (masks[i][0] & masks[j][1] or masks[j][0] & masks[i][1])
            shaped = all(any(masks[k]) for k in (i, j))
            assert ((f"b{j}", f"b{i}") in allowed) == (never and shaped)


def test_excluded_bodies_may_touch(tmp_path: Path) -> None:
    tail = "<contact><exclude body1='b2' body2='b0'/></contact>"
    masks = ((1, 1),) * 4
    assert read(written(tmp_path, chain(*masks), tail=tail)).allowed == [("b0", "b2")]


# Errors


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "is empty"),
        ("<mujoco", "malformed XML"),
        ("<robot name='r'/>", "got <robot>, expected MJCF"),
        ("<mujocoinclude/>", "give the file that includes it"),
        ("<mujoco>\n<foo/></mujoco>", "line 2: .*unrecognized element.*foo"),
        ("<mujoco>\n<worldbody>\n<body><geom size='a'/></body></worldbody></mujoco>", "line 3"),
        ("<!DOCTYPE m [<!ENTITY e 'x'>]><mujoco model='&e;'/>", "document type"),
        ("<mujoco><worldbody><body pos='nan 0 0'/></worldbody></mujoco>", "pos: got NaN"),
        ("<mujoco><include file='robot.xml'/></mujoco>", "includes or attaches itself"),
        ("<mujoco><include file='/dev/zero'/></mujoco>", "device or pipe"),
        ("<mujoco><asset><texture file='/dev/zero'/></asset></mujoco>", "device or pipe"),
        ("<mujoco><size nkey='2000000000'/></mujoco>", "nkey: got over"),
        ("<mujoco><asset><hfield nrow='99999' ncol='99999'/></asset></mujoco>", "items"),
        (
            "<mujoco><worldbody><replicate count='1000'><replicate count='1000'><geom/>"
            "</replicate></replicate></worldbody></mujoco>",
            "with replicas",
        ),
        ("<mujoco><worldbody><flexcomp/></worldbody></mujoco>", "flexcomp.*deformable"),
        (
            "<mujoco><worldbody><body name='b'><joint name='j' type='ball'/><geom size='.1'/>"
            "</body></worldbody></mujoco>",
            "joint 'j' of body 'b': got type ball, expected hinge or slide; replace",
        ),
    ],
)
def test_invalid_files_give_one_error_with_the_file(tmp_path: Path, text: str, match: str) -> None:
    path = tmp_path / "robot.xml"
    path.write_text(text)
    with pytest.raises(ValueError, match=match) as error:
        read(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_models_that_attach_each_other_are_refused(tmp_path: Path) -> None:
    """MuJoCo's parser recurses without end and crashes."""
    for name, other in (("robot", "b"), ("b", "robot")):
        head = f"<asset><model name='x' file='{other}.xml'/></asset>"
        body = "<body name='p'><attach model='x' body='p' prefix='q'/></body>"
        text = f"<mujoco>{head}<worldbody>{body}</worldbody></mujoco>"
        (tmp_path / f"{name}.xml").write_text(text)
    with pytest.raises(ValueError, match="includes or attaches itself"):
        read(tmp_path / "robot.xml")


def test_without_mujoco_the_error_names_the_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(ModuleNotFoundError, match=r"fgenv\[mjcf\]"):
        read(written(tmp_path, ARM))


def test_missing_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="does not exist"):
        read(tmp_path / "no.xml")
    with pytest.raises(FileNotFoundError, match="is a folder"):
        read(tmp_path)
    head = "<asset><mesh name='m' file='no.stl'/></asset>"
    path = written(tmp_path, "<body><joint/><geom type='mesh' mesh='m'/></body>", head)
    with pytest.raises(FileNotFoundError, match=r"no\.stl"):
        read(path)


def test_includes_and_attached_models_are_read(tmp_path: Path) -> None:
    (tmp_path / "part.xml").write_text(f"<mujoco><body name='i'><joint/>{BALL}</body></mujoco>")
    (tmp_path / "hand.xml").write_text(
        f"<mujoco><worldbody><body name='palm'><joint name='w'/>{BALL}</body></worldbody></mujoco>"
    )
    head = "<asset><model name='hand' file='hand.xml'/></asset>"
    attach = "<attach model='hand' body='palm' prefix='left_'/>"
    body = f"<body name='b'>{BALL}<include file='part.xml'/>{attach}</body>"
    robot = loaded(tmp_path, body, head)
    assert {link.name for link in robot.links} == {"b", "i", "left_palm"}


DAMAGE = """
import random, sys
from pathlib import Path
from fgenv.robots.mjcf import read_mjcf
folder = Path(sys.argv[1])
text = (folder / "robot.xml").read_text()
words = ["", "-1", "1e308", "0", "b1", "<body>", "/>", "free", "mesh", "99999999999", "'", "inf"]
for seed in range(int(sys.argv[2])):
    rng = random.Random(seed)
    damaged = text
    for _ in range(rng.randint(1, 3)):
        i = rng.randrange(len(damaged))
        damaged = damaged[:i] + rng.choice(words) + damaged[i + rng.randint(0, 8):]
    path = folder / "damaged.xml"
    path.write_text(damaged)
    try:
        read_mjcf(path, collision=True, scale=1.0, error=1e-2, shape_options={})
    except (ValueError, FileNotFoundError) as error:
        assert "damaged.xml" in str(error), error
"""


def test_damaged_files_are_read_or_refused(tmp_path: Path) -> None:
    (tmp_path / "robot.xml").write_text(generated(3))
    command = [sys.executable, "-W", "ignore", "-c", DAMAGE, str(tmp_path), "100"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["damaged.xml", "robot.xml"]

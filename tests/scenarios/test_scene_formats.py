"""Octrees, point clouds, scenes as text and problems of OMPL.app as scenarios."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from support.shell import Shell

from fgenv.scenarios import Scenario, ScenarioError, validate
from fgenv.scenarios.io.moveit import load_scene
from fgenv.scenarios.io.octomap import CENTER, DEPTH, read_octree
from fgenv.scenarios.io.point_files import read_points

pytestmark = pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")

# Octrees -----------------------------------------------------------------------------------------

Cell = tuple[int, int, int]
UNKNOWN, FREE, OCCUPIED, INNER = 0, 1, 2, 3


def children(key: Cell, edge: int) -> list[Cell]:
    """Lower corners of the eight children of a node of an edge: bit 0 of the number is x."""
    x, y, z = key
    h = edge // 2
    return [(x + h * (i & 1), y + h * (i >> 1 & 1), z + h * (i >> 2)) for i in range(8)]


class Octree:
    """Cells at the lowest level, 1 free and 2 occupied, as OctoMap writes them."""

    def __init__(self, cells: dict[Cell, int]) -> None:
        self.cells, self.nodes = cells, 1

    def state(self, key: Cell, edge: int) -> int:
        """State of a node, which has no children where all of its cells agree."""
        inside = [
            value
            for cell, value in self.cells.items()
            if all(k <= c < k + edge for k, c in zip(key, cell, strict=True))
        ]
        if not inside:
            return UNKNOWN
        same = len(inside) == edge**3 and len(set(inside)) == 1
        return inside[0] if same else INNER

    def binary(self, key: Cell = (0, 0, 0), edge: int = 1 << DEPTH) -> bytes:
        """Two bits for each child, and then the inner children."""
        below = children(key, edge)
        states = [self.state(child, edge // 2) for child in below]
        self.nodes += sum(state != UNKNOWN for state in states)
        bits = sum(state << (2 * i) for i, state in enumerate(states))
        inner = [
            self.binary(c, edge // 2) for c, s in zip(below, states, strict=True) if s == INNER
        ]
        return struct.pack("<H", bits) + b"".join(inner)

    def full(self, key: Cell = (0, 0, 0), edge: int = 1 << DEPTH) -> bytes:
        """Log-odds and a bit for each child, and then all children."""
        state = self.state(key, edge)
        if state != INNER:
            return struct.pack("<fB", 2.0 if state == OCCUPIED else -1.0, 0)
        below = [(i, c) for i, c in enumerate(children(key, edge)) if self.state(c, edge // 2)]
        self.nodes += len(below)
        bits = sum(1 << i for i, _ in below)
        return struct.pack("<fB", 0.0, bits) + b"".join(self.full(c, edge // 2) for _, c in below)

    def write(self, path: Path, resolution: float = 0.5) -> Path:
        """Write a .bt or .ot file."""
        binary = path.suffix == ".bt"
        body = self.binary() if binary else self.full()
        kind = "OcTree binary" if binary else "OcTree"
        head = f"# Octomap {kind} file\nid OcTree\nsize {self.nodes}\nres {resolution}\ndata\n"
        path.write_bytes(head.encode() + body)
        return path


BLOCKS = arrays(np.int8, (4, 4, 4), elements=st.integers(0, 2))


def octree(block: NDArray[np.int8]) -> Octree:
    """Cells around the origin."""
    return Octree({
        (i + CENTER - 2, j + CENTER - 2, k + CENTER - 2): int(v)
        for (i, j, k), v in np.ndenumerate(block) if v
    })  # fmt: skip


@settings(max_examples=25)
@given(BLOCKS, st.sampled_from([".bt", ".ot"]))
def test_boxes_are_the_occupied_leaves(
    tmp_path_factory: pytest.TempPathFactory, block: NDArray[np.int8], suffix: str
) -> None:
    if not block.any():
        return
    path = octree(block).write(tmp_path_factory.getbasetemp() / f"t{suffix}")
    scenario = Scenario.load(path)
    if not (block == OCCUPIED).any():
        assert scenario.bodies == ()
        return
    centers = (np.argwhere(np.ones_like(block)) - 1.5) * 0.5
    (shape,) = scenario.build().shapes
    assert shape.watertight
    assert (shape.contains(centers) == (block.ravel() == OCCUPIED)).all()


def test_a_threshold_decides_for_log_odds(tmp_path: Path) -> None:
    block = np.full((4, 4, 4), OCCUPIED, dtype=np.int8)
    path = octree(block).write(tmp_path / "t.ot")
    assert len(read_octree(path, 0.8)[0]) > 0  # log-odds 2 are a probability of 0.88
    assert len(read_octree(path, 0.95)[0]) == 0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"# Octomap", b"# Octopus", "line 1: begins with .*expected"),
        (b"id OcTree", b"id RandomTree", "is a tree of type 'RandomTree'"),
        (b"res 0.5", b"res 0", "has resolution 0; expected a length over 0"),
        (b"res 0.5", b"res far", "got 'far'; expected a number"),
        (b"size 1", b"size 9", "expected 9"),
        (b"data\n", b"dat\n", "got 'dat'"),
    ],
)
def test_octrees_that_are_refused(old: bytes, new: bytes, message: str, tmp_path: Path) -> None:
    path = octree(np.full((4, 4, 4), OCCUPIED, dtype=np.int8)).write(tmp_path / "t.bt")
    data = path.read_bytes()
    path.write_bytes(data.replace(old, new, 1))
    with pytest.raises(ScenarioError, match=message):
        Scenario.load(path)
    path.write_bytes(data[:-1])
    with pytest.raises(ScenarioError, match="ends within the tree; the file is truncated"):
        Scenario.load(path)
    path.write_bytes(data + b"more")
    with pytest.raises(ScenarioError, match="and 4 bytes after them"):
        Scenario.load(path)


# Point clouds ------------------------------------------------------------------------------------

CLOUDS = arrays(np.float32, st.tuples(st.integers(1, 8), st.just(3)),
                elements=st.floats(-3, 3, width=32))  # fmt: skip


def lzf(data: bytes) -> bytes:
    """Compressed data of literals only."""
    parts = [data[i : i + 32] for i in range(0, len(data), 32)]
    return b"".join(bytes([len(part) - 1]) + part for part in parts)


def pcd(path: Path, points: NDArray[np.float32], form: str) -> Path:
    n = len(points)
    head = (
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
        f"WIDTH {n}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {n}\nDATA {form}\n"
    )
    rows = np.zeros(n, dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<u4")])
    rows["x"], rows["y"], rows["z"] = points.T
    if form == "ascii":
        body = "\n".join(f"{x!r} {y!r} {z!r} 0" for x, y, z in points.tolist()).encode()
    elif form == "binary":
        body = rows.tobytes()
    else:
        raw = b"".join(rows[name].tobytes() for name in ("x", "y", "z", "rgb"))
        packed = lzf(raw)
        body = struct.pack("<II", len(packed), len(raw)) + packed
    path.write_bytes(head.encode() + body)
    return path


def ply(path: Path, points: NDArray[np.float32], form: str) -> Path:
    head = f"ply\nformat {form} 1.0\nelement vertex {len(points)}\nproperty float x\n"
    head += "property float y\nproperty float z\nproperty uchar red\nend_header\n"
    if form == "ascii":
        body = "\n".join(f"{x!r} {y!r} {z!r} 7" for x, y, z in points.tolist()).encode()
    else:
        order = "<" if "little" in form else ">"
        body = b"".join(struct.pack(f"{order}fffB", *p, 7) for p in points.tolist())
    path.write_bytes(head.encode() + body)
    return path


WRITERS: list[tuple[Any, str, str]] = [
    *((pcd, ".pcd", form) for form in ("ascii", "binary", "binary_compressed")),
    *((ply, ".ply", f) for f in ("ascii", "binary_little_endian", "binary_big_endian")),
]


@settings(max_examples=40)
@given(CLOUDS, st.sampled_from(WRITERS), st.sampled_from([0.0, 0.3]))
def test_each_point_and_its_ball_are_in_the_body(
    tmp_path_factory: pytest.TempPathFactory,
    points: NDArray[np.float32],
    writer: tuple[Any, str, str],
    radius: float,
) -> None:
    write, suffix, form = writer
    path = write(tmp_path_factory.getbasetemp() / f"c{suffix}", points, form)
    assert np.array_equal(read_points(path), points.astype(np.float64))
    (shape,) = Scenario.load(path, voxel=0.25, radius=radius).build().shapes
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    around = points[:, None].astype(np.float64) + radius * corners / np.sqrt(3)
    assert shape.contains(around.reshape(-1, 3)).all()
    low, high = shape.bounds
    assert (low >= points.min(axis=0) - radius - 0.2501).all()
    assert (high <= points.max(axis=0) + radius + 0.2501).all()


def test_references_of_compressed_data(tmp_path: Path) -> None:
    """A literal of one byte, then a reference that repeats it."""
    path = pcd(tmp_path / "c.pcd", np.zeros((2, 3), dtype=np.float32), "binary_compressed")
    head = path.read_bytes().partition(b"binary_compressed\n")[0] + b"binary_compressed\n"
    packed = b"\x00\x00" + bytes([(7 << 5), 31 - 9, 0])  # 31 more bytes: 7 + 22 + 2
    path.write_bytes(head + struct.pack("<II", len(packed), 32) + packed)
    assert np.array_equal(read_points(path), np.zeros((2, 3)))


def test_points_without_a_return_are_left_out(tmp_path: Path) -> None:
    points = np.array([[0, 0, 0], [np.nan, 0, 0], [1, np.inf, 0]], dtype=np.float32)
    assert np.array_equal(read_points(pcd(tmp_path / "c.pcd", points, "binary")), np.zeros((1, 3)))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"FIELDS x y z", b"FIELDS x y w", "has no z; expected fields x, y and z"),
        (b"POINTS 2", b"POINTS 3", "expected 3 points of 16: the file is truncated"),
        (b"POINTS 2", b"POINTS two", "got 'two'; expected a whole number"),
        (b"TYPE F", b"TYPE Q", "has a field of 'Q4'"),
        (b"DATA binary", b"DATA packed", "has DATA 'packed'"),
        (b"DATA binary", b"DATE binary", "has no PCD header"),
        (b"COUNT 1 1 1 1", b"COUNT 1 1 1", "of several lengths"),
    ],
)
def test_clouds_that_are_refused(old: bytes, new: bytes, message: str, tmp_path: Path) -> None:
    path = pcd(tmp_path / "c.pcd", np.zeros((2, 3), dtype=np.float32), "binary")
    path.write_bytes(path.read_bytes().replace(old, new, 1))
    with pytest.raises(ScenarioError, match=message):
        Scenario.load(path)


def test_a_mesh_is_no_point_cloud(tmp_path: Path) -> None:
    trimesh.creation.box().export(tmp_path / "box.ply")
    with pytest.raises(ScenarioError, match="has faces; it is a mesh: use a shape of kind: mesh"):
        Scenario.load(tmp_path / "box.ply")


# Scenes as text ----------------------------------------------------------------------------------

OLDER = """(scene)
* box one
1
box
1 2 3
0.5 0 0.25
0 0 0 1
0 0 0 0
* things
2
sphere
0.5
0 1 0
0 0 0 1
1 0 0 1
cylinder
0.2 0.8
0 0 2
0 0 0.7071067811865476 0.7071067811865476
0 0 0 0
.
"""
NEWER = """(scene)
* box one
0.5 0 0
0 0 0 1
1
box
1 2 3
0 0 0.25
0 0 0 1
0 0 0 0
1
top
0 0 1.5
0 0 0 1
* things
0 0 0
0 0 0 1
2
sphere
0.5
0 1 0
0 0 0 1
1 0 0 1
cylinder
0.2 0.8
0 0 2
0 0 0.7071067811865476 0.7071067811865476
0 0 0 0
0
.
"""
AS_YAML = """
name: (scene)
world:
  collision_objects:
  - id: box one
    primitives: [{type: 1, dimensions: [1, 2, 3]}]
    primitive_poses: [{position: {x: 0.5, y: 0, z: 0.25}, orientation: {x: 0, y: 0, z: 0, w: 1}}]
  - id: things
    primitives: [{type: 2, dimensions: [0.5]}, {type: 3, dimensions: [0.8, 0.2]}]
    primitive_poses:
    - {position: {x: 0, y: 1, z: 0}, orientation: {x: 0, y: 0, z: 0, w: 1}}
    - position: {x: 0, y: 0, z: 2}
      orientation: {x: 0, y: 0, z: 0.7071067811865476, w: 0.7071067811865476}
"""


@pytest.mark.parametrize("text", [OLDER, NEWER])
def test_both_versions_are_the_scene_in_yaml(text: str, tmp_path: Path) -> None:
    (tmp_path / "s.scene").write_text(text)
    (tmp_path / "s.yaml").write_text(AS_YAML)
    one, two = (load_scene(tmp_path / name) for name in ("s.scene", "s.yaml"))
    assert one.bodies == two.bodies
    assert one.shapes == two.shapes
    scenario = Scenario.load(tmp_path / "s.scene")
    assert scenario.bodies == one.bodies
    assert validate(tmp_path / "s.scene") == []


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("\n.\n", "\n", "ends within an object; expected a last line with a dot"),
        ("\nbox\n", "\nbxo\n", "line 4: has a shape of kind 'bxo'; did you mean 'box'"),
        ("1 2 3", "1 2 x", "line 5: got 'x'; expected a number"),
        ("1 2 3", "1 2 -3", "line 4"),
        ("* things", "things", "expected \\* and an id, or a last dot"),
        ("* things", "* box one", "names two objects or none"),
        ("\n.\n", "\n.\nmore\n", "goes on after the last dot"),
        ("1\nbox", "99999999999\nbox", "expected a count up to"),
    ],
)
def test_scenes_that_are_refused(old: str, new: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "s.scene").write_text(OLDER.replace(old, new, 1))
    with pytest.raises(ScenarioError, match=message):
        Scenario.load(tmp_path / "s.scene")


# OMPL.app ----------------------------------------------------------------------------------------

SE3 = """[problem]
name = cubicles
robot = robot.obj
world = world.obj
start.x = -1
start.y = 2
start.z = 3
start.theta = 1.5707963267948966
start.axis.x = 0
start.axis.y = 1
start.axis.z = 0
goal.x = 4
goal.y = 5
goal.z = -6
goal.theta = 0
goal.axis.x = 1
goal.axis.y = 0
goal.axis.z = 0
volume.min.x = -10
volume.min.y = -20
volume.min.z = -30
volume.max.x = 11
volume.max.y = 22
volume.max.z = 33

[planner]
planner = rrt
"""


def problem(folder: Path, text: str = SE3) -> Path:
    robot = trimesh.creation.box((1, 2, 3))
    robot.apply_translation((0.5, 1.0, 1.5))
    robot.export(folder / "robot.obj")
    trimesh.creation.box((1, 1, 1)).export(folder / "world.obj")
    (folder / "p.cfg").write_text(text)
    return folder / "p.cfg"


def test_a_problem_in_three_dimensions_is_turned_to_z_up(tmp_path: Path) -> None:
    """A point (x, y, z) of OMPL.app, where y is up, is (x, -z, y); states are of the mean."""
    scenario = Scenario.load(problem(tmp_path))
    assert scenario.name == "cubicles"
    assert scenario.workspace is not None
    assert scenario.workspace.low == (-10, -33, -20)
    assert scenario.workspace.high == (11, 30, 22)
    (robot,) = scenario.robots
    assert robot.start[:3] == (-1, -3, 2)
    assert robot.goal[:3] == (4, 6, 5)
    built = scenario.build()
    turn = built.robots[0].forward(built.starts[0])[0, :3, :3]
    # A quarter turn about y, which is now z, takes x to -z of the file, which is now y.
    assert np.allclose(turn, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-12)
    vertices = built.robots[0].parts[0].shape.vertices
    assert np.allclose(vertices.mean(axis=0), 0, atol=1e-12)
    assert np.allclose(np.ptp(vertices, axis=0), (1, 3, 2))


def test_a_problem_in_the_plane(tmp_path: Path) -> None:
    kept = [line for line in SE3.splitlines() if ".z" not in line and "axis" not in line]
    scenario = Scenario.load(problem(tmp_path, "\n".join(kept)))
    assert scenario.robots[0].start == (-1, 2, 1.5707963267948966)
    assert scenario.build().robots[0].base == "planar"
    assert scenario.build().robots[0].parts[0].shape.bounds[:, 2].tolist() == [0, 3]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("start.x", "strat.x", "line 5: strat.x: is no known key; did you mean 'start.x'"),
        ("goal.y = 5\n", "", "goal.y: is missing; add it"),
        ("goal.y = 5", "goal.y = five", "line 13: got 'five'; expected a number"),
        ("goal.y = 5", "goal.y 5", "line 13: .*has no ="),
        ("robot.obj", "none.obj", "line 3: robot: 'none.obj' does not exist"),
        ("name = cubicles", "control = kinematic_car", "problems with controls are not supported"),
        ("goal.y = 5", "goal.y = 5\ngoal.y = 6", "stands twice, first in line 13"),
    ],
)
def test_problems_that_are_refused(old: str, new: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=message):
        Scenario.load(problem(tmp_path, SE3.replace(old, new, 1)))


def test_up_turns_meshes_for_a_plan(shell: Shell) -> None:
    """A world whose floor is x and z is planned as the same world with z up."""
    turned = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]])  # z up to y up
    for name, size in (("robot", (0.4, 0.4, 0.4)), ("world", (0.5, 3.0, 1.0))):
        mesh = trimesh.creation.box(size)
        mesh.export(f"{name}.obj")
        mesh.apply_transform(turned)
        mesh.export(f"{name}_y.obj")
    ends = "--start", "-2,0,0", "--goal", "2,0,0", "--seed", 1
    one = shell.json("plan", "--mesh", "robot.obj", "--world", "world.obj", *ends)
    two = shell.json("plan", "--mesh", "robot_y.obj", "--world", "world_y.obj", "--up", "y", *ends)
    assert np.allclose(one["robots"][0]["configurations"], two["robots"][0]["configurations"])
    assert "--up: got 'w', expected one of z, y, x" in shell.refuses(
        "plan", "--mesh", "robot.obj", "--up", "w", "--start", "0,0,0", "--goal", "1,0,0"
    )
    assert "--up: expected with --mesh" in shell.refuses("plan", "swap", "--up", "y")

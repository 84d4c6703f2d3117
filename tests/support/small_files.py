"""A small valid file for each reader of files in the project."""

from __future__ import annotations

import io
import struct
import tracemalloc
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from PIL import Image

import fgenv
from fgenv.agents import run_episode
from fgenv.agents.policies.policy_file import PolicyFile
from fgenv.agents.weights import included
from fgenv.collision import MeshWarning, Shape
from fgenv.envs import Record, Simulator, policy_of
from fgenv.planners import Plan
from fgenv.robots import Robot
from fgenv.scenarios import Scenario
from fgenv.scenarios.frozen_set import frozen
from fgenv.scenarios.io.moveit import load_problem, load_scene
from fgenv.view.figures.learning_curves import evaluations
from support import mesh_files as meshes
from support import scene_files as scenes

Reader = Callable[[Path], object]


@dataclass(frozen=True)
class SmallFile:
    """A file, its reader, and files of the same folder that refer to it or that it refers to."""

    name: str
    content: bytes = field(repr=False)
    read: Reader = field(repr=False)
    beside: Mapping[str, bytes] = field(default_factory=dict, repr=False)

    def path(self, folder: Path) -> Path:
        """The path of the file in a folder, to which the other files are written."""
        for name, content in self.beside.items():
            (folder / name).write_bytes(content)
        return folder / self.name

    def write(self, folder: Path, content: bytes | None = None) -> Path:
        """Write the files; `content` replaces that of the file itself."""
        path = self.path(folder)
        path.write_bytes(self.content if content is None else content)
        return path

    def outcome(self, path: Path) -> Any:
        """What the reader returns; None for a file that it refuses by a clear error."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MeshWarning)
            try:
                return self.read(path)
            except (ValueError, OSError) as error:
                text = str(error)
        # A fault of a buffer is reported at the place of the document that refers to it.
        assert path.name in text or (path.name == "box.bin" and "o.gltf" in text), text
        check_text(text)
        return None

    def assert_refused(self, path: Path) -> None:
        """Assert that a file is refused by a clear error, with little memory."""
        size = path.stat().st_size if path.is_file() else 0
        tracemalloc.start()
        try:
            assert self.outcome(path) is None
            assert tracemalloc.get_traced_memory()[1] < (64 << 20) + 256 * size
        finally:
            tracemalloc.stop()


def check_text(text: str) -> None:
    """Assert that an error does not quote a file at length, nor its control characters."""
    lines = text.splitlines()
    assert len(lines) == 1 or "problems" in lines[0] or lines[0].endswith(":"), text
    assert all(line.isprintable() and len(line) < 800 for line in lines), text


def through(name: str, read: Reader) -> Reader:
    """A reader that reads another file of the same folder, which refers to the one given."""
    return lambda path: read(path.with_name(name))


def _meshes() -> Iterator[SmallFile]:
    chosen = (
        *("binary.stl", "text.stl", "solids.stl", "polygons.obj", "materials.obj", "plain.off"),
        *("all.off", "ascii.ply", "binary_little_endian.ply", "binary_big_endian_types.ply"),
        *("ascii_strips.ply", "extras_binary.ply", "part.stl.gz", "part.zip"),
    )
    for case in meshes.mesh_cases():
        if case.name in chosen:
            yield SmallFile(case.name, case.content, Shape.load)
    box = scenes.one_box()
    yield SmallFile("box.glb", box.glb(), Shape.load)
    yield SmallFile("box.gltf", box.text(), Shape.load)
    outside = box.text("box.bin")
    yield SmallFile("box.bin", bytes(box.blob), through("o.gltf", Shape.load), {"o.gltf": outside})
    yield SmallFile("box.dae", scenes.collada(), Shape.load)
    yield SmallFile("box.zae", scenes.zipped({"box.dae": scenes.collada()}), Shape.load)
    yield SmallFile("box.3mf", scenes.threemf(scenes.model(scenes.box_object())), Shape.load)


URDF = b"""<?xml version="1.0"?>
<robot name="arm"><!-- an arm -->
  <link name="base"><collision><origin xyz="0 0 0.1" rpy="0 0.5 0"/>
    <geometry><cylinder radius="0.1" length="0.2"/></geometry></collision></link>
  <link name="hand"><collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision></link>
  <link name="tip"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="hand"/>
    <origin xyz="0 0 1"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="2" effort="3"/></joint>
  <joint name="slide" type="prismatic"><parent link="hand"/><child link="tip"/>
    <mimic joint="turn" multiplier="0.5"/><limit upper="1"/></joint>
</robot>
"""
SRDF = b"""<?xml version="1.0"?>
<robot name="arm">
  <group name="arm"><joint name="turn"/></group>
  <disable_collisions link1="base" link2="hand" reason="Adjacent"/>
</robot>
"""
MESH_ROBOT = b"""<robot name="part"><link name="base"><collision><geometry>
<mesh filename="part.stl" scale="1 2 1"/></geometry></collision></link></robot>"""

MJCF = b"""<?xml version="1.0"?>
<mujoco model="arm"><!-- an arm -->
  <compiler angle="radian"/>
  <default><geom density="100"/></default>
  <asset><mesh name="part" file="part.obj"/></asset>
  <worldbody><geom type="plane" size="1 1 1"/>
    <body name="base"><geom type="cylinder" size="0.1 0.2" euler="0 0.5 0"/>
      <body name="hand" pos="0 0 1"><joint name="turn" axis="0 1 0" range="-1 1"/>
        <geom type="box" size="0.1 0.2 0.3"/>
        <body name="tip"><joint name="slide" type="slide"/>
          <geom type="capsule" size="0.1" fromto="0 0 0 0 0 1"/></body>
        <body name="tool"><joint name="spin" ref="0.5"/><geom type="mesh" mesh="part"/></body>
      </body></body></worldbody>
  <equality><joint joint1="slide" joint2="turn" polycoef="0 0.5 0 0 0"/></equality>
  <contact><exclude body1="base" body2="tip"/></contact>
</mujoco>
"""
SDF = b"""<?xml version="1.0"?>
<sdf version="1.9"><model name="arm"><!-- an arm -->
  <pose degrees="true">0 0 1 0 0 90</pose>
  <link name="base"><collision name="c"><geometry>
    <cylinder><radius>0.1</radius><length>0.2</length></cylinder></geometry></collision></link>
  <link name="hand"><pose relative_to="turn"/><collision name="c"><pose>0 0 0.1 0 0 0</pose>
    <geometry><box><size>0.1 0.2 0.3</size></box></geometry></collision></link>
  <link name="tip"><collision name="c"><geometry><mesh><uri>part.stl</uri>
    <scale>1 2 1</scale></mesh></geometry></collision></link>
  <joint name="turn" type="revolute"><pose relative_to="base">0 0 1 0 0.5 0</pose>
    <parent>base</parent><child>hand</child>
    <axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>
  <joint name="slide" type="prismatic"><parent>hand</parent><child>tip</child>
    <axis><xyz expressed_in="base">1 0 0</xyz><mimic joint="turn"/></axis></joint>
</model></sdf>
"""


def _robots() -> Iterator[SmallFile]:
    def with_srdf(path: Path) -> Robot:
        return Robot.load(path.with_name("arm.urdf"), srdf=path)

    stl = meshes.binary_stl(*scenes.box())
    yield SmallFile("arm.urdf", URDF, Robot.load)
    yield SmallFile("arm.srdf", SRDF, with_srdf, {"arm.urdf": URDF})
    yield SmallFile("part.stl", stl, through("m.urdf", Robot.load), {"m.urdf": MESH_ROBOT})
    part = meshes.obj(*meshes.prism()).encode()
    yield SmallFile("arm.xml", MJCF, Robot.load, {"part.obj": part})
    named = MJCF.replace(b"part.obj", b"tool.obj"), MJCF.replace(b"part.obj", b"tool.stl")
    yield SmallFile("tool.obj", part, through("o.xml", Robot.load), {"o.xml": named[0]})
    yield SmallFile("tool.stl", stl, through("s.xml", Robot.load), {"s.xml": named[1]})
    yield SmallFile("arm.sdf", SDF, Robot.load, {"part.stl": stl})


SCENARIO = b"""version: 1
name: room
workspace: {low: [-3, -3], high: [3, 3]}
time_step: 0.1
shapes:
  disc: {kind: disc, radius: 0.3}
  wall: {kind: box, size: [1, 2, 1]}
models:
  cart: {shape: disc, drive: {kind: differential, speed: 1.0, turn_rate: 1.5}}
robots:
  - {name: one, model: cart, start: [-2, 0, 0], goal: [2, 0, 0]}
bodies:
  - {name: block, shape: wall, position: [0, 1.5, 0.5], rpy: [0, 0, 0.1]}
"""
MESH_SCENARIO = SCENARIO.replace(b"{kind: box, size: [1, 2, 1]}", b"{kind: mesh, file: part.obj}")
SCENE = b"""name: table
world:
  collision_objects:
  - id: table
    header: {frame_id: world}
    operation: 0
    primitives: [{type: 1, dimensions: [1, 2, 3]}, {type: 2, dimensions: [0.5]}]
    primitive_poses:
    - {position: {x: 0, y: 0, z: 0}, orientation: {x: 0, y: 0, z: 0, w: 1}}
    - {position: [3, 0, 0], orientation: [0, 0, 0, 1]}
"""
REQUEST = b"""start_state: {joint_state: {name: [turn], position: [0.0]}}
goal_constraints:
- joint_constraints: [{joint_name: turn, position: 0.5}]
"""
TEXT_SCENE = b"""(scene)
* box one
0.5 0 0
0 0 0 1
2
box
1 2 3
0 0 0.25
0 0 0 1
0 0 0 0
mesh
3 1
0 0 0
1 0 0
0 1 0
0 1 2
0 0 2
0 0 0 1
0 0 0 0
1
top
0 0 1.5
0 0 0 1
.
"""
CFG = b"""[problem]
name = plane
robot = robot.obj
world = world.obj
start.x = -1
start.y = 2
start.theta = 0
goal.x = 4
goal.y = 5
goal.theta = 1.5
volume.min.x = -10
volume.min.y = -20
volume.max.x = 11
volume.max.y = 22
[planner]
planner = rrt
"""


def _scenarios() -> Iterator[SmallFile]:
    load = Scenario.load
    part = meshes.obj(*meshes.prism()).encode()

    def problem(path: Path) -> Scenario:
        folder = path.parent
        return load_problem(folder / "s.yaml", path, urdf=str(folder / "arm.urdf"))

    yield SmallFile("room.yaml", SCENARIO, load)
    mesh = through("m.yaml", lambda path: load(path).build())
    yield SmallFile("part.obj", part, mesh, {"m.yaml": MESH_SCENARIO})
    yield SmallFile("table.yaml", SCENE, load_scene)
    yield SmallFile("request.yaml", REQUEST, problem, {"s.yaml": SCENE, "arm.urdf": URDF})
    yield SmallFile("table.scene", TEXT_SCENE, load)
    yield SmallFile("plane.cfg", CFG, load, {"robot.obj": part, "world.obj": part})
    beside = {"p.cfg": CFG, "world.obj": part}
    yield SmallFile("robot.obj", part, through("p.cfg", load), beside)


MAP = b"type octile\nheight 3\nwidth 4\nmap\n.@.T\n..GS\nOW..\n"
ROWS = b"version 1\n0\tm.map\t4\t3\t0\t0\t2\t0\t2.5\n1\tm.map\t4\t3\t0\t1\t3\t2\t4\n"
ROS = b"""image: NAME
resolution: 0.5
origin: [1, 2, 0.1]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.25
"""


def _maps() -> Iterator[SmallFile]:
    load = Scenario.load
    yield SmallFile("walls.map", MAP, load)
    yield SmallFile("rows.scen", ROWS, load, {"m.map": MAP})
    yield SmallFile("m.map", MAP, through("r.scen", load), {"r.scen": ROWS})
    pixels = Image.fromarray(np.arange(0, 240, 8, dtype=np.uint8).reshape(5, 6))
    for name in ("m.pgm", "m.png"):
        out = io.BytesIO()
        pixels.save(out, "png" if name == "m.png" else "ppm")
        map_file = ROS.replace(b"NAME", name.encode())
        yield SmallFile(name, out.getvalue(), through("n.yaml", load), {"n.yaml": map_file})
        if name == "m.png":
            yield SmallFile("map.yaml", map_file, load, {name: out.getvalue()})


def octrees() -> Iterator[tuple[str, bytes]]:
    """Files of two leaves below one inner child of the root, one of them occupied."""
    head = "# Octomap OcTree{} file\nid OcTree\nsize 4\nres 0.001\ndata\n"
    binary = struct.pack("<HH", 0b11, 0b0110)  # child 0 is inner; its child 0 occupied, 1 free
    rows = [(0.0, 1), (0.0, 3), (2.0, 0), (-1.0, 0)]
    yield "tree.bt", head.format(" binary").encode() + binary
    yield "tree.ot", head.format("").encode() + b"".join(struct.pack("<fB", *row) for row in rows)


def clouds() -> Iterator[tuple[str, bytes]]:
    """The same two points in each encoding of PCD and PLY."""
    points = np.array([[0, 0, 0], [1, -2, 0.5]], dtype="<f4")
    head = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
    head += "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA "
    text = b"0 0 0\n1 -2 0.5\n"
    columns = points.T.tobytes()
    packed = bytes([len(columns) - 1]) + columns  # LZF: a literal
    sizes = struct.pack("<II", len(packed), len(columns))
    yield "ascii.pcd", f"{head}ascii\n".encode() + text
    yield "binary.pcd", f"{head}binary\n".encode() + points.tobytes()
    yield "packed.pcd", f"{head}binary_compressed\n".encode() + sizes + packed
    ply = [("vertex", 2, meshes.XYZ)]
    yield "text.ply", meshes.ply_header("ascii", ply) + text
    yield "cloud.ply", meshes.ply_header("binary_little_endian", ply) + points.tobytes()


def _clouds() -> Iterator[SmallFile]:
    for name, content in (*octrees(), *clouds()):
        yield SmallFile(name, content, Scenario.load)


def _archives() -> Iterator[SmallFile]:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.npz"

        def saved(save: Callable[[Path], object]) -> bytes:
            save(path)
            return path.read_bytes()

        plan = fgenv.plan("doorway", n=1, seed=3, method="composite")
        yield SmallFile("plan.npz", saved(plan.save), Plan.load)
        record = run_episode(Simulator("swap", n=2, autoreset=False), policy_of("goto"), steps=3)
        yield SmallFile("record.npz", saved(record.save), Record.load)
        cases = frozen("swap", cases=2, n=2)
        yield SmallFile("cases.npz", saved(cases.save), frozen)
    name, policy = min(included().items(), key=lambda item: item[1].stat().st_size)
    yield SmallFile(f"{name}.npz", policy.read_bytes(), PolicyFile.load)
    table = b"steps,success,robot_success,collision\n100,0.5,0.75,0.1\n200,1,1,0\n"
    yield SmallFile("evaluations.csv", table, evaluations)


@cache
def small_files() -> tuple[SmallFile, ...]:
    """A valid file of each reader."""
    return (*_meshes(), *_robots(), *_scenarios(), *_maps(), *_clouds(), *_archives())

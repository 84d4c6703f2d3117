"""Problems of OMPL.app (.cfg): a rigid robot among meshes, in SE(2) or SE(3).

OMPL.app reads meshes by Assimp, in whose frame y is up: a COLLADA file with z up is turned to
(x, z, -y), other files are not turned. The states of the robot are those of the mean of the robot's
vertices. In SE(3), the scenario is in the frame x, -z, y of the problem, with z up; in SE(2) it is
in the frame of the problem, whose x and y are the plane.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Literal

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision.mesh_files import read_mesh_file
from fgenv.scenarios.errors import Problem, ScenarioError, cut, near
from fgenv.scenarios.registry import file_format
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import Body, Model, RobotSpec, Workspace
from fgenv.scenarios.shapes.bodies import MeshFile, turned_up

from .grids import fail, number_in, read_lines

Entries = dict[str, tuple[str, int]]  # values and lines by key
Axes = Literal["z", "y", "-y", "x"]
PLANNING = ("objective", "objective.threshold")  # of the planner, not of the problem
NOT_SUPPORTED = {"control": "problems with controls are not supported"}
ENDS = [f"{end}.{part}" for end in ("start", "goal")
        for part in ("x", "y", "z", "theta", "axis.x", "axis.y", "axis.z")]  # fmt: skip
CORNERS = [f"volume.{end}.{axis}" for end in ("min", "max") for axis in "xyz"]
KEYS = ("name", "robot", "world", *ENDS, *CORNERS, *PLANNING, *NOT_SUPPORTED)


@file_format("OMPL.app problem", ".cfg")
def ompl_app(path: Path) -> Scenario:
    """A rigid robot among the meshes of an OMPL.app problem; its meshes are in the file's folder.

    The problem is in SE(3) if it has start.z, else in SE(2). The sections on planners and
    benchmarks, and the objective, do not change the problem.

    Raises:
        ScenarioError: unknown or missing keys, problems with controls, or missing meshes.
    """
    entries = read_cfg(path)
    spatial = "start.z" in entries
    robot, world = (mesh_of(path, entries, key, spatial) for key in ("robot", "world"))
    vertices = np.asarray(read_mesh_file(path.parent / robot.file).vertices)
    center = turned_up(vertices, robot.up).mean(axis=0)
    if not spatial:
        center[2] = 0.0
    robot = robot.model_copy(update={"origin": tuple(center.tolist())})
    low, high = (corner(path, entries, end, spatial) for end in ("min", "max"))
    ends = [state(path, entries, end, spatial) for end in ("start", "goal")]
    made = Scenario(
        version=1,
        name=entries["name"][0][:100] if "name" in entries else path.stem[:100],
        description="Problem of OMPL.app.",
        workspace=Workspace(low=low, high=high),
        shapes={"robot": robot, "world": world},
        models={"robot": Model(shape="robot", base="free" if spatial else "planar")},
        robots=(RobotSpec(name="robot", model="robot", start=ends[0], goal=ends[1]),),
        bodies=(Body(name="world", shape="world"),),
    )
    return made.at(path.parent)


def read_cfg(path: Path) -> Entries:
    """The entries of the section on the problem."""
    entries: Entries = {}
    problems: list[Problem] = []
    section = ""
    for i, line in enumerate(read_lines(path, 1 << 20), start=1):
        text = line.split("#")[0].strip()
        if text.startswith("["):
            section = text.strip("[] \t")
        elif section == "problem" and text:
            key, equals, value = (part.strip() for part in text.partition("="))
            if not equals or key not in KEYS:
                text = "is no known key" if equals else "has no ="
                problems.append(Problem(text, near(key, KEYS), cut(key, 60), i))
            elif key in NOT_SUPPORTED:
                problems.append(Problem("is not supported", NOT_SUPPORTED[key], key, i))
            elif key in entries:
                text = f"stands twice, first in line {entries[key][1]}"
                problems.append(Problem(text, "keep one", key, i))
            entries[key] = value, i
    spatial = "start.z" in entries
    axes = ("x", "y", "z") if spatial else ("x", "y")
    needed = ["robot", "world", *(f"volume.{end}.{a}" for end in ("min", "max") for a in axes)]
    angles = ("theta", "axis.x", "axis.y", "axis.z") if spatial else ("theta",)
    needed += [f"{end}.{part}" for end in ("start", "goal") for part in (*axes, *angles)]
    problems += [Problem("is missing", "add it", key) for key in needed if key not in entries]
    extra = [key for key in (*ENDS, *CORNERS) if key in entries and key not in needed]
    problems += [
        Problem("is of SE(3)", "add start.z, or remove it", key, entries[key][1]) for key in extra
    ]
    if problems:
        raise ScenarioError(path, problems)
    return entries


def mesh_of(path: Path, entries: Entries, key: str, spatial: bool) -> MeshFile:
    """The mesh of the robot or the world, turned to the scenario's frame."""
    name, line = entries[key]
    file = path.parent / name
    if not name or not file.is_file():
        fail(path, f"{key}: {cut(name, 60)!r} does not exist", "put it beside the file", line)
    up = read_mesh_file(file).up
    if up == "x":
        fail(path, f"{key}: {cut(name, 60)!r} has x up", "export it with y or z up", line)
    turned: dict[bool, Axes] = {True: "z", False: "y"} if spatial else {True: "-y", False: "z"}
    axes = turned[up == "z"]
    return MeshFile(kind="mesh", file=Path(os.path.relpath(file, path.parent)).as_posix(), up=axes)


def vector(path: Path, entries: Entries, prefix: str, axes: str) -> Floats:
    """The numbers of PREFIX.x, PREFIX.y and so on."""
    values = [entries[f"{prefix}.{axis}"] for axis in axes]
    return np.array([number_in(path, text, line) for text, line in values])


def corner(path: Path, entries: Entries, end: str, spatial: bool) -> tuple[float, ...]:
    """A corner of the workspace."""
    if not spatial:
        return tuple(vector(path, entries, f"volume.{end}", "xy").tolist())
    other = "max" if end == "min" else "min"
    x, _, y_up = vector(path, entries, f"volume.{end}", "xzy").tolist()
    z = float(vector(path, entries, f"volume.{other}", "z")[0])  # it changes its sign
    return (x, -z, y_up)


def state(path: Path, entries: Entries, end: str, spatial: bool) -> tuple[float, ...]:
    """A configuration of the robot."""
    text, line = entries[f"{end}.theta"]
    angle = number_in(path, text, line)
    if not spatial:
        return (*vector(path, entries, end, "xy").tolist(), angle)
    x, y, z = vector(path, entries, end, "xyz").tolist()
    axis = vector(path, entries, f"{end}.axis", "xyz")
    length = math.sqrt(float(axis @ axis))
    if length < 1e-9:
        if angle != 0.0:
            fail(path, f"{end}.axis: has length 0", "expected an axis of rotation", line)
        axis, length = np.array([1.0, 0.0, 0.0]), 1.0
    a, b, c = (axis / length * math.sin(angle / 2)).tolist()
    return (x, -z, y, a, -c, b, math.cos(angle / 2))

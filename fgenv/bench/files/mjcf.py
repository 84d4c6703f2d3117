"""All MJCF files in pip packages: forward kinematics and geoms against MuJoCo."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.bench.common.records import Record
from fgenv.robots import Robot

from .meshes import files_with
from .robots import AGREES, REFUSED, SAMPLES, TOLERANCE, reason_of, results_of, value_of

# Reasons for which files are refused, and what each error says.
REASONS = {
    "part of another file": "got <mujocoinclude>|No such file|got no file",
    "a scene without a robot": "got no body",
    "several robots: root= is needed": "trees with joints",
    "MuJoCo does not compile it": "expected a model that MuJoCo compiles",
}


def bench_mjcf(quick: bool, progress: Any) -> Iterator[Record]:
    """Yield a row for each result: agreement, or a reason of refusal."""
    files = [item for item in files_with({".xml"}) if b"<mujoco" in item[1].read_bytes()]
    files = files[:: max(1, len(files) // 30)] if quick else files
    yield from results_of(files, compare_mjcf, REASONS, progress)


def compare_mjcf(path: Path) -> tuple[str, float]:
    """Load one file and compare poses of bodies and geoms with MuJoCo.

    Returns:
        AGREES, what differs, or the reason of refusal; the largest difference of poses.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            robot = Robot.load(path)
    except (ValueError, OSError) as error:
        return REFUSED + reason_of(str(error), REASONS), math.nan
    peer = Mujoco(path, robot)
    rng = np.random.default_rng(0)
    low, high = np.maximum(robot.lower, -3.0), np.minimum(robot.upper, 3.0)
    difference = 0.0
    for q in rng.uniform(low, np.maximum(low, high), (SAMPLES, robot.nq)):
        if robot.base == "free":
            q[3:7] /= np.linalg.norm(q[3:7])
        difference = max(difference, peer.difference(q))
    return AGREES if difference <= TOLERANCE else "poses differ", difference


class Mujoco:
    """The robot of the same file in MuJoCo, with the bodies that MuJoCo would merge."""

    def __init__(self, path: Path, robot: Robot) -> None:
        import mujoco

        spec = mujoco.MjSpec.from_file(str(path))
        spec.compiler.fusestatic = spec.compiler.discardvisual = False
        for geom in spec.geoms:
            geom.material = ""  # may be missing
        self.mujoco, self.robot, self.model = mujoco, robot, spec.compile()
        self.model.geom_sameframe[:] = 0  # else nearly equal frames are taken as equal
        self.data = mujoco.MjData(self.model)
        self.bodies = [self._id("BODY", link.name) for link in robot.links]  # 0 or -1: no body

    def difference(self, q: Floats) -> float:
        """Largest difference of poses of bodies, and of geoms that collide, at a configuration."""
        self._set_coordinates(q)
        self.mujoco.mj_kinematics(self.model, self.data)
        difference, data = 0.0, self.data
        for body, link, pose in zip(
            self.bodies, self.robot.links, self.robot.forward(q), strict=True
        ):
            if body <= 0:
                continue
            own = [pose, *(pose @ item.origin for item in link.shapes)]
            expected = [matrix(data.xpos[body], data.xmat[body])]
            expected += [matrix(data.geom_xpos[g], data.geom_xmat[g]) for g in self._geoms(body)]
            if len(own) != len(expected):
                return math.inf
            difference = max(difference, float(np.abs(np.array(own) - expected).max()))
        return difference

    def _id(self, kind: str, name: str) -> int:
        """Number of a body or joint; without a name in the file, its name has the number."""
        found = self.mujoco.mj_name2id(
            self.model, getattr(self.mujoco.mjtObj, f"mjOBJ_{kind}"), name
        )
        unnamed = name.removeprefix(kind.lower())
        return int(unnamed) if found < 0 and unnamed.isdecimal() else int(found)

    def _geoms(self, body: int) -> list[int]:
        """Geoms of a body that collide."""
        first, count = int(self.model.body_geomadr[body]), int(self.model.body_geomnum[body])
        masks = self.model.geom_contype | self.model.geom_conaffinity
        return [geom for geom in range(first, first + count) if masks[geom]]

    def _set_coordinates(self, q: Floats) -> None:
        model, qpos, start = self.model, self.data.qpos, 0
        qpos[:] = model.qpos0
        if self.robot.base == "free":
            start = 7
            at = model.jnt_qposadr[model.body_jntadr[self.bodies[0]]]
            qpos[at : at + 7] = [*q[:3], q[6], *q[3:6]]
        values = dict(zip(self.robot.coordinates[start:], q[start:].tolist(), strict=True))
        joints = {joint.name: joint for joint in self.robot.joints}
        for joint in filter(lambda j: j.moves, self.robot.joints):
            qpos[model.jnt_qposadr[self._id("JOINT", joint.name)]] = value_of(joint, joints, values)


def matrix(position: Floats, rotation: Floats) -> Floats:
    """A pose (4, 4)."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation.reshape(3, 3), position
    return pose

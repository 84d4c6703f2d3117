"""Robots for the tests: random trees, and URDF files inside packages that pip installs."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from fgenv.arrays import Floats
from fgenv.bench.common.meshes import folder
from fgenv.robots import Joint, Link, LinkShape, Mimic, Robot
from fgenv.robots.primitives import box

URDFS = (
    "panda_description/urdf/panda.urdf",  # a gripper with mimic joints
    "ur_description/urdf/ur5_robot.urdf",
    "kinova_description/robots/kinova.urdf",  # continuous joints
    "z1_description/urdf/z1.urdf",
    "xarm_description/urdf/xarm7.urdf",
    "tiago_description/robots/tiago_no_hand.urdf",  # prismatic
    "baxter_description/urdf/baxter.urdf",
    "pr2_description/urdf/pr2.urdf",
    "go2_description/urdf/go2.urdf",
    "laikago_description/urdf/laikago.urdf",
    "talos_data/robots/talos_reduced.urdf",
    "allegro_hand_description/urdf/allegro_right_hand.urdf",
    "double_pendulum_description/urdf/double_pendulum_continuous.urdf",
    "icub_description/robots/icub_reduced.urdf",
    "so_arm_description/urdf/so100.urdf",
)


BOX = box((0.1, 0.2, 0.3))
ROOM = {
    "fixed": None,
    "planar": np.array([[-2.0] * 2, [2.0] * 2]),
    "free": np.array([[-2.0] * 3, [2.0] * 3]),
}


def urdf(path: str) -> Path:
    """The whole path of one of `URDFS`."""
    return folder("example-robot-data") / path


@cache
def real(path: str) -> Robot:
    """One of `URDFS`, cached."""
    return Robot.load(urdf(path))


def turn(rng: np.random.Generator) -> Floats:
    """A random rotation (3, 3)."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    out: Floats = q * np.sign(np.linalg.det(q))
    return out


def place(rng: np.random.Generator, reach: float = 0.5) -> Floats:
    """A random pose (4, 4)."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn(rng), rng.uniform(-reach, reach, 3)
    return pose


def random_tree(rng: np.random.Generator, base: str | None = None, most: int = 8) -> Robot:
    """A tree of random joints: some mimic others, some axes are parallel, some links have a box."""
    n = int(rng.integers(1, most))
    links = [
        Link(f"link{i}", [LinkShape(BOX, place(rng))] if rng.random() < 0.5 else ())
        for i in range(n)
    ]
    joints: list[Joint] = []
    for i in range(1, n):
        kind = str(rng.choice(["fixed", "revolute", "revolute", "continuous", "prismatic"]))
        own = [j.name for j in joints if j.moves and j.mimic is None and j.kind != "continuous"]
        mimic = None
        if own and kind in ("revolute", "prismatic") and rng.random() < 0.3:
            mimic = Mimic(str(rng.choice(own)), *rng.normal(size=2))
        origin = place(rng)
        if rng.random() < 0.4:
            origin[:3, :3] = np.eye(3)
        axis = np.eye(3)[rng.integers(3)] if rng.random() < 0.5 else rng.normal(size=3)
        parent = f"link{i - 1 if rng.random() < 0.7 else rng.integers(i)}"
        limits = (-2.0, 2.0) if kind != "prismatic" else (-0.4, 0.6)
        if mimic is not None:
            limits = (-np.inf, np.inf)  # those of the mimicked joint hold
        joints.append(
            Joint(f"joint{i}", kind, parent, f"link{i}", origin, axis, *limits, mimic=mimic)
        )
    base = base or str(rng.choice(["fixed", "planar", "free"]))
    order = rng.permutation(n)
    return Robot("tree", [links[i] for i in order], joints, base, place(rng), ROOM[base])

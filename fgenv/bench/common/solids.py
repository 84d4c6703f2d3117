"""Small solids with known collisions: (vertices, faces), meters, wound outward; and their poses."""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from fgenv.arrays import Floats
from fgenv.bench.common.poses import random_rotations

Solid = tuple[Floats, NDArray[np.int64]]


def box(x: float = 1.0, y: float | None = None, z: float | None = None) -> Solid:
    """A box around the origin with the given sides; a cube if there is one."""
    mesh = trimesh.creation.box((x, x if y is None else y, x if z is None else z))
    return np.array(mesh.vertices), np.array(mesh.faces)


def ball(radius: float = 1.0, subdivisions: int = 2) -> Solid:
    """An inscribed icosphere around the origin."""
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    return np.array(mesh.vertices), np.array(mesh.faces)


def prism(outline: list[tuple[float, float]], triangles: list[list[int]], height: float) -> Solid:
    """An outline (counter-clockwise, with its triangles) drawn up from z = 0 to `height`."""
    n = len(outline)
    flat = np.array(outline)
    vertices = np.vstack([np.c_[flat, np.zeros(n)], np.c_[flat, np.full(n, height)]])
    cap = np.array(triangles)
    sides = [[i, (i + 1) % n, n + (i + 1) % n] for i in range(n)]
    sides += [[i, n + (i + 1) % n, n + i] for i in range(n)]
    return vertices, np.vstack([cap[:, ::-1], cap + n, sides])


def angle_iron(arm: float = 1.0, thickness: float = 0.25, height: float = 1.0) -> Solid:
    """An L with its inner corner at (thickness, thickness)."""
    t = thickness
    outline = [(0.0, 0.0), (arm, 0.0), (arm, t), (t, t), (t, arm), (0.0, arm)]
    return prism(outline, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]], height)


def bowl(radius: float = 1.0, wall: float = 0.1, sections: int = 32) -> Solid:
    """A cylindrical pot, open at the top (z = radius), floor at z = 0."""
    inner = radius - wall
    profile = [(0, 0), (radius, 0), (radius, radius), (inner, radius), (inner, wall), (0, wall)]
    mesh = trimesh.creation.revolve(np.array(profile, float), sections=sections)
    return np.array(mesh.vertices), np.array(mesh.faces)


def inverted(solid: Solid) -> Solid:
    """The same surface, wound inward."""
    return solid[0], solid[1][:, ::-1]


def moved(solid: Solid, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Solid:
    """The solid, moved in its own frame."""
    return solid[0] + np.array([x, y, z]), solid[1]


def scaled(solid: Solid, factor: float) -> Solid:
    """The solid, times `factor`."""
    return solid[0] * factor, solid[1]


def together(*solids: Solid) -> Solid:
    """Several shells as one mesh."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in solids[:-1]])
    faces = [faces + start for (_, faces), start in zip(solids, starts, strict=True)]
    return np.vstack([vertices for vertices, _ in solids]), np.vstack(faces)


def opened(solid: Solid, count: int = 2) -> Solid:
    """The solid without its last `count` faces: a surface with a border."""
    return solid[0], solid[1][:-count]


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Floats:
    """The pose that moves by (x, y, z)."""
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def turned(angle: float, axis: tuple[float, float, float] = (0.0, 0.0, 1.0)) -> Floats:
    """The pose that turns by `angle` about an axis through the origin."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec(angle * np.array(axis) / np.linalg.norm(axis)).as_matrix()
    return pose


def somewhere(rng: np.random.Generator, reach: float = 1.0) -> Floats:
    """A pose turned at random, within about `reach` meters."""
    pose = at(*rng.normal(size=3) * reach)
    pose[:3, :3] = random_rotations(rng, 1)[0]
    return pose

"""Seeded random poses of one body beside another, 30 to 50 % of them colliding, many near contact.

A body that slides along a random direction has a place where it comes free. The poses lie around
that place, at log-uniform distances over several decades of the size.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats, Indices, Poses
from fgenv.bench.common.meshes import Mesh

Verdict = Callable[[Poses], bool]  # of one pose (4, 4)
Verdicts = Callable[[Poses], NDArray[np.bool_]]  # (n, 4, 4) -> (n,)

ALL = slice(None)
INSIDE = 0.42  # share of poses on the near side of the place where the body comes free
USUAL = (-2.0, 0.0)  # decades of the distance from that place, in sizes of the smaller body
NEAR = (-7.0, -1.0)


def one_by_one(collide: Callable[[Poses], bool]) -> Callable[[Poses], NDArray[np.bool_]]:
    """A batch for a library that has none: a Python loop."""

    def collide_all(poses: Poses) -> NDArray[np.bool_]:
        return np.fromiter((collide(pose) for pose in poses), np.bool_, len(poses))

    return collide_all


def random_rotations(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    """Uniform rotations (count, 3, 3), by the quaternion of four normal deviates."""
    w, x, y, z = (q := rng.normal(size=(4, count))) / np.linalg.norm(q, axis=0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def random_directions(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    """Uniform unit vectors (count, 3)."""
    v = rng.normal(size=(count, 3))
    return np.asarray(v / np.linalg.norm(v, axis=1, keepdims=True))


def surface_points(rng: np.random.Generator, mesh: Mesh, count: int) -> NDArray[np.float64]:
    """Points (count, 3) spread evenly over the area of `mesh`, body frame."""
    corners = mesh.vertices[mesh.faces]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    face = rng.choice(len(area), size=count, p=area / area.sum())
    weights = rng.dirichlet((1.0, 1.0, 1.0), size=count)
    return np.asarray(np.einsum("nk,nkj->nj", weights, corners[face]))


def random_poses(
    a: Mesh,
    b: Mesh,
    pose_a: Poses,
    count: int,
    collides: Verdict,
    rng: np.random.Generator,
    decades: tuple[float, float] = USUAL,
) -> Poses:
    """As `random_poses_batched`, with a checker that takes one pose (4, 4) at a time."""
    return random_poses_batched(a, b, pose_a, count, one_by_one(collides), rng, decades)


def random_poses_batched(
    a: Mesh,
    b: Mesh,
    pose_a: Poses,
    count: int,
    collides: Verdicts,
    rng: np.random.Generator,
    decades: tuple[float, float] = USUAL,
) -> Poses:
    """Poses (count, 4, 4) of `b` in the world, with `a` at `pose_a` (4, 4).

    `collides(poses_b)` is any checker of the pair; it only decides where the poses lie.
    Half of them start with the centers together (whole bodies meet from outside), half with a
    point of one surface on a point of the other (so that every concavity is visited).
    `decades` are the exponents of ten between which the distance from contact lies, in sizes.
    """
    size = min(a.size, b.size)
    turn, along = random_rotations(rng, count), random_directions(rng, count)
    start_a, start_b = surface_points(rng, a, count), surface_points(rng, b, count)
    half = count // 2 if a.size < 3.0 * b.size else 0  # a scene is met at its surfaces only
    start_a[:half], start_b[:half] = (m.vertices.mean(axis=0) for m in (a, b))
    inside = rng.random(count) < INSIDE
    gap = size * 10.0 ** rng.uniform(*decades, size=count)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = turn
    poses[:, :3, 3] = start_a - np.einsum("nij,nj->ni", turn, start_b)
    poses = pose_a @ poses
    along = along @ pose_a[:3, :3].T
    slide = _Slide(poses, along, collides)
    placed = slide.at(slide.place(0.02 * size, gap, inside))
    return np.asarray(rng.permutation(placed))


class _Slide:
    """Bodies that slide from poses `start` (n, 4, 4) along `direction` (n, 3)."""

    def __init__(self, start: Poses, direction: NDArray[np.float64], collides: Verdicts) -> None:
        self.start, self.direction, self.collides = start, direction, collides

    def at(self, distance: Floats, rows: Indices | slice = ALL) -> Poses:
        """The poses of `rows` after `distance` (k,) meters."""
        poses = self.start[rows].copy()
        poses[:, :3, 3] += self.direction[rows] * distance[:, None]
        return poses

    def hit(self, distance: Floats, rows: Indices) -> NDArray[np.bool_]:
        """Whether the bodies of `rows` collide after `distance` (k,) meters."""
        return self.collides(self.at(distance, rows)) if len(rows) else np.zeros(0, np.bool_)

    def place(self, step: float, offset: Floats, near: NDArray[np.bool_]) -> Floats:
        """The distances `offset` before (`near`) or behind those where the bodies come free."""
        low, high = self.bracket(step)
        rows = np.flatnonzero(high - low > 0.1 * offset)
        while len(rows):
            middle = 0.5 * (low[rows] + high[rows])
            met = self.hit(middle, rows)
            low[rows[met]], high[rows[~met]] = middle[met], middle[~met]
            rows = rows[high[rows] - low[rows] > 0.1 * offset[rows]]
        inner = np.maximum(low - offset, 0.0)
        rows = np.flatnonzero(near)
        beyond = rows[~self.hit(inner[rows], rows)]
        inner[beyond] = low[beyond]  # a thin wall lies behind already
        return np.where(near, inner, high + offset)

    def bracket(self, step: float) -> tuple[Floats, Floats]:
        """Two distances each, colliding and free; twice the same where nothing is met."""
        low, width = np.zeros(len(self.start)), np.full(len(self.start), step)
        lost = np.arange(len(self.start))
        for turn in range(60):  # centers of hollow bodies lie free: look for the wall
            low[lost] = turn * step
            lost = lost[~self.hit(low[lost], lost)]
        width[lost] = 0.0
        rows = np.flatnonzero(width)
        while len(rows := rows[self.hit(low[rows] + width[rows], rows)]):
            low[rows] += width[rows]
            width[rows] *= 2.0
        return low, low + width

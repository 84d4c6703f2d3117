"""Worst times of hard inputs: flush slides, nearly coincident faces, grazing rays."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import trimesh

from fgenv.arrays import Floats
from fgenv.bench.common.poses import random_rotations
from fgenv.bench.common.records import Record
from fgenv.bench.common.timing import timed
from fgenv.collision import Shape, World, distance

GAPS = (1e-4, 1e-7, 1e-9, 1e-11, 1e-13)  # m
APART = 0.32  # m; of the shapes with nearly coincident faces
JITTER = 1e-9  # m


def lifted(x: float, z: float, angle: float = 0.0) -> Floats:
    """Pose at (x, 0, z), turned about z."""
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    pose[[0, 2], 3] = x, z
    return pose


def flush_slides(rng: np.random.Generator) -> Iterator[tuple[str, Callable[[], object]]]:
    """Yield motions of a box that slides and turns on another one, one per gap."""
    box = trimesh.creation.box((1, 1, 1))
    shape = Shape(box.vertices, box.faces)
    for gap in GAPS:
        world = World()
        world.add(shape, np.eye(4))
        start, end = lifted(-0.5, 1 + gap), lifted(0.5, 1 + gap, float(rng.uniform(1, 3)))
        part = world.add(shape, start)
        yield (
            f"gap {gap:g} m",
            lambda w=world, p=part, s=start, e=end: w.check_motion(p, s, e),  # type: ignore[misc]
        )


def triangle_soup(name: str, count: int, rng: np.random.Generator) -> Floats:
    """Vertices (count, 3, 3) of triangles that nearly coincide or overlap in one plane."""
    if name == "copies":
        corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
        return corner + rng.normal(0, JITTER, (count, 3, 3))
    if name == "coplanar":
        return np.concatenate([rng.random((count, 3, 2)), np.zeros((count, 3, 1))], axis=2)
    ends = rng.normal(size=(count, 1, 3)) * [1, 1e-6, 1e-6]
    return np.concatenate([-ends, ends, ends + rng.normal(0, 1e-6, (count, 1, 3))], axis=1)


def near_coincident(
    count: int, rng: np.random.Generator
) -> Iterator[tuple[str, Callable[[], object]]]:
    """Yield distances between a shape and itself, one per kind of triangles."""
    away = np.eye(4)
    away[2, 3] = APART
    for name in ("copies", "coplanar", "needles"):
        vertices = triangle_soup(name, count, rng).reshape(-1, 3)
        shape = Shape(vertices, np.arange(len(vertices)).reshape(-1, 3))
        yield f"{count} {name}", lambda s=shape: distance(s, np.eye(4), s, away)  # type: ignore[misc]


def grazing_rays(rng: np.random.Generator) -> Iterator[tuple[str, Callable[[], object]]]:
    """Yield rays through the vertices of a sphere, from random directions."""
    ball = trimesh.creation.icosphere(subdivisions=4)
    shape = Shape(ball.vertices, ball.faces)
    directions = random_rotations(rng, len(ball.vertices))[:, 0]
    origins = ball.vertices - 3 * directions
    yield f"{len(origins)} rays", lambda: shape.raycast(origins, directions, threads=1)


def bench_limits(*, count: int = 20_000, rounds: int = 3, seed: int = 0) -> Iterator[Record]:
    """Yield one record per input: its kind, its name, the worst time in seconds."""
    rng = np.random.default_rng(seed)
    kinds = {
        "flush slide": flush_slides(rng),
        "near-coincident faces": near_coincident(count, rng),
        "grazing rays": grazing_rays(rng),
    }
    for kind, jobs in kinds.items():
        for name, job in jobs:
            yield {"kind": kind, "name": name, "worst": max(timed(job) for _ in range(rounds))}

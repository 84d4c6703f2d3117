"""Meshes of the planning puzzles: twisted bars and channels, bug traps, rings. Meters.

Each is one closed shell. Sines come from the native core: the same mesh on every machine.
"""

from __future__ import annotations

import math

import numpy as np
import trimesh
from numpy.typing import ArrayLike

from fgenv import _core
from fgenv.arrays import Faces, Floats
from fgenv.robots import primitives
from fgenv.scenarios.rng import sin_cos

from .vehicles import circle

STEPS = 12  # sections of a twisted body
SIDES = 20  # of a bug trap about its axis
BENDS, ROUND = 28, 8  # pieces of a ring along its bar, and sides of the bar
RIM = math.pi / 3  # elevation of a bug trap's rim, rad


def sides(rings: int, n: int) -> Faces:
    """Faces between rings of n points each, counter-clockwise seen from ahead, one after another.

    The interior of the rings is the interior of the faces.
    """
    here, there = np.arange(n), np.roll(np.arange(n), -1)
    one = [np.column_stack([here, there, there + n]), np.column_stack([here, there + n, here + n])]
    return np.concatenate([np.vstack(one) + k * n for k in range(rings - 1)])


def skinned(rings: ArrayLike) -> trimesh.Trimesh:
    """The closed mesh over rings (k, n, 3) of convex outlines, as `sides` wants them."""
    points = np.asarray(rings, dtype=np.float64)
    k, n = points.shape[:2]
    fan = np.arange(1, n - 1)
    back = np.column_stack([0 * fan, fan + 1, fan])
    front = np.column_stack([0 * fan, fan, fan + 1]) + (k - 1) * n
    faces = np.vstack([sides(k, n), back, front])
    return trimesh.Trimesh(points.reshape(-1, 3), faces, process=False)


def section(x: float, width: float, height: float, angle: float) -> Floats:
    """A rectangle (4, 3) across x, turned about x (rad), counter-clockwise seen from +x."""
    sine, cosine = sin_cos(angle)
    y = 0.5 * width * np.array([-1.0, 1.0, 1.0, -1.0])
    z = 0.5 * height * np.array([-1.0, -1.0, 1.0, 1.0])
    return np.column_stack([np.full(4, x), cosine * y - sine * z, sine * y + cosine * z])


def twisted_bar(length: float, width: float, height: float, turn: float) -> trimesh.Trimesh:
    """See `TwistedBar`; 100 faces."""
    part = np.arange(STEPS + 1) / STEPS - 0.5
    return skinned([section(t * length, width, height, t * turn) for t in part.tolist()])


def twisted_wall(
    thickness: float, side: float, width: float, height: float, turn: float
) -> trimesh.Trimesh:
    """See `TwistedWall`; 120 faces."""
    part = np.arange(STEPS + 1) / STEPS
    inner = [section((t - 0.5) * thickness, width, height, t * turn) for t in part.tolist()]
    outer = [section(x, side, side, 0.0) for x in (-thickness / 2, thickness / 2)]
    points, n = np.concatenate([*inner, *outer]), 4 * (STEPS + 1)  # n of the channel
    corner = np.arange(4)
    first = round(turn / (math.pi / 2))  # corner k of the wall's +x face is near corner k - first
    back = between(points, corner, n + corner)
    front = between(points, n + 4 + corner, n - 4 + (corner - first) % 4)
    faces = [sides(STEPS + 1, 4)[:, ::-1], n + sides(2, 4), back, front]
    return trimesh.Trimesh(points, np.concatenate(faces), process=False)


def between(points: Floats, left: Faces, right: Faces) -> Faces:
    """Faces across x between two outlines (n,) of places in points, one inside the other.

    Both go the same way around. Each four-sided piece is cut where both parts keep its sense.
    """
    y, z = points[:, 1], points[:, 2]
    faces: list[tuple[int, int, int]] = []
    for k in range(len(left)):
        a, b, c, d = left[k - 1], left[k], right[k], right[k - 1]
        cuts = ((a, b, c), (a, c, d)), ((a, b, d), (b, c, d))
        areas = [
            [(y[q] - y[p]) * (z[r] - z[p]) - (z[q] - z[p]) * (y[r] - y[p]) for p, q, r in cut]
            for cut in cuts
        ]
        faces += cuts[0] if abs(sum(map(np.sign, areas[0]))) == 2 else cuts[1]
    return np.array(faces)


def revolved(outline: ArrayLike, count: int) -> trimesh.Trimesh:
    """A closed solid about z from radii and heights (n, 2), both ends on the axis.

    The interior lies to the left of the outline, with the radius to the right and the height up.
    """
    profile = np.asarray(outline, dtype=np.float64)
    rings = [np.column_stack([r * circle(1.0, count), np.full(count, z)]) for r, z in profile[1:-1]]
    n = count * len(rings)
    here, there = np.arange(count), np.roll(np.arange(count), -1)
    first = np.column_stack([there, here, np.full(count, n)])
    last = np.column_stack([here, there, np.full(count, n + 1)]) + (n - count, n - count, 0)
    points = np.vstack([*rings, [[0, 0, profile[0, 1]], [0, 0, profile[-1, 1]]]])
    faces = np.vstack([sides(len(rings), count), first, last])
    return trimesh.Trimesh(points, faces, process=False)


def bug_trap(radius: float, wall: float, throat: float) -> trimesh.Trimesh:
    """See `BugTrap`; the throat is a tenth of the radius above the middle."""
    sines, cosines = _core.sin_cos(np.linspace(-math.pi / 2, RIM, 10))
    outer = radius * np.column_stack([cosines, sines])
    sines, cosines = _core.sin_cos(np.linspace(RIM - 0.15, -math.pi / 2, 10))
    inner = (radius - wall) * np.column_stack([cosines, sines])
    outer[0, 0] = inner[-1, 0] = 0.0
    tip = [(throat, 0.1 * radius), (throat + wall, 0.1 * radius)]
    return revolved([*outer, *tip, *inner], SIDES)


def open_ring(radius: float, thickness: float, turn: float, rise: float) -> trimesh.Trimesh:
    """See `OpenRing`; 460 faces."""
    around = circle(thickness / 2, ROUND)
    angles = turn * (np.arange(BENDS + 1) / BENDS - 0.5)
    sines, cosines = _core.sin_cos(math.pi + angles)
    out = radius - around[:, 0]  # the bar goes on to the left: x of its outline is inwards
    rings = [
        np.column_stack([c * out, s * out, z + around[:, 1]])
        for s, c, z in zip(sines, cosines, rise * angles / (2 * math.pi), strict=True)
    ]
    return skinned(rings)


def cone(radius: float, height: float) -> trimesh.Trimesh:
    """See `Cone`: a pyramid around it."""
    base, _ = primitives.cylinder(radius, height)
    ring = base.vertices[: len(base.vertices) // 2]
    n = len(ring)
    here, there, fan = np.arange(n), np.roll(np.arange(n), -1), np.arange(1, n - 1)
    sloped = np.column_stack([here, there, np.full(n, n)])
    below = np.column_stack([0 * fan, fan + 1, fan])
    points = np.vstack([ring, [[0.0, 0.0, height / 2]]])
    return trimesh.Trimesh(points, np.vstack([sloped, below]), process=False)

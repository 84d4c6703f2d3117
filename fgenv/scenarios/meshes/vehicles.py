"""Meshes of robots and obstacles in the built-in scenarios. Meters, x forward, z up.

Sines come from the native core: the same mesh on every machine. Each stands on the floor at its
origin, except the drone, which has its origin in the middle. Some have several closed shells.
"""

from __future__ import annotations

import math

import numpy as np
import trimesh
from numpy.typing import ArrayLike

from fgenv import _core

from .three_tanks import block, joined, prism


def circle(radius: float, sides: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Corners (sides, 2) on a circle, counter-clockwise."""
    sines, cosines = _core.sin_cos(2 * math.pi / sides * (np.arange(sides) + 0.5))
    return np.column_stack([radius * cosines, radius * sines])


def drum(radius: float, bottom: float, top: float, sides: int = 24) -> trimesh.Trimesh:
    """An upright prism inside a cylinder about z."""
    return prism(circle(radius, sides), bottom, top)


def cone(radius: float, bottom: float, top: float, sides: int = 12) -> trimesh.Trimesh:
    """A cone about z, closed."""
    ring = np.column_stack([circle(radius, sides), np.full(sides, bottom)])
    here, there = np.arange(sides), np.roll(np.arange(sides), -1)
    sides_up = np.column_stack([here, there, np.full(sides, sides)])
    below = np.column_stack([there, here, np.full(sides, sides + 1)])
    vertices = np.vstack([ring, [[0, 0, top], [0, 0, bottom]]])
    return trimesh.Trimesh(vertices, np.vstack([sides_up, below]), process=False)


def sideways(outline: ArrayLike, right: float, left: float) -> trimesh.Trimesh:
    """A prism over a convex outline (n, 2) in x and z, counter-clockwise, from y to y."""
    mesh = prism(outline, right, left)
    return trimesh.Trimesh(mesh.vertices[:, [0, 2, 1]], mesh.faces[:, ::-1], process=False)


def wheel(x: float, y: float, radius: float, width: float) -> trimesh.Trimesh:
    """A wheel that stands on the floor, its axle along y."""
    return sideways(circle(radius, 16) + (x, radius), y - width / 2, y + width / 2)


def angle_iron(length: float, width: float, arm: float, height: float) -> trimesh.Trimesh:
    """An L seen from above, one mesh: the middle of its box at the origin, the corner at -x, -y."""
    x, y, a = length / 2, width / 2, arm
    outline = [(a - x, a - y), (a - x, y), (-x, y), (-x, -y), (x, -y), (x, a - y)]
    return prism(outline, 0.0, height)  # the fan begins at the inner corner, which sees all


def cart(length: float, width: float, height: float) -> trimesh.Trimesh:
    """A low transport robot: chassis, lifting plate, two wheels in the middle."""
    x, y, h = length / 2, width / 2, height
    parts = [
        block((-x, -y, 0.12 * h), (x, y, 0.75 * h), chamfer=0.2 * width),
        block((-0.75 * x, -0.75 * y, 0.7 * h), (0.75 * x, 0.75 * y, 0.88 * h), chamfer=0.1 * width),
        drum(0.5 * y, 0.85 * h, h),
    ]
    for side in (-1, 1):
        parts.append(wheel(0.0, 0.86 * side * y, 0.36 * h, 0.2 * y))
    return joined(parts)


def car(length: float, width: float, height: float) -> trimesh.Trimesh:
    """A small car, the origin in the middle of the rear axle; the axles are 0.6 length apart."""
    x0, y, h = -0.2 * length, width / 2, height
    low, belt, r = 0.16 * h, 0.55 * h, 0.22 * h
    at = [(0, low), (1, low), (1, 0.42 * h), (0.97, belt), (0.03, belt), (0, 0.48 * h)]
    roof = [(0.1, belt), (0.72, belt), (0.56, h), (0.2, h)]
    scaled = [[(x0 + length * u, z) for u, z in outline] for outline in (at, roof)]
    parts = [sideways(scaled[0], -y, y), sideways(scaled[1], -0.88 * y, 0.88 * y)]
    for x in (0.0, 0.6 * length):
        parts += [wheel(x, 0.86 * side * y, r, 0.24 * y) for side in (-1, 1)]
    return joined(parts)


def shelf(length: float, depth: float, height: float, clear: float, levels: int) -> trimesh.Trimesh:
    """A rack on four legs: boards, `clear` meters of room under the lowest; truly concave."""
    x, y, post, board = length / 2, depth / 2, 0.03 * height, 0.02 * height
    inner = x - post, y - post
    legs = [
        block((sx * inner[0] - post, sy * inner[1] - post, 0.0),
              (sx * inner[0] + post, sy * inner[1] + post, height))
        for sx in (-1, 1) for sy in (-1, 1)
    ]  # fmt: skip
    rise = (height - clear) / levels
    boards = [
        block((-x, -y, clear + k * rise), (x, y, clear + k * rise + board)) for k in range(levels)
    ]
    return joined([*legs, *boards])


def tree(radius: float, height: float, crown: float) -> trimesh.Trimesh:
    """A conifer: a trunk of that radius, and three cones as wide as `crown` at the lowest."""
    parts = [drum(radius, 0.0, 0.9 * height, 10)]
    for bottom, top, wide in ((0.3, 0.7, 1.0), (0.5, 0.87, 0.8), (0.7, 1.0, 0.55)):
        parts.append(cone(wide * crown, bottom * height, top * height))
    return joined(parts)


def drone(span: float, height: float) -> trimesh.Trimesh:
    """A quadcopter as wide as `span` over its rotors, which leave room between them."""
    h, rotor = height / 2, 0.2 * span
    at = 0.5 * span - rotor
    body = block((-0.16 * span, -0.12 * span, -h), (0.16 * span, 0.12 * span, 0.6 * h), 0.05 * span)
    parts = [body]
    for sx in (-1, 1):
        for sy in (-1, 1):
            way, side = np.array([sx, sy]) * at, np.array([-sy, sx]) * 0.03 * span
            beam = [-side, way - side, way + side, side]
            parts.append(prism(beam, 0.1 * h, 0.5 * h))
            hub = prism(circle(0.05 * span, 8) + way, 0.0, 0.9 * h)
            parts += [hub, prism(circle(rotor, 20) + way, 0.7 * h, h)]
    return joined(parts)

"""The meshes of the published scene: a mobile robot with a fork, and tanks on legs.

Each is one mesh of several closed shells that overlap, as people export them from CAD.
"""

from collections.abc import Sequence

import numpy as np
import trimesh
from numpy.typing import ArrayLike
from trimesh.transformations import rotation_matrix, translation_matrix

X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def lathe(profile: ArrayLike, sections: int) -> trimesh.Trimesh:
    """A solid of revolution about z from a profile (n, 2) of radius and height, bottom to top."""
    outline = np.asarray(profile, dtype=np.float64)
    mesh: trimesh.Trimesh = trimesh.creation.revolve(outline, sections=sections)
    return mesh


def block(low: ArrayLike, high: ArrayLike, chamfer: float = 0.0) -> trimesh.Trimesh:
    """A box between two corners (m), its upright edges chamfered."""
    (x0, y0, z0), (x1, y1, z1) = np.asarray(low, float), np.asarray(high, float)
    c = chamfer
    outline = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    if chamfer > 0.0:
        outline = [(x0 + c, y0), (x1 - c, y0), (x1, y0 + c), (x1, y1 - c)]
        outline += [(x1 - c, y1), (x0 + c, y1), (x0, y1 - c), (x0, y0 + c)]
    return prism(outline, z0, z1)


def prism(outline: ArrayLike, bottom: float, top: float) -> trimesh.Trimesh:
    """An upright prism over a convex outline (n, 2), counter-clockwise, between two heights."""
    xy = np.asarray(outline, dtype=np.float64)
    n = len(xy)
    here, there, fan = np.arange(n), (np.arange(n) + 1) % n, np.arange(1, n - 1)
    faces = [
        np.column_stack([here, there, there + n]),
        np.column_stack([here, there + n, here + n]),
        np.column_stack([np.zeros_like(fan), fan + 1, fan]),
        np.column_stack([np.zeros_like(fan), fan, fan + 1]) + n,
    ]
    rings = [np.column_stack([xy, np.full(n, z)]) for z in (bottom, top)]
    return trimesh.Trimesh(np.concatenate(rings), np.concatenate(faces), process=False)


def joined(parts: Sequence[trimesh.Trimesh]) -> trimesh.Trimesh:
    """All parts as one mesh of several shells."""
    first = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [part.faces + start for part, start in zip(parts, first[:-1], strict=True)]
    vertices = np.concatenate([part.vertices for part in parts])
    return trimesh.Trimesh(vertices, np.concatenate(faces), process=False)


def placed(
    mesh: trimesh.Trimesh, at: ArrayLike, axis: ArrayLike = X, angle: float = 0.0
) -> trimesh.Trimesh:
    """The mesh turned by an angle (rad) about an axis through its origin, then moved (m)."""
    mesh.apply_transform(translation_matrix(at) @ rotation_matrix(angle, axis))
    return mesh


def wheel(radius: float, width: float) -> trimesh.Trimesh:
    """A wheel about z with chamfered rims and a hollow on both faces."""
    h, r = width / 2, radius
    half = [(0.0, 0.45 * h), (0.55 * r, 0.45 * h), (0.62 * r, h), (0.9 * r, h), (r, 0.6 * h)]
    return lathe([(x, -z) for x, z in half] + half[::-1], sections=32)


def mobile_robot() -> trimesh.Trimesh:
    """A mobile robot with a lifting fork, 1.1 m long, x forward, its origin on the floor."""
    parts = [
        block((-0.42, -0.24, 0.07), (0.36, 0.24, 0.27), chamfer=0.07),  # chassis
        block((-0.38, -0.20, 0.26), (0.20, 0.20, 0.36), chamfer=0.05),  # deck
        block((-0.34, -0.15, 0.35), (-0.02, 0.15, 0.58), chamfer=0.03),  # cabinet
        placed(lathe([(0, 0), (0.025, 0), (0.025, 0.2), (0, 0.2)], 20), (-0.18, 0.0, 0.57)),
        placed(lidar(), (-0.18, 0.0, 0.75)),
        block((0.26, -0.14, 1.02), (0.32, 0.14, 1.08)),  # cross beam of the mast
        block((0.31, -0.20, 0.58), (0.35, 0.20, 0.84)),  # fork carriage
    ]
    for side in (-1, 1):
        y = 0.13 * side
        parts += [
            block((0.25, y - 0.03, 0.25), (0.33, y + 0.03, 1.05)),  # mast rail
            block((0.34, y - 0.035, 0.60), (0.38, y + 0.035, 0.80)),  # fork heel
            block((0.34, y - 0.03, 0.59), (0.70, y + 0.03, 0.62)),  # tine
        ]
        for x in (-0.27, 0.22):
            parts.append(placed(wheel(0.12, 0.08), (x, 0.26 * side, 0.12), X, np.pi / 2))
    return joined(parts)


def lidar() -> trimesh.Trimesh:
    """The waisted drum of a laser scanner about z, 0.11 m high."""
    profile = [(0, 0), (0.06, 0), (0.065, 0.035), (0.05, 0.045), (0.05, 0.075), (0.065, 0.085)]
    return lathe([*profile, (0.06, 0.105), (0.03, 0.112), (0, 0.112)], sections=28)


def tank(radius: float, height: float, nozzle: float) -> trimesh.Trimesh:
    """An upright tank with dished ends on four legs, standing on the floor at its origin.

    `radius` and `height` in meters, `nozzle` the direction of its flanged nozzle (rad about z).
    """
    clear, dish = 0.16 * height, 0.3 * radius
    bend = np.linspace(0.0, np.pi / 2, 6)
    bottom = np.column_stack([radius * np.sin(bend), clear + dish * (1 - np.cos(bend))])
    shell = np.concatenate([bottom, (bottom * (1, -1) + (0, clear + height))[::-1]])
    parts = [lathe(shell, sections=56)]
    for angle in np.pi / 4 + np.pi / 2 * np.arange(4):
        x, y = 0.86 * radius * np.cos(angle), 0.86 * radius * np.sin(angle)
        leg = [(0, 0), (0.09, 0), (0.09, 0.02), (0.04, 0.03), (0.04, clear + 0.7 * dish)]
        parts.append(placed(lathe([*leg, (0, clear + 0.7 * dish)], 16), (x, y, 0.0)))
    outlet = placed(flange(0.12 * radius, 0.3 * radius), (0.0, 0.0, 0.0), Y, np.pi / 2)
    outlet.apply_translation((0.95 * radius, 0.0, clear + 0.3 * height))
    outlet.apply_transform(rotation_matrix(nozzle, (0, 0, 1)))
    manhole = placed(flange(0.3 * radius, 0.25 * radius), (0.0, 0.0, height - 0.1 * radius))
    return joined([*parts, outlet, manhole])


def flange(radius: float, length: float) -> trimesh.Trimesh:
    """A pipe stub with a flange at its end, closed, along z from 0 to `length`."""
    r, rim, n = radius, 1.5 * radius, length
    profile = [(0, 0), (r, 0), (r, 0.8 * n), (rim, 0.8 * n), (rim, n), (0.7 * r, n)]
    return lathe([*profile, (0.7 * r, 0.9 * n), (0, 0.9 * n)], sections=24)

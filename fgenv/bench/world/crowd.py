"""Bodies of one mesh that drift through a cube and turn, at the same density for any number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fgenv.arrays import Floats, Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import random_directions, random_rotations
from fgenv.bench.pairs.catalog import ROBOTS, Source

# Real, concave, watertight: a robot's castor and a leg. Volume over that of the hull: 0.46, 0.53.
MESHES = {
    188: Source(ROBOTS, "pr2_description/meshes/base_v0/caster_L.stl"),
    2240: Source(ROBOTS, "solo_description/meshes/stl/solo12/solo12_lower_leg_left_side.stl"),
}
SPACING = 1.25  # sizes of a body (diagonals): a cube of that side for each
DRIFT, TURN = 0.02, 0.05  # sizes and radians a step


@dataclass(frozen=True)
class Crowd:
    """Where n bodies start and how they move; `side` of the cube in meters."""

    side: float
    start: Floats  # (n, 3)
    drift: Floats  # (n, 3), meters a step
    turn: Poses  # (n, 3, 3) at the start
    axis: Floats  # (n, 3)

    def poses(self, step: int) -> Poses:
        """Poses (n, 4, 4) after so many steps; a body comes back at a wall of the cube."""
        there = (self.start + step * self.drift) % (2.0 * self.side)
        poses = np.tile(np.eye(4), (len(there), 1, 1))
        poses[:, :3, 3] = np.minimum(there, 2.0 * self.side - there)
        poses[:, :3, :3] = turned(self.axis, np.full(len(self.axis), step * TURN)) @ self.turn
        return poses

    @property
    def middle(self) -> Floats:
        """The middle of the cube."""
        return np.full(3, 0.5 * self.side)


def turned(axis: Floats, angle: Floats) -> Poses:
    """Rotations (n, 3, 3) about unit axes (n, 3) by angles (n,), by Rodrigues' formula."""
    cross = np.zeros((len(axis), 3, 3))
    x, y, z = axis.T
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross -= cross.swapaxes(1, 2)
    sin, versine = np.sin(angle)[:, None, None], (1.0 - np.cos(angle))[:, None, None]
    return np.asarray(np.eye(3) + sin * cross + versine * (cross @ cross))


def crowd(mesh: Mesh, count: int, rng: np.random.Generator) -> Crowd:
    """`count` bodies, spread evenly; those nearest to the middle of the cube come first.

    So the first n of a larger crowd fill a cube in its middle as densely as the whole one.
    """
    side = SPACING * mesh.size * count ** (1 / 3)
    start = rng.uniform(0.0, side, (count, 3))
    start = start[np.abs(start - 0.5 * side).max(axis=1).argsort()]
    drift = DRIFT * mesh.size * random_directions(rng, count)
    return Crowd(side, start, drift, random_rotations(rng, count), random_directions(rng, count))

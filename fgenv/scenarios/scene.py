"""A scene: a world of bodies, and one mover that has to get from a start to a goal."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.collision.world import Record
from fgenv.scenarios.se2 import as_poses

Configuration = tuple[float, float, float]  # x, y (m), yaw (rad)


@dataclass
class Scene:
    """`mover` is a body's id, `height` the z of its origin (m); all others stand."""

    name: str
    world: World
    mover: int
    start: Configuration
    goal: Configuration
    height: float = 0.0

    @property
    def records(self) -> list[Record]:
        """The records of all bodies, the mover's first."""
        others = [int(body) for body in self.world.ids if body != self.mover]
        return [self.world.record(body) for body in (self.mover, *others)]

    @property
    def masks(self) -> dict[str, int]:
        """The collision mask of each body by name, the mover's first."""
        return {record.name: record.mask for record in self.records}

    @property
    def straight_path(self) -> Floats:
        """The shortest path, (2, 3): start and goal."""
        return np.array([self.start, self.goal])

    def poses(self, configurations: ArrayLike) -> Floats:
        """The mover's poses (..., 4, 4) of configurations (..., 3)."""
        return as_poses(configurations, self.height)


def bounds(record: Record) -> Floats:
    """The axis-aligned box of a body where it stands, (2, 3) meters: least, greatest."""
    points = record.shape.vertices @ record.pose[:3, :3].T + record.pose[:3, 3]
    return np.stack([points.min(axis=0), points.max(axis=0)])


def in_contact(world: World, robot: int, pose: ArrayLike, margin: float = 0.0) -> list[str]:
    """The names of all bodies that `robot` would collide with at a pose (4, 4)."""
    there = world.copy()
    there.set_pose(robot, pose)
    pairs = there.contacts(margin=margin)
    met = pairs[(pairs == robot).any(axis=1)]
    return [world.record(int(body)).name for body in met[met != robot]]

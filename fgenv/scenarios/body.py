"""A body of a scene: the published record (id, name, position, mask, features) with a shape."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fgenv.collision import FeatureGraph, Shape
from fgenv.scenarios.planar import Floats, as_poses


@dataclass
class Body:
    """One object of the model list.

    `configuration` is x, y (m) and yaw (rad), `height` the z of its origin (m).
    `collision_mask` holds a bit for each mover whose motion box the body meets; a mover has a
    bit of its own in `own_bit`, a body that never moves has 0 there.
    """

    id: int
    name: str
    shape: Shape
    configuration: tuple[float, float, float] = (0.0, 0.0, 0.0)
    height: float = 0.0
    own_bit: int = 0
    collision_mask: int = 0

    @property
    def position(self) -> Floats:
        """Where the origin is, (3,) metres."""
        return np.array([*self.configuration[:2], self.height])

    @property
    def pose(self) -> Floats:
        """The pose, (4, 4)."""
        return as_poses(self.configuration, self.height)

    @property
    def bounds(self) -> Floats:
        """The axis-aligned box of the body where it stands, (2, 3) metres: least, greatest."""
        points = self.shape.vertices @ self.pose[:3, :3].T + self.pose[:3, 3]
        return np.stack([points.min(axis=0), points.max(axis=0)])

    @property
    def feature_points(self) -> NDArray[np.float64]:
        """The feature points in the body's frame, (n, 3) metres."""
        return np.asarray(self.shape.graph.points)

    @property
    def feature_graph(self) -> FeatureGraph:
        """The feature graph in the body's frame."""
        return self.shape.graph


@dataclass
class Scene:
    """A model list with one mover that has to get from `start` to `goal` (x, y, yaw each)."""

    name: str
    mover: Body
    obstacles: list[Body]
    start: tuple[float, float, float]
    goal: tuple[float, float, float]

    @property
    def bodies(self) -> list[Body]:
        """All bodies, the mover first."""
        return [self.mover, *self.obstacles]

    @property
    def straight_path(self) -> Floats:
        """The shortest path, (2, 3): start and goal."""
        return np.array([self.start, self.goal])

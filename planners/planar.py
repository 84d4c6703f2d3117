"""Planning for one rigid body that moves on the floor among bodies that stand."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.collision import Shape, collide
from fgenv.planners.rrt_connect import Plan, PlanningError, rrt_connect
from fgenv.scenarios import Body
from fgenv.scenarios.planar import Floats, as_poses, reach


class PlanarChecker:
    """State validity: no obstacle is nearer to the body than `margin` metres (0: touches it).

    Call it with x, y, yaw, as OMPL does; `free` takes many configurations at once.
    """

    def __init__(
        self, shape: Shape, obstacles: Sequence[Body], *, height: float = 0.0, margin: float = 0.0
    ) -> None:
        self.shape, self.obstacles = shape, list(obstacles)
        self.height, self.margin = height, margin
        self._fixed = [(body.shape, body.pose) for body in self.obstacles]
        self._pose = np.eye(4)  # written anew for each check
        self._pose[2, 3] = height

    def __call__(self, x: float, y: float, yaw: float) -> bool:
        pose, cos, sin = self._pose, math.cos(yaw), math.sin(yaw)
        pose[0, 0] = pose[1, 1] = cos
        pose[1, 0], pose[0, 1] = sin, -sin
        pose[0, 3], pose[1, 3] = x, y
        for shape, place in self._fixed:
            if collide(self.shape, pose, shape, place, margin=self.margin):
                return False
        return True

    def free(self, configurations: ArrayLike) -> NDArray[np.bool_]:
        """Which of the configurations (n, 3) are free, (n,)."""
        poses = as_poses(configurations, self.height)
        hit = np.zeros(poses.shape[:-2], dtype=bool)
        for shape, place in self._fixed:
            hit |= collide(self.shape, poses, shape, place, margin=self.margin)
        return ~hit

    def hits(self, configuration: ArrayLike) -> list[str]:
        """The names of the obstacles in the way of one configuration (3,)."""
        pose = as_poses(configuration, self.height)
        return [
            body.name
            for body, (shape, place) in zip(self.obstacles, self._fixed, strict=True)
            if collide(self.shape, pose, shape, place, margin=self.margin)
        ]


def plan_planar(
    checker: PlanarChecker,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    bounds: ArrayLike | None = None,
    resolution: float = 0.02,
    seed: int = 0,
    time_limit: float = 10.0,
) -> Plan:
    """Plan for the checker's body from start to goal (x, y, yaw each); see `rrt_connect`.

    Without bounds the origin may go where it can pass around everything. Raises PlanningError,
    which names the obstacles where start or goal is in collision.
    """
    for name, q in (("start", start), ("goal", goal)):
        hits = checker.hits(q)
        if hits:
            near = f" closer than {checker.margin:g} m" if checker.margin else ""
            raise PlanningError(f"{name}: the body collides with {' and '.join(hits)}{near}")
    radius = reach(checker.shape.vertices)
    return rrt_connect(
        checker,
        start,
        goal,
        _room(checker, np.array([start, goal], dtype=float), radius) if bounds is None else bounds,
        radius=radius,
        resolution=resolution,
        seed=seed,
        time_limit=time_limit,
    )


def _room(checker: PlanarChecker, ends: Floats, radius: float) -> Floats:
    """Bounds (2, 2) for the origin that leave space to drive around all obstacles."""
    boxes = [body.bounds[:, :2] for body in checker.obstacles]
    corners = np.concatenate([ends[:, :2], *boxes])
    space = 2.0 * (radius + checker.margin)
    return np.stack([corners.min(axis=0) - space, corners.max(axis=0) + space])

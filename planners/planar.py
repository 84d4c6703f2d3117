"""Planning for one rigid body that moves on the floor among the bodies of a world."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.collision.world import MotionResult
from fgenv.planners.errors import PlanningError
from fgenv.planners.planar_rrt import PlanarPlan, rrt_connect
from fgenv.scenarios import bounds as bounds_of
from fgenv.scenarios import in_contact
from fgenv.scenarios.se2 import as_path, as_poses, reach


class PlanarChecker:
    """Validity of a robot's configurations and motions in a world.

    Valid is what keeps more than `margin` meters (0: does not touch) from all bodies. Call it with
    x, y, yaw, as OMPL does; `free` takes many configurations at once.
    """

    def __init__(
        self, world: World, robot: int, *, height: float = 0.0, margin: float = 0.0
    ) -> None:
        self.world, self.robot, self.shape = world, robot, world.record(robot).shape
        self.height, self.margin = height, margin
        self._pose = np.eye(4)  # written anew for each check
        self._pose[2, 3] = height

    def __call__(self, x: float, y: float, yaw: float) -> bool:
        pose, cos, sin = self._pose, math.cos(yaw), math.sin(yaw)
        pose[0, 0] = pose[1, 1] = cos
        pose[1, 0], pose[0, 1] = sin, -sin
        pose[0, 3], pose[1, 3] = x, y
        return not self.world.collides(self.robot, pose, margin=self.margin)

    def free(self, configurations: ArrayLike) -> NDArray[np.bool_]:
        """Which of the configurations (n, 3) are valid, (n,)."""
        poses = as_poses(configurations, self.height)
        return np.asarray(~self.world.collides(self.robot, poses, margin=self.margin))

    def hits(self, configuration: ArrayLike) -> list[str]:
        """The names of the bodies in the way of one configuration (3,)."""
        pose = as_poses(configuration, self.height)
        return in_contact(self.world, self.robot, pose, self.margin)

    def motion(self, path: ArrayLike, margin: float = 0.0) -> MotionResult:
        """The certified motion along each edge of a path (n, 3), at a margin of its own."""
        poses = as_poses(as_path(path), self.height)
        return self.world.check_motion(self.robot, poses[:-1], poses[1:], margin=margin)

    def clearance(self, configurations: ArrayLike) -> Floats:
        """Meters (n,) to the nearest body at configurations (n, 3)."""
        return self.world.clearance(self.robot, as_poses(configurations, self.height)).distance


def plan_planar(
    checker: PlanarChecker,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    bounds: ArrayLike | None = None,
    resolution: float = 0.02,
    seed: int = 0,
    time_limit: float = 10.0,
) -> PlanarPlan:
    """PlanarPlan for the checker's robot from start to goal (x, y, yaw each); see `rrt_connect`.

    States keep the checker's margin; the path's edges are proved free. Without bounds the origin
    may go where it can pass around everything. Raises PlanningError, which names the bodies where
    start or goal is in collision.
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
        proof=lambda path: bool(checker.motion(path)),
    )


def _room(checker: PlanarChecker, ends: Floats, radius: float) -> Floats:
    """Bounds (2, 2) for the origin that leave space to drive around all other bodies."""
    others = [int(body) for body in checker.world.ids if body != checker.robot]
    boxes = [bounds_of(checker.world.record(body))[:, :2] for body in others]
    corners = np.concatenate([ends[:, :2], *boxes])
    space = 2.0 * (radius + checker.margin)
    return np.stack([corners.min(axis=0) - space, corners.max(axis=0) + space])

"""Optimal reciprocal collision avoidance (ORCA) in native code, equal bits on every machine.

J. van den Berg, S. J. Guy, M. Lin, D. Manocha, "Reciprocal n-body collision avoidance", 2011.
"""

from __future__ import annotations

import numpy as np

from fgenv import _core
from fgenv.agents.policies.base import BasePolicy
from fgenv.agents.policies.planar_lidar import PlanarLidar
from fgenv.agents.tracking.path_targets import path_targets
from fgenv.arrays import Floats, Floats32
from fgenv.envs import Observation, View
from fgenv.robots import Robot
from fgenv.robots.footprint import enclosing_radius

GUIDED = Observation(
    path_hint=True, path="shortest", look_ahead=0.4, rays=72, lidar_range=2.0, pad=True
)
GOAL_RADIUS = 0.05  # m; within this distance the robot drives straight to its goal


class OrcaPolicy(BasePolicy):
    """Approximates each robot by its enclosing disc; each robot takes half of the avoidance.

    In each step a robot takes the velocity closest to its preferred one that is free of collisions
    with the other discs for `horizon` seconds, if these take their half; parked robots take none.
    The preferred velocity points straight to the goal, or to the path hint if the robot observes
    one. Other obstacles come from the lidar, if the robot observes one: the end of each ray is a
    static point. All bases must be planar. The shapes of long bodies are not considered.

    Drives that cannot move sideways track the velocity as usual in the field: they turn in place
    until they nearly face it, then drive while they turn (a car steers toward it). They deviate
    from the path of a holonomic disc; their discs are larger by `slack`.

    The defaults were tuned on jittered `swap` of discs (differential drives, jitter 0.2 m).

    Args:
        horizon: time without collisions between robots, s.
        wall_horizon: time without collisions with lidar points, s.
        margin: added to the radius of each disc, m.
        slack: also added for drives that cannot move sideways, m.
        range: distance between centers beyond which robots are ignored, m.
    """

    def __init__(
        self,
        *,
        horizon: float = 1.0,
        wall_horizon: float = 1.0,
        margin: float = 0.01,
        slack: float = 0.03,
        range: float = 10.0,
    ) -> None:
        self.horizon, self.wall_horizon, self.range = horizon, wall_horizon, range
        self.margin, self.slack = margin, slack

    @classmethod
    def guided(cls) -> OrcaPolicy:
        """Return a policy along the shortest path; its margins were tuned on `random`."""
        policy = cls(wall_horizon=2.0, margin=0.03)
        policy.observation = GUIDED
        return policy

    def reset(self, view: View) -> None:
        """Begin new episodes.

        Raises:
            ValueError: a base is not planar.
        """
        super().reset(view)
        for robot in view.robots:
            if robot.base != "planar":
                raise ValueError(
                    f"orca: {robot.name!r} has a {robot.base} base, expected discs on a plane;"
                    " use another policy, such as goto"
                )
        self._radii = np.array([self._radius(robot) for robot in view.robots])
        self._speeds = np.array([robot.actions[0].high for robot in view.robots])
        self._rates = np.array([robot.actions[0].rate for robot in view.robots])
        self._lidars = [PlanarLidar.of(view, i) for i in range(view.n_robots)]

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size)."""
        return self.toward(path_targets(self.view, observations), observations)

    def toward(
        self, points: Floats, observations: Floats32, residual: Floats | None = None
    ) -> Floats:
        """Return actions (worlds, robots, size) toward points that avoid collisions.

        Args:
            points: configurations, (worlds, robots, nq).
            residual: added to the preferred velocity: forward and left in units of the robot's
                maximum speed, (worlds, robots, 2).
        """
        view = self.view
        q = view.configurations
        preferred = self._preferred(q, points)
        if residual is not None:
            preferred = self._with_residual(preferred, q, residual)
        velocities = _core.orca(
            self._discs(q),
            preferred,
            np.broadcast_to(self._speeds, preferred.shape[:2]),
            points=self._points(q, observations),
            horizon=self.horizon,
            point_horizon=self.wall_horizon,
            dt=view.dt,
            range=self.range,
            threads=None,
        )
        if view.actions == "way_points":
            return view.toward(self._way_points(q, velocities))
        return self._drive_actions(q, points, velocities)

    def _drive_actions(self, q: Floats, points: Floats, velocities: Floats) -> Floats:
        """Actions (worlds, robots, size) that track velocities, and drive to near goals."""
        view, goals = self.view, self.view.goals
        actions = view.toward(points)  # for joints, yaw, and robots near their goals
        far = np.sqrt(((goals - q)[..., :2] ** 2).sum(axis=-1)) > GOAL_RADIUS
        for i, robot in enumerate(view.robots):
            yaw, drive = q[:, i, 2], robot.required_drive.base_drive
            if drive.moves_sideways:  # it turns during the step: the chord has its mean yaw
                yaw = yaw + 0.5 * view.dt * robot.actions[2].high * actions[:, i, 2]
            own = drive.track_velocity(robot, yaw, velocities[:, i], view.dt)
            n = 2 if drive.moves_sideways else own.shape[1]
            actions[:, i, :n] = np.where(far[:, i, None], own[:, :n], actions[:, i, :n])
        return actions

    def _radius(self, robot: Robot) -> float:
        """Radius of the disc around the base's origin that encloses the body at every yaw."""
        sideways = robot.required_drive.base_drive.moves_sideways
        return enclosing_radius(robot) + (self.margin if sideways else self.margin + self.slack)

    def _preferred(self, q: Floats, points: Floats) -> Floats:
        """Velocities straight to points, m/s; slower within a step of the goal."""
        to: Floats = points[..., :2] - q[..., :2]
        far = np.sqrt((to**2).sum(axis=-1))
        rate = np.minimum(self._speeds, self.view.remaining / self.view.dt)
        share: Floats = np.divide(rate, far, out=np.zeros_like(far), where=far > 0)[..., None]
        return to * share

    def _with_residual(self, preferred: Floats, q: Floats, residual: Floats) -> Floats:
        """Sum of velocities and the residual, limited to the maximum speed."""
        sine, cosine = _core.sin_cos(q[..., 2])
        x, y = np.moveaxis(residual, -1, 0) * self._speeds
        v: Floats = preferred + np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)
        speed = np.sqrt((v**2).sum(axis=-1))
        v *= (self._speeds / np.maximum(speed, self._speeds))[..., None]
        return v

    def _discs(self, q: Floats) -> Floats:
        """Rows (x, y, vx, vy, radius, parked) of `_core.orca`, (worlds, robots, 6)."""
        view, discs = self.view, np.zeros((*q.shape[:2], 6))
        discs[..., :2] = q[..., :2]
        sine, cosine = _core.sin_cos(q[..., 2])
        for i, robot in enumerate(view.robots):
            v = view.velocities[:, i]
            across = v[:, 1] if robot.actions[1].name == "vy" else np.zeros(len(v))
            discs[:, i, 2] = v[:, 0] * cosine[:, i] - across * sine[:, i]
            discs[:, i, 3] = v[:, 0] * sine[:, i] + across * cosine[:, i]
        discs[..., 4] = np.where(view.present, self._radii, -1.0)
        discs[..., 5] = ~view.moving
        discs[~view.moving, 2:4] = 0.0
        return discs

    def _points(self, q: Floats, observations: Floats32) -> Floats:
        """End points of rays on obstacles, (worlds, robots, rays, 2); NaN elsewhere."""
        rays = max(len(lidar.rays) for lidar in self._lidars)
        points = np.full((*q.shape[:2], rays, 2), np.nan)
        for i, lidar in enumerate(self._lidars):
            at = points[:, i, : len(lidar.rays)]
            if len(lidar.rays):
                at[:] = lidar.points(q[:, i], observations[:, i])
                self._remove_robots(i, at, q)
        return points

    def _remove_robots(self, i: int, at: Floats, q: Floats) -> None:
        """Set points within the discs of other robots to NaN."""
        radii = np.where(self.view.present, self._radii, 0.0)
        for j in range(q.shape[1]):
            if j != i:
                by = at - q[:, None, j, :2]
                at[(by**2).sum(axis=-1) < radii[:, j, None] ** 2] = np.nan

    def _way_points(self, q: Floats, v: Floats) -> Floats:
        """Way points (worlds, robots, nq) that lead to velocities v."""
        speed = np.sqrt((v**2).sum(axis=-1))
        far = speed * self.view.dt + speed**2 / (2 * self._rates)  # plus the braking distance
        ahead = self.view.goals
        ahead[..., :2] = (
            q[..., :2]
            + v * np.divide(far, speed, out=np.zeros_like(far), where=speed > 0)[..., None]
        )
        return ahead


def orca(argument: str, seed: int) -> OrcaPolicy:
    """Make the policy named `orca` or `orca:shortest`."""
    if argument not in ("", "shortest"):
        raise ValueError(f"policy: got 'orca:{argument}', expected orca or orca:shortest")
    return OrcaPolicy.guided() if argument else OrcaPolicy()

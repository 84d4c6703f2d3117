"""Optimal reciprocal collision avoidance (ORCA), the field's usual baseline, in native code.

J. van den Berg, S. J. Guy, M. Lin, D. Manocha, "Reciprocal n-body collision avoidance", 2011. The
same bits on every machine.
"""

from __future__ import annotations

import numpy as np

from fgenv import _core
from fgenv.agents.policies.lidar_points import Lidar
from fgenv.agents.policies.observation import Seeing
from fgenv.agents.tracking.velocity_tracking import base_of, followed, targets
from fgenv.arrays import Floats, Floats32
from fgenv.envs import Observation, View
from fgenv.robots import Holonomic, Robot
from fgenv.robots.footprint import enclosing

GUIDED = Observation(
    path_hint=True, path="shortest", look_ahead=0.4, rays=72, lidar_range=2.0, pad=True
)
NEARLY = 0.05  # m: who is so near to its goal goes there as `goto` does


class Orca(Seeing):
    """Every robot on a planar base is a disc that encloses it, and takes its share of avoiding.

    Each step it takes the velocity nearest to that straight to its goal, or to its path hint where
    it observes one, which, kept for `horizon` seconds, meets none of the others that do their half;
    parked robots do nothing. What else stands about it sees by its lidar, if its observation has
    one: each ray's end is a point that does not move. Discs are all that it knows: long bodies do
    not turn aside.

    Drives that cannot go sideways follow that velocity as the field does: they turn on the spot
    until they are nearly on its course, then drive while they turn (a car steers towards it). They
    are not where a holonomic disc would be, for which the disc is larger by `slack`.

    The defaults were chosen on jittered `swap` of discs (differential drives, jitter 0.2 m).

    Args:
        horizon: seconds ahead that robots shall not meet.
        wall_horizon: the same of what the lidar sees.
        margin: meters that a disc is larger than the body needs.
        slack: meters more, of drives that cannot go sideways.
        range: meters between centers: who is farther away is not looked at.
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
    def guided(cls) -> Orca:
        """One that goes along the shortest path; margins were chosen on `random`."""
        made = cls(wall_horizon=2.0, margin=0.03)
        made.observation = GUIDED
        return made

    def reset(self, view: View) -> None:
        """Episodes begin.

        Raises:
            ValueError: a robot has no planar base.
        """
        super().reset(view)
        for robot in view.robots:
            if robot.base != "planar":
                raise ValueError(
                    f"orca: {robot.name!r} has a {robot.base} base, expected discs on a plane;"
                    " take another policy, such as goto"
                )
        self._radii = np.array([self._radius(robot) for robot in view.robots])
        self._speeds = np.array([robot.actions[0].high for robot in view.robots])
        self._rates = np.array([robot.actions[0].rate for robot in view.robots])
        self._lidars = [Lidar.of(view, i) for i in range(view.n_robots)]

    def act(self, observations: Floats32) -> Floats:
        """Actions (worlds, robots, size)."""
        return self.toward(targets(self.view, observations), observations)

    def toward(self, points: Floats, observations: Floats32, more: Floats | None = None) -> Floats:
        """Actions (worlds, robots, size) that avoid others on the way to points.

        Args:
            points: configurations, (worlds, robots, nq).
            more: ahead and to the left, in the robot's own frame, of the speed: is added to the
                velocity that it wants, (worlds, robots, 2).
        """
        view = self.view
        q, goals = view.configurations, view.goals
        expected = self._straight(q, points)
        if more is not None:
            expected = self._shifted(expected, q, more)
        found = _core.orca(
            self._discs(q),
            expected,
            np.broadcast_to(self._speeds, expected.shape[:2]),
            self._points(q, observations),
            self.horizon,
            self.wall_horizon,
            view.dt,
            self.range,
            None,
        )
        if view.actions == "way_points":
            return view.toward(self._ahead(q, found))
        actions = view.toward(points)  # of joints, of turns, and of who is there or nearly
        far = np.sqrt(((goals - q)[..., :2] ** 2).sum(axis=-1)) > NEARLY
        for i, robot in enumerate(view.robots):
            yaw, sideways = q[:, i, 2], isinstance(base_of(robot), Holonomic)
            if sideways:  # it turns as it goes: the chord of its way has the yaw half way
                yaw = yaw + 0.5 * view.dt * robot.actions[2].high * actions[:, i, 2]
            own = followed(robot, yaw, found[:, i], view.dt)
            n = 2 if sideways else own.shape[1]
            actions[:, i, :n] = np.where(far[:, i, None], own[:, :n], actions[:, i, :n])
        return actions

    def _radius(self, robot: Robot) -> float:
        """Of the disc about the base's origin, in which the body is however it turns."""
        holonomic = isinstance(base_of(robot), Holonomic)
        return enclosing(robot) + (self.margin if holonomic else self.margin + self.slack)

    def _straight(self, q: Floats, points: Floats) -> Floats:
        """Velocities straight to points, slower where the goal is within a step, m/s."""
        to: Floats = points[..., :2] - q[..., :2]
        far = np.sqrt((to**2).sum(axis=-1))
        rate = np.minimum(self._speeds, self.view.remaining / self.view.dt)
        share: Floats = np.divide(rate, far, out=np.zeros_like(far), where=far > 0)[..., None]
        return to * share

    def _shifted(self, expected: Floats, q: Floats, more: Floats) -> Floats:
        """Velocities and something more, at most as fast as the robot."""
        sine, cosine = _core.sin_cos(q[..., 2])
        x, y = np.moveaxis(more, -1, 0) * self._speeds
        found: Floats = expected + np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)
        speed = np.sqrt((found**2).sum(axis=-1))
        found *= (self._speeds / np.maximum(speed, self._speeds))[..., None]
        return found

    def _discs(self, q: Floats) -> Floats:
        """Rows for the native part, (worlds, robots, 6)."""
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
        """Where rays end on what is no robot, (worlds, robots, rays, 2); else NaN."""
        most = max(len(lidar.rays) for lidar in self._lidars)
        points = np.full((*q.shape[:2], most, 2), np.nan)
        for i, lidar in enumerate(self._lidars):
            at = points[:, i, : len(lidar.rays)]
            if len(lidar.rays):
                at[:] = lidar.points(q[:, i], observations[:, i])
                self._forget_robots(i, at, q)
        return points

    def _forget_robots(self, i: int, at: Floats, q: Floats) -> None:
        """Points within the discs of others who are there are theirs."""
        radii = np.where(self.view.present, self._radii, 0.0)
        for j in range(q.shape[1]):
            if j != i:
                by = at - q[:, None, j, :2]
                at[(by**2).sum(axis=-1) < radii[:, j, None] ** 2] = np.nan

    def _ahead(self, q: Floats, v: Floats) -> Floats:
        """Where to drive so that the velocity is what is expected, (worlds, robots, nq)."""
        speed = np.sqrt((v**2).sum(axis=-1))
        far = speed * self.view.dt + speed**2 / (2 * self._rates)  # it slows down in time for that
        ahead = self.view.goals
        ahead[..., :2] = (
            q[..., :2]
            + v * np.divide(far, speed, out=np.zeros_like(far), where=speed > 0)[..., None]
        )
        return ahead

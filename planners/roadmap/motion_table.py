"""Steps: what a robot does in one time step, by number, with a ball around each.

A step is a straight motion (`Robot.interpolate`) that takes one time step; waiting is a step that
stays. Robots of a kind share a table of them, so that what is found out about two steps is kept
under two numbers.
"""

from __future__ import annotations

import numpy as np

from fgenv.arrays import Floats, Ints
from fgenv.robots import Robot

GONE = -1  # the step of a robot that is not there any more
SLACK = 1e-9  # for rounding


class Balls:
    """Balls around a robot's steps."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        parts = [(p, np.asarray(p.shape.vertices, dtype=np.float64)) for p in robot.parts]
        self._links = np.array([p.link for p, _ in parts], dtype=np.int64)
        boxes = [0.5 * (v.min(0) + v.max(0)) for _, v in parts]  # middles, the shapes' frames
        turned = [
            p.origin[:3, :3] @ c + p.origin[:3, 3] for (p, _), c in zip(parts, boxes, strict=True)
        ]
        self._middles = np.array(turned).reshape(-1, 3)  # the links' frames
        far = [((v - c) ** 2).sum(1).max() for (_, v), c in zip(parts, boxes, strict=True)]
        self._radii = np.sqrt(np.array(far))

    def around(self, q0: Floats, q1: Floats) -> tuple[Floats, Floats]:
        """Centers (n, 3), radii (n,), meters: they hold the robot all along q0 to q1, (n, nq)."""
        middle = self.robot.interpolate(q0, q1, 0.5, threads=1)
        poses = self.robot.forward(middle, threads=1)[:, self._links]  # (n, parts, 4, 4)
        at = (poses[..., :3, :3] @ self._middles[..., None])[..., 0] + poses[..., :3, 3]
        center = 0.5 * (at.min(1) + at.max(1))
        away = np.sqrt(((at - center[:, None]) ** 2).sum(-1)) + self._radii
        way = np.asarray(self.robot.distance(q0, q1))  # no point goes farther, half of it each way
        return center, away.max(1) + (0.5 + SLACK) * way + SLACK


class Steps:
    """A table of steps of one kind of robot, which grows.

    Attributes:
        q0, q1: (n, nq), where each begins and ends.
        center, radius: (n, 3) and (n,), meters: a ball that holds the robot all along it.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._balls = Balls(robot)
        self._n = 0
        self._rows = [np.empty((64, k)) for k in (robot.nq, robot.nq, 3, 1)]

    def __len__(self) -> int:
        return self._n

    q0 = property(lambda self: self._rows[0][: self._n])
    q1 = property(lambda self: self._rows[1][: self._n])
    center = property(lambda self: self._rows[2][: self._n])
    radius = property(lambda self: self._rows[3][: self._n, 0])

    def add(self, q0: Floats, q1: Floats) -> int:
        """Add steps from q0 to q1, (m, nq) each; returns the number of the first."""
        first, end = self._n, self._n + len(q0)
        if not len(q0):
            return first
        while end > len(self._rows[0]):
            self._rows = [np.concatenate([rows, np.empty_like(rows)]) for rows in self._rows]
        center, radius = self._balls.around(q0, q1)
        for rows, new in zip(self._rows, (q0, q1, center, radius[:, None]), strict=True):
            rows[first:end] = new
        self._n = end
        return first

    def path(self, ids: Ints) -> Floats:
        """Configurations (k+1, nq) of steps (k,) one after the other."""
        return np.concatenate([self.q0[ids], self.q1[ids[-1:]]])

"""Motion table: the one-step motions of a kind of robot, with a bounding sphere for each.

A motion is straight (`Robot.interpolate`) and takes one time step; waiting is a motion that stays
in place. Robots of the same kind share a table, so that collision results of two motions can be
stored under the numbers of the motions.
"""

from __future__ import annotations

import numpy as np

from fgenv.arrays import Floats, Ints
from fgenv.robots import Robot

ABSENT = -1  # motion number of a robot that has left the world
ROUNDING = 1e-9  # relative, and meters


class BoundingSpheres:
    """Spheres that enclose a robot along its motions."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        parts = [(p, np.asarray(p.shape.vertices, dtype=np.float64)) for p in robot.parts]
        self._links = np.array([p.link for p, _ in parts], dtype=np.int64)
        middles = [0.5 * (v.min(0) + v.max(0)) for _, v in parts]  # in the shapes' frames
        centers = [
            p.origin[:3, :3] @ c + p.origin[:3, 3] for (p, _), c in zip(parts, middles, strict=True)
        ]
        self._centers = np.array(centers).reshape(-1, 3)  # in the links' frames
        squares = [((v - c) ** 2).sum(1).max() for (_, v), c in zip(parts, middles, strict=True)]
        self._radii = np.sqrt(np.array(squares))

    def of_motions(self, q0: Floats, q1: Floats) -> tuple[Floats, Floats]:
        """Centers (n, 3) and radii (n,), meters, of motions from q0 to q1, (n, nq) each."""
        middle = self.robot.interpolate(q0, q1, 0.5, threads=1)
        poses = self.robot.forward(middle, threads=1)[:, self._links]  # (n, parts, 4, 4)
        parts = (poses[..., :3, :3] @ self._centers[..., None])[..., 0] + poses[..., :3, 3]
        center = 0.5 * (parts.min(1) + parts.max(1))
        extent = np.sqrt(((parts - center[:, None]) ** 2).sum(-1)) + self._radii
        length = np.asarray(
            self.robot.displacement_bound(q0, q1)
        )  # bound on a point's path; half per side
        return center, extent.max(1) + (0.5 + ROUNDING) * length + ROUNDING


class MotionTable:
    """Growing table of the motions of one kind of robot.

    Attributes:
        q0, q1: (n, nq), first and last configuration of each motion.
        center, radius: (n, 3) and (n,), meters; sphere that encloses the robot along the motion.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._spheres = BoundingSpheres(robot)
        self._n = 0
        self._columns = [np.empty((64, k)) for k in (robot.nq, robot.nq, 3, 1)]

    def __len__(self) -> int:
        return self._n

    q0 = property(lambda self: self._columns[0][: self._n])
    q1 = property(lambda self: self._columns[1][: self._n])
    center = property(lambda self: self._columns[2][: self._n])
    radius = property(lambda self: self._columns[3][: self._n, 0])

    def add(self, q0: Floats, q1: Floats) -> int:
        """Append motions from q0 to q1, (m, nq) each; return the number of the first."""
        first, end = self._n, self._n + len(q0)
        if not len(q0):
            return first
        while end > len(self._columns[0]):
            self._columns = [np.concatenate([c, np.empty_like(c)]) for c in self._columns]
        center, radius = self._spheres.of_motions(q0, q1)
        for column, new in zip(self._columns, (q0, q1, center, radius[:, None]), strict=True):
            column[first:end] = new
        self._n = end
        return first

    def path(self, motions: Ints) -> Floats:
        """Configurations (k + 1, nq) along consecutive motions (k,)."""
        return np.concatenate([self.q0[motions], self.q1[motions[-1:]]])

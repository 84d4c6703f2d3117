"""How many steps a straight motion takes, and where on it a robot is at each of them."""

from __future__ import annotations

import math

import numpy as np

from fgenv.arrays import Floats
from fgenv.planners.timing import steps_of
from fgenv.robots import DifferentialDrive, Robot

FINE = 0.1  # of what a drive does in a step: a differential drive's ways are rounded up to this


class Pace:
    """Fractions of a motion at each step, at rest at both ends; those asked for before are kept.

    A differential drive's motion is along its x, or a turn on the spot: its length rounded up to a
    tenth of a step says all, and it goes no faster for that.
    """

    def __init__(self, robot: Robot, dt: float) -> None:
        self.robot, self.dt = robot, dt
        self._kept: dict[tuple[float, ...], Floats] = {}

    def fractions(self, q0: Floats, q1: Floats) -> Floats:
        """(k+1,), from 0 to 1, of the straight motion from q0 to q1, (nq,) each."""
        drive = self.robot.drive
        if not (isinstance(drive, DifferentialDrive) and self.robot.nq == 3):
            return self._asked(q0, q1)
        key = self._rounded(drive, q0, q1)
        if key not in self._kept:
            self._kept[key] = self._asked(np.zeros(3), np.array([key[0], 0.0, key[1]]))
        return self._kept[key]

    def _rounded(self, drive: DifferentialDrive, q0: Floats, q1: Floats) -> tuple[float, float]:
        """Meters along x, below 0 backwards, and radians."""
        dx, dy, turn = (q1 - q0).tolist()
        length, turn = math.hypot(dx, dy), abs(math.remainder(turn, 2 * math.pi))
        ahead = dx * math.cos(q0[2]) + dy * math.sin(q0[2]) >= 0.0
        far = _up(length, FINE * drive.speed * self.dt)
        return (far if ahead else -far), min(_up(turn, FINE * drive.turn_rate * self.dt), math.pi)

    def _asked(self, q0: Floats, q1: Floats) -> Floats:
        steps = steps_of(self.robot, np.stack([q0, q1]), self.dt)
        whole = float(self.robot.distance(q0, q1))
        if whole == 0.0:
            return np.array([0.0, 1.0])
        done = np.asarray(self.robot.distance(q0, steps)) / whole
        return np.concatenate([[0.0], done[1:-1], [1.0]])


def _up(value: float, unit: float) -> float:
    return math.ceil(value / unit - 1e-6) * unit

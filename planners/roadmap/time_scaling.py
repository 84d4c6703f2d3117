"""Time scaling of a straight motion: the number of steps, and the fraction reached at each."""

from __future__ import annotations

import math

import numpy as np

from fgenv.arrays import Floats
from fgenv.planners.timing import steps_of
from fgenv.robots import Robot

RESOLUTION = 0.1  # of the motion in a step: lengths are rounded up to multiples of it


class TimeScaling:
    """Fractions of motions at each step, at rest at both ends; results are cached.

    A drive that turns in place moves along its x axis, or turns. Its time scaling depends on the
    length alone, which is rounded up to a tenth of a step; rounding up does not exceed limits.
    """

    def __init__(self, robot: Robot, dt: float) -> None:
        self.robot, self.dt = robot, dt
        self._cached = robot.steering().turns_in_place and robot.nq == 3
        self._cache: dict[tuple[float, ...], Floats] = {}

    def fractions(self, q0: Floats, q1: Floats) -> Floats:
        """Fractions (k + 1,), from 0 to 1, of the straight motion from q0 to q1 (nq,)."""
        if not self._cached:
            return self._fractions(q0, q1)
        key = self._rounded(q0, q1)
        if key not in self._cache:
            self._cache[key] = self._fractions(np.zeros(3), np.array([key[0], 0.0, key[1]]))
        return self._cache[key]

    def _rounded(self, q0: Floats, q1: Floats) -> tuple[float, float]:
        """Distance along x (m), negative for backward motion, and turn (rad)."""
        dx, dy, turn = (q1 - q0).tolist()
        length, turn = math.hypot(dx, dy), abs(math.remainder(turn, 2 * math.pi))
        forward = dx * math.cos(q0[2]) + dy * math.sin(q0[2]) >= 0.0
        speed, turn_rate = (action.high for action in self.robot.actions)
        length = _round_up(length, RESOLUTION * speed * self.dt)
        turn = min(_round_up(turn, RESOLUTION * turn_rate * self.dt), math.pi)
        return (length if forward else -length), turn

    def _fractions(self, q0: Floats, q1: Floats) -> Floats:
        steps = steps_of(self.robot, np.stack([q0, q1]), self.dt)
        total = float(self.robot.displacement_bound(q0, q1))
        if total == 0.0:
            return np.array([0.0, 1.0])
        fractions = np.asarray(self.robot.displacement_bound(q0, steps)) / total
        return np.concatenate([[0.0], fractions[1:-1], [1.0]])


def _round_up(value: float, unit: float) -> float:
    return math.ceil(value / unit - 1e-6) * unit

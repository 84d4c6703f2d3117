"""Steering: local motion between two configurations in free space."""

from __future__ import annotations

import math
from dataclasses import dataclass

METHODS = ("straight", "turn_drive_turn", "dubins", "reeds_shepp")  # in the core's order


@dataclass(frozen=True)
class Steering:
    """A steering function: how a robot moves from one configuration to another in free space.

    Attributes:
        method: `straight`: as `Robot.interpolate`. `turn_drive_turn`: turn in place, drive
            straight, turn in place. `dubins`, `reeds_shepp`: a car's shortest path, forward only or
            in both directions.
        radius: a car's turning radius, meters.
        reverse: whether `turn_drive_turn` may drive backward.
    """

    method: str = "straight"
    radius: float = 1.0
    reverse: bool = True

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise ValueError(f"steering: got {self.method!r}, expected one of {', '.join(METHODS)}")
        if not 0 < self.radius < math.inf:
            raise ValueError(f"radius: got {self.radius}, expected finite meters over 0")

    @property
    def code(self) -> int:
        """The core's number of the method."""
        return METHODS.index(self.method)

    @property
    def turns_in_place(self) -> bool:
        """Whether motions are turns in place and straight drives."""
        return self.method == "turn_drive_turn"

    @property
    def car_like(self) -> bool:
        """Whether motions are arcs and straight drives of a car."""
        return self.method in ("dubins", "reeds_shepp")

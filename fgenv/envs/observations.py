"""Observations of robots: parts that are on or off, each a slice of a row of numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import NamedTuple

from fgenv.robots import Robot

DESCRIPTIONS = {  # unit, frame, description
    "goal": (
        "m, 1",
        "own base",
        "the goal: x, y (m) and cosine, sine of the turn of a planar base; x, y, z (m) and"
        " quaternion x, y, z, w of a free one; then the change of each joint (rad, m)",
    ),
    "velocity": ("m/s, rad/s", "own base", "velocity of the drive: see Robot.actions"),
    "configuration": ("m, rad", "world", "own configuration"),
    "path_hint": (
        "m",
        "own base",
        "the point of the path that is `look_ahead` ahead: x, y (, z); for a fixed base, the change"
        " of each joint to it (rad, m)",
    ),
    "neighbors": (
        "m, 1, m/s",
        "own base",
        "the nearest robots, zeros if there are fewer: planar x, y, cosine, sine, relative"
        " velocity x, y, radius; else x, y, z, quaternion x, y, z, w, velocity x, y, z, radius",
    ),
    "lidar": ("m", "own base", "to the first surface on each ray, at most the lidar's range"),
}


PATHS = ("straight", "shortest")


class Part(NamedTuple):
    """A slice of a row of observations."""

    name: str
    slice: slice
    unit: str
    frame: str
    about: str


@dataclass(frozen=True)
class Observation:
    """Parts that a robot observes, in this order; `Simulator.layouts` lists their slices.

    Attributes:
        goal, velocity, configuration, path_hint, lidar: Whether the part is on. The lidar is that
            of the scenario's model; a model without one has no such part.
        neighbors: Number of nearest robots.
        neighbor_range: Distance between enclosing circles over which neighbors fade, meters: all
            numbers of a neighbor are multiplied by 1 in contact, falling to 0 at this distance, and
            its position is a direction. Networks distinguish near from far better this way. None:
            neighbors do not fade.
        intent: Whether a neighbor includes the vector from it to its goal in the robot's own frame,
            meters (2 numbers; 3 for free bases).
        priority: Whether neighbors are two groups of `neighbors`: first the nearest robots that
            precede this one in the scenario, then those that follow it.
        pad: Whether rows have places (zeros) for all `neighbors` in a scenario of fewer robots, so
            that rows have the same length for any number of robots.
        path: Path of the hint: `straight` to the goal, or `shortest` among static bodies and parked
            robots, for planar bases. Shortest paths are hints, not proofs: they are found on a grid
            with cells that are checked at their centers. A parked robot counts as the discs that
            enclose it. A robot that would block another robot's only route by parking waits: its
            path ends where it stands until the other robot has parked.
        look_ahead: Distance of the path hint, meters (fixed base: radians of all joints together).
        rays: Number of rays of a planar lidar for every robot, in place of the scenario's lidar.
        lidar_range: Range of those rays, meters.
    """

    goal: bool = True
    velocity: bool = True
    configuration: bool = False
    path_hint: bool = False
    lidar: bool = True
    neighbors: int = 4
    neighbor_range: float | None = None
    intent: bool = False
    priority: bool = False
    look_ahead: float = 1.0
    rays: int | None = None
    lidar_range: float = 5.0
    pad: bool = False
    path: str = "straight"

    def __post_init__(self) -> None:
        for name in (switch.name for switch in fields(self) if switch.type == "bool"):
            if not isinstance(getattr(self, name), bool):
                raise TypeError(
                    f"observation: {name}: got {getattr(self, name)!r}, expected a bool"
                )
        if self.path not in PATHS:
            raise ValueError(f"observation: path: got {self.path!r}, expected {' or '.join(PATHS)}")
        whole = isinstance(self.neighbors, int) and not isinstance(self.neighbors, bool)
        if not whole or not 0 <= self.neighbors <= 1000:
            raise ValueError(f"observation: neighbors: got {self.neighbors!r}, expected 0 to 1000")
        if self.rays is not None and not (isinstance(self.rays, int) and 1 <= self.rays <= 100_000):
            raise ValueError(f"observation: rays: got {self.rays!r}, expected 1 to 100000, or None")
        for name in ("look_ahead", "lidar_range", "neighbor_range"):
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise ValueError(
                    f"observation: {name}: got {getattr(self, name)!r}, expected over 0"
                )

    def neighbor_size(self, flat: bool) -> int:
        """Return the size of one neighbor; flat: all bases are planar."""
        return (7 if flat else 11) + (2 if flat else 3) * self.intent


def observation_parts(slices: list[tuple[str, int, int]], robot: Robot) -> tuple[Part, ...]:
    """Return the parts of a robot's row, from the native (name, begin, size)."""
    parts = []
    for name, begin, size in slices:
        unit, frame, about = DESCRIPTIONS[name]
        if name == "velocity":
            about = ", ".join(f"{action.name} ({action.unit})" for action in robot.actions)
        if name == "configuration":
            about = ", ".join(robot.coordinates)
        parts.append(Part(name, slice(begin, begin + size), unit, frame, about))
    return tuple(parts)

"""What a robot observes: parts that are on or off, each a slice of its row of numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import NamedTuple

from fgenv.robots import Robot

ABOUT = {
    "goal": (
        "m, 1",
        "own base",
        "where the goal is: x, y (m) and cosine, sine of the turn of a planar base; x, y, z (m) and"
        " quaternion x, y, z, w of a free one; then the change of each joint (rad, m)",
    ),
    "velocity": ("m/s, rad/s", "own base", "what the drive does: see Robot.actions"),
    "configuration": ("m, rad", "world", "own configuration"),
    "path_hint": (
        "m",
        "own base",
        "the point of the path that is `look_ahead` ahead: x, y (, z); of a fixed base, the change"
        " of each joint to there (rad, m)",
    ),
    "neighbors": (
        "m, 1, m/s",
        "own base",
        "the nearest robots, zeros where there are no more: planar x, y, cosine, sine, relative"
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
    """Which parts a robot observes, in this order; `Simulator.layout` tells their slices.

    Attributes:
        goal, velocity, configuration, path_hint, lidar: on or off. The lidar is that of the
            scenario's model; a model without one has no such part.
        neighbors: how many of the nearest robots.
        neighbor_range: meters between circles that enclose robots, over which neighbors fade: all
            numbers of one are times 1 where circles touch, 0 where they are so far apart, and
            its position is a direction. None: as they are. A network tells near from far better so.
        intent: tell of each neighbor where its goal is from there, meters in the robot's own frame
            (2 numbers; of free bases 3): who it is that will cross its way.
        priority: first the nearest of those that come before the robot in the scenario, then as
            many of those that come after it: who is to go first where only one can.
        pad: have places for so many even in a scenario of fewer robots (zeros), so that rows are as
            long for any number of them.
        path: that the hint follows: `straight` to the goal, or `shortest` among what stands, for
            planar bases (see `fgenv.envs.global_planner`).
        look_ahead: of the path hint, meters (of a fixed base: radians of all joints together).
        rays: of a planar lidar for every robot, in place of the scenario's; None: that one.
        lidar_range: meters, of those rays.
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
        """Numbers of one neighbor; flat: all bases are planar."""
        return (7 if flat else 11) + (2 if flat else 3) * self.intent


def parts_of(slices: list[tuple[str, int, int]], robot: Robot) -> tuple[Part, ...]:
    """The parts of a robot's row, as the native core lays them out."""
    found = []
    for name, begin, size in slices:
        unit, frame, about = ABOUT[name]
        if name == "velocity":
            about = ", ".join(f"{action.name} ({action.unit})" for action in robot.actions)
        if name == "configuration":
            about = ", ".join(robot.coordinates)
        found.append(Part(name, slice(begin, begin + size), unit, frame, about))
    return tuple(found)

"""How an episode went: per robot, and for all together."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.envs import Record, Simulator
from fgenv.robots import Robot


@dataclass(frozen=True)
class RobotResult:
    """How one robot did.

    Attributes:
        arrival: seconds until it was at its goal; None: it never was.
        collisions: steps in which it met something. A robot that was met at rest has none.
        path_length: of its base, meters; of a fixed base, radians of all joints together.
        unit: of that, m or rad.
        least_clearance: meters to whatever was nearest after any step on the way; infinite where
            nothing was there, or it was not measured.
    """

    name: str
    arrival: float | None
    collisions: int
    path_length: float
    unit: str
    least_clearance: float

    @property
    def success(self) -> bool:
        """Whether it came to its goal and met nothing."""
        return self.arrival is not None and self.collisions == 0

    def seconds_on_way(self, seconds: float) -> float:
        """Until it was at its goal, else until the episode ended after so many seconds."""
        return seconds if self.arrival is None else self.arrival


@dataclass(frozen=True)
class Results:
    """How an episode went.

    Attributes:
        robots: in the scenario's order.
        steps, seconds: that it took (simulated time).
    """

    robots: tuple[RobotResult, ...]
    steps: int
    seconds: float

    @classmethod
    def of(cls, source: Simulator | Record, world: int = 0) -> Results:
        """Of a record, or of a simulator's world as it is now.

        Raises:
            ValueError: no such world.
        """
        if isinstance(source, Record):
            return of_record(source)
        return of_world(source, world)

    @property
    def success_rate(self) -> float:
        """Of the robots, 0 to 1: those that came to their goals and met nothing."""
        return sum(robot.success for robot in self.robots) / len(self.robots)

    @property
    def arrived(self) -> int:
        """How many robots came to their goals."""
        return sum(robot.arrival is not None for robot in self.robots)

    @property
    def collisions(self) -> int:
        """Of all robots."""
        return sum(robot.collisions for robot in self.robots)

    @property
    def makespan(self) -> float | None:
        """Seconds until the last robot was at its goal; None where one never was."""
        arrivals = self._arrivals
        return None if arrivals is None else max(arrivals)

    @property
    def sum_of_costs(self) -> float | None:
        """Seconds of all robots until they were at their goals; None where one never was."""
        arrivals = self._arrivals
        return None if arrivals is None else math.fsum(arrivals)

    @property
    def least_clearance(self) -> float:
        """Meters, of all robots."""
        return min(robot.least_clearance for robot in self.robots)

    @property
    def facts(self) -> dict[str, Any]:
        """All of that as plain values for JSON, where null is in place of infinite."""
        return {
            "steps": self.steps,
            "seconds": self.seconds,
            "success_rate": self.success_rate,
            "arrived": self.arrived,
            "collisions": self.collisions,
            "makespan": self.makespan,
            "sum_of_costs": self.sum_of_costs,
            "least_clearance": finite(self.least_clearance),
            "robots": [
                {
                    **asdict(robot),
                    "success": robot.success,
                    "least_clearance": finite(robot.least_clearance),
                }
                for robot in self.robots
            ],
        }

    @property
    def _arrivals(self) -> list[float] | None:
        arrivals = [robot.arrival for robot in self.robots if robot.arrival is not None]
        return arrivals if len(arrivals) == len(self.robots) else None


def finite(x: float) -> float | None:
    """The number, None where it is infinite."""
    return x if math.isfinite(x) else None


def of_world(simulator: Simulator, world: int) -> Results:
    """Of the episode that a world is in."""
    if not 0 <= world < simulator.n_worlds:
        raise ValueError(f"world: got {world}, expected 0 to {simulator.n_worlds - 1}")
    columns = zip(
        simulator.robots,
        simulator.arrival_steps[world].tolist(),
        simulator.collision_counts[world].tolist(),
        simulator.traveled[world].tolist(),
        simulator.least_clearances[world].tolist(),
        strict=True,
    )
    robots = [result(robot, simulator.dt, *numbers) for robot, *numbers in columns]
    steps = int(simulator.steps[world])
    return Results(tuple(robots), steps, steps * simulator.dt)


def of_record(record: Record) -> Results:
    """Of the episode in a record."""
    found = []
    for i, robot in enumerate(record.scenario.build().robots):
        there = np.flatnonzero(record["status"][1:, i])
        step = int(there[0]) + 1 if len(there) else -1
        hits = int((record["hits"][:, i] >= 0).sum())
        length = path_length(robot, record["configurations"][:, i, : robot.nq])
        clearance = float(record["clearances"][:, i].min(initial=math.inf))
        found.append(result(robot, record.dt, step, hits, length, clearance))
    return Results(tuple(found), len(record), len(record) * record.dt)


def result(
    robot: Robot, dt: float, step: int, hits: int, length: float, clearance: float
) -> RobotResult:
    """Of one robot; `step` is that of its arrival, or -1."""
    unit = "rad" if robot.base == "fixed" else "m"
    return RobotResult(robot.name, step * dt if step >= 0 else None, hits, length, unit, clearance)


def path_length(robot: Robot, q: Floats) -> float:
    """Of configurations (n, nq) one after another: meters of the base; a fixed one's radians."""
    by = np.diff(q, axis=0)
    if robot.base == "fixed":
        around = np.round(by / (2 * np.pi)) * (2 * np.pi)
        by = np.where(robot.endless, by - around, by)
    else:
        by = by[:, : 2 if robot.base == "planar" else 3]
    lengths = np.sqrt((by**2).sum(axis=1))
    return float(np.cumsum(lengths)[-1]) if len(lengths) else 0.0  # in the simulator's order

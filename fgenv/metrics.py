"""Results of episodes, per robot and in total."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.envs import Record, Simulator
from fgenv.robots import Robot
from fgenv.text_table import text_table


@dataclass(frozen=True)
class RobotResult:
    """Result of one robot.

    Attributes:
        arrival: time until the robot was at its goal, s; None: it did not arrive.
        steps_in_contact: steps with a contact; a robot at rest that is hit is not counted.
        path_length: of the base, m; of a fixed base, the sum over its joints, rad.
        unit: of the path length, m or rad.
        least_clearance: least distance to another body after any step until arrival, m; None
            without bodies, or if not measured.
    """

    name: str
    arrival: float | None
    steps_in_contact: int
    path_length: float
    unit: str
    least_clearance: float | None

    @property
    def success(self) -> bool:
        """Whether the robot reached its goal without a collision."""
        return self.arrival is not None and self.steps_in_contact == 0

    def seconds_on_way(self, seconds: float) -> float:
        """Return the time until arrival, or the given duration of the episode, s."""
        return seconds if self.arrival is None else self.arrival


@dataclass(frozen=True, repr=False)
class Results:
    """Results of an episode.

    Attributes:
        robots: in the scenario's order.
        steps, seconds: duration (simulated time).
    """

    robots: tuple[RobotResult, ...]
    steps: int
    seconds: float

    def __repr__(self) -> str:
        successes = sum(robot.success for robot in self.robots)
        return (
            f"Results({successes} of {len(self.robots)} robots succeed, {self.steps_in_contact}"
            f" steps in contact, {self.seconds:g} s)"
        )

    def __str__(self) -> str:
        """A table of the robots, under the line of `repr`."""
        titles = "robot", "success", "arrived (s)", "steps in contact", "path", "clearance (m)"
        rows = [
            (
                robot.name,
                "yes" if robot.success else "no",
                "-" if robot.arrival is None else f"{robot.arrival:.1f}",
                str(robot.steps_in_contact),
                f"{robot.path_length:.2f} {robot.unit}",
                "-" if robot.least_clearance is None else f"{robot.least_clearance:.3f}",
            )
            for robot in self.robots
        ]
        return f"{self!r}\n{text_table(titles, rows)}"

    @classmethod
    def of(cls, source: Simulator | Record, world: int = 0) -> Results:
        """Return the results of a record, or of a simulator's world up to now.

        Raises:
            ValueError: no such world.
        """
        if isinstance(source, Record):
            return of_record(source)
        return of_world(source, world)

    @property
    def success_rate(self) -> float:
        """Share of robots that reached their goals without a collision, 0 to 1."""
        return sum(robot.success for robot in self.robots) / len(self.robots)

    @property
    def arrived(self) -> int:
        """Number of robots that reached their goals."""
        return sum(robot.arrival is not None for robot in self.robots)

    @property
    def steps_in_contact(self) -> int:
        """Number of steps with a contact, summed over robots."""
        return sum(robot.steps_in_contact for robot in self.robots)

    @property
    def makespan(self) -> float | None:
        """Time until the last robot was at its goal, s; None if one did not arrive."""
        arrivals = self._arrivals
        return None if arrivals is None else max(arrivals)

    @property
    def sum_of_costs(self) -> float | None:
        """Sum of the arrival times, s; None if a robot did not arrive."""
        arrivals = self._arrivals
        return None if arrivals is None else math.fsum(arrivals)

    @property
    def least_clearance(self) -> float | None:
        """Least clearance of all robots, m; None without bodies, or if not measured."""
        return min((c for r in self.robots if (c := r.least_clearance) is not None), default=None)

    @property
    def facts(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "steps": self.steps,
            "seconds": self.seconds,
            "success_rate": self.success_rate,
            "arrived": self.arrived,
            "steps_in_contact": self.steps_in_contact,
            "makespan": self.makespan,
            "sum_of_costs": self.sum_of_costs,
            "least_clearance": self.least_clearance,
            "robots": [{**asdict(robot), "success": robot.success} for robot in self.robots],
        }

    @property
    def _arrivals(self) -> list[float] | None:
        arrivals = [robot.arrival for robot in self.robots if robot.arrival is not None]
        return arrivals if len(arrivals) == len(self.robots) else None


def of_world(simulator: Simulator, world: int) -> Results:
    """Return the results of a world's current episode."""
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
    """Return the results of a recorded episode."""
    results = []
    for i, robot in enumerate(record.scenario.build().robots):
        arrived = np.flatnonzero(record["status"][1:, i])
        step = int(arrived[0]) + 1 if len(arrived) else -1
        hits = int((record["hits"][:, i] >= 0).sum())
        length = path_length(robot, record["configurations"][:, i, : robot.nq])
        clearance = float(record["clearances"][:, i].min(initial=math.inf))
        results.append(result(robot, record.dt, step, hits, length, clearance))
    return Results(tuple(results), len(record), len(record) * record.dt)


def result(
    robot: Robot, dt: float, step: int, hits: int, length: float, clearance: float
) -> RobotResult:
    """Return the result of one robot; `step` is that of its arrival, or -1."""
    unit = "rad" if robot.base == "fixed" else "m"
    arrival = step * dt if step >= 0 else None
    measured = clearance if math.isfinite(clearance) else None
    return RobotResult(robot.name, arrival, hits, length, unit, measured)


def path_length(robot: Robot, q: Floats) -> float:
    """Return the length of a sequence of configurations (n, nq): m of the base, or rad if fixed."""
    delta = np.diff(q, axis=0)
    if robot.base == "fixed":
        turns = np.round(delta / (2 * np.pi)) * (2 * np.pi)
        delta = np.where(robot.endless, delta - turns, delta)
    else:
        delta = delta[:, : 2 if robot.base == "planar" else 3]
    lengths = np.sqrt((delta**2).sum(axis=1))
    return float(np.cumsum(lengths)[-1]) if len(lengths) else 0.0  # summed in the simulator's order

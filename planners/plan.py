"""Plans: timed paths of all robots with their certificate, in memory and in files.

A plan file is an archive (`fgenv.archive`) of the format "fgenv plan 1":

    scenario  JSON: the scenario without defaults; paths of mesh files are relative to the plan,
              with their SHA-256
    about     JSON: method, planner, seed, margin (m), facts about the search, certificate,
              urdf (SHA-256 of each model's file)

and for each robot i, in the order of the scenario:

    configurations_<i>  (k + 1, nq) float64: configuration at each time step from the start to the
                        goal, straight in between (m, rad)
    waypoints_<i>      (m, nq) float64: the path before timing
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fgenv.archive import Archive
from fgenv.arrays import Floats
from fgenv.robots import Robot
from fgenv.scenarios import Scenario
from fgenv.scenarios.frozen_set import text_of
from fgenv.scenarios.hashes import urdf_hashes, with_hashes
from fgenv.scenarios.yaml_io import moved
from fgenv.text_table import text_table

from .certificate import Certificate, arrival


class PlanError(ValueError):
    """The plan file cannot be used; the message gives the reason and the remedy."""


PLAN = Archive("plan", 1, ("scenario", "about"), PlanError, "plan again")


@dataclass(frozen=True, eq=False, repr=False)
class Plan:
    """Timed paths of all robots of a scenario, as read-only arrays.

    Attributes:
        scenario: the scenario that was planned.
        configurations: of each robot at each step, (k + 1, nq); straight in between.
        waypoints: of each robot's path before timing, (m, nq).
        method, planner, seed: arguments of the planning.
        certificate: certified properties of the timed paths.
        facts: plain values about the search, such as seconds and numbers of checks.
        urdf: SHA-256 of each model's URDF file; empty before the plan is saved.
    """

    scenario: Scenario
    configurations: tuple[Floats, ...]
    waypoints: tuple[Floats, ...]
    method: str
    planner: str
    seed: int
    certificate: Certificate
    facts: dict[str, Any] = field(default_factory=dict)
    urdf: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("configurations", "waypoints"):
            arrays = tuple(np.array(a, dtype=np.float64) for a in getattr(self, name))
            for array in arrays:
                array.flags.writeable = False
            object.__setattr__(self, name, arrays)

    def __repr__(self) -> str:
        proved = "proved" if self.certificate else "not proved"
        return (
            f"Plan({self.scenario.name!r} by {self.method}: {len(self.configurations)} robots,"
            f" makespan {self.makespan:g} s, {proved})"
        )

    def __str__(self) -> str:
        """A table of the robots, under the line of `repr`."""
        names = [robot.name for robot in self.scenario.robots]
        rows = [
            (name, f"{arrival:.1f}", f"{length:.2f}")
            for name, arrival, length in zip(names, self.arrivals, self.lengths, strict=True)
        ]
        return f"{self!r}\n{text_table(('robot', 'arrives (s)', 'path (m)'), rows)}"

    @property
    def dt(self) -> float:
        """Seconds of a step."""
        return self.scenario.time_step

    @property
    def steps(self) -> int:
        """Number of steps until the last robot is at its goal."""
        return len(self.configurations[0]) - 1

    @property
    def times(self) -> Floats:
        """Times of the configurations, (k + 1,), seconds."""
        return np.arange(self.steps + 1, dtype=np.float64) * np.float64(self.dt)

    @cached_property
    def arrivals(self) -> tuple[float, ...]:
        """Time at which each robot arrives at its goal for good, seconds."""
        return tuple(arrival(q) * self.dt for q in self.configurations)

    @property
    def makespan(self) -> float:
        """Time at which the last robot arrives at its goal, seconds."""
        return max(self.arrivals)

    @property
    def sum_of_costs(self) -> float:
        """Sum of the robots' arrival times, seconds."""
        return sum(self.arrivals)

    @cached_property
    def lengths(self) -> tuple[float, ...]:
        """Length of each robot's path, meters: of a moving base, else by `Robot.distance`."""
        models = self.scenario.build().robots
        return tuple(_length(m, q) for m, q in zip(models, self.configurations, strict=True))

    def at(self, time: ArrayLike) -> list[Floats]:
        """Configurations (..., nq) of each robot at times (...) in seconds.

        Before the start and after the end robots are at rest.
        """
        when = np.asarray(time, dtype=np.float64)
        if np.isnan(when).any():
            raise ValueError("time: got NaN, expected seconds")
        step = np.clip(when / self.dt, 0.0, self.steps)
        k = np.minimum(step.astype(int), max(self.steps - 1, 0))
        after = np.minimum(k + 1, self.steps)
        models = self.scenario.build().robots
        return [
            m.interpolate(q[k], q[after], step - k)
            for m, q in zip(models, self.configurations, strict=True)
        ]

    @property
    def texts(self) -> dict[str, str]:
        """Texts of the plan file: the scenario, and the attributes as JSON."""
        about = {
            "method": self.method,
            "planner": self.planner,
            "seed": self.seed,
            "facts": self.facts,
            "certificate": asdict(self.certificate),
            "urdf": self.urdf,
        }
        text = json.dumps(about, sort_keys=True, separators=(",", ":"))
        return {"scenario": text_of(self.scenario), "about": text}

    @property
    def arrays(self) -> dict[str, Floats]:
        """Arrays of the plan file, by name."""
        return {
            f"{name}_{i}": array
            for name in ("configurations", "waypoints")
            for i, array in enumerate(getattr(self, name))
        }

    @property
    def id(self) -> str:
        """Hash of the contents, 64 hexadecimal digits."""
        return PLAN.id(self.texts, self.arrays)

    def save(self, path: str | Path) -> None:
        """Write a compressed .npz file; an existing file is replaced atomically.

        Raises:
            ValueError: the name does not end in .npz.
            OSError: the file cannot be written.
        """
        folder = Path(path).parent
        scenario = with_hashes(moved(self.scenario, folder).at(folder))
        here = replace(self, scenario=scenario, urdf=urdf_hashes(scenario))
        PLAN.save(path, here.texts, here.arrays)

    @classmethod
    def load(cls, path: str | Path) -> Plan:
        """Read a plan file; use `verify` to check its certificate.

        Raises:
            PlanError: the file is damaged, no plan, or of another version.
            FileNotFoundError: the file does not exist.
        """

        def read(texts: dict[str, str], arrays: dict[str, Floats]) -> Plan:
            scenario = Scenario.model_validate(json.loads(texts["scenario"]))
            about, n = json.loads(texts["about"]), range(len(scenario.robots))
            certificate = about.pop("certificate")
            certificate["nearest"] = certificate["nearest"] and tuple(certificate["nearest"])
            return cls(
                scenario.at(Path(path).parent),
                tuple(arrays[f"configurations_{i}"] for i in n),
                tuple(arrays[f"waypoints_{i}"] for i in n),
                certificate=Certificate(**certificate),
                **about,
            )

        return PLAN.load(path, read)


def _length(model: Robot, q: Floats) -> float:
    if model.base == "fixed":
        return float(np.sum(model.displacement_bound(q[:-1], q[1:])))
    place = q[:, : 3 if model.base == "free" else 2]
    return float(np.linalg.norm(np.diff(place, axis=0), axis=1).sum())


def padded(paths: Sequence[Floats]) -> tuple[Floats, ...]:
    """Timed paths extended to equal lengths; robots rest at their last configurations."""
    count = max(len(q) for q in paths)
    return tuple(np.concatenate([q, np.repeat(q[-1:], count - len(q), axis=0)]) for q in paths)

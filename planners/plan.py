"""Plans: timed paths of all robots with their certificate, in memory and as files.

A plan file is an archive (`fgenv.archive`) of the format "fgenv plan 1":

    scenario  JSON: the scenario, defaults left out; paths of mesh files are relative to the plan,
              with their SHA-256
    about     JSON: method, planner, seed, margin (m), facts (of the search), certificate,
              urdf (SHA-256 of each model's file)

and for each robot i, in the order of the scenario:

    configurations_<i>  (k + 1, nq) float64: at each step of the scenario's time step, from its
                        start to its goal; straight in between (m, rad)
    way_points_<i>      (m, nq) float64: the path before it was timed
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
from fgenv.scenarios import Scenario
from fgenv.scenarios.frozen_set import text_of
from fgenv.scenarios.hashes import urdf_hashes, with_hashes
from fgenv.scenarios.io.yaml_text import moved
from fgenv.scenarios.validation import files

from .certificate import Certificate, arrival, certify
from .limits import wrong_with
from .problem import Problem


class PlanError(ValueError):
    """A plan file that cannot be used: why, and the remedy."""


PLAN = Archive("plan", 1, ("scenario", "about"), PlanError, "plan again")


@dataclass(frozen=True, eq=False)
class Plan:
    """Timed paths of all robots of a scenario; read-only arrays.

    Attributes:
        scenario: whose robots go from their starts to their goals.
        configurations: of each robot at each step, (k + 1, nq); straight in between.
        way_points: of each robot before its path was timed, (m, nq).
        method, planner, seed: how it was found.
        certificate: what is proved of it.
        facts: of the search: seconds, checks and so on, plain values.
    """

    scenario: Scenario
    configurations: tuple[Floats, ...] = field(repr=False)
    way_points: tuple[Floats, ...] = field(repr=False)
    method: str
    planner: str
    seed: int
    certificate: Certificate
    facts: dict[str, Any] = field(default_factory=dict, repr=False)
    urdf: dict[str, str] = field(default_factory=dict, repr=False)  # hashes of files, once saved

    def __post_init__(self) -> None:
        for name in ("configurations", "way_points"):
            arrays = tuple(np.array(a, dtype=np.float64) for a in getattr(self, name))
            for array in arrays:
                array.flags.writeable = False
            object.__setattr__(self, name, arrays)

    @property
    def dt(self) -> float:
        """Seconds of a step."""
        return self.scenario.time_step

    @property
    def steps(self) -> int:
        """Of all robots, until the last has come to its goal."""
        return len(self.configurations[0]) - 1

    @property
    def times(self) -> Floats:
        """Seconds of each step's end, (k + 1,)."""
        return np.arange(self.steps + 1, dtype=np.float64) * np.float64(self.dt)

    @cached_property
    def arrivals(self) -> tuple[float, ...]:
        """Seconds after which each robot is at its goal for good."""
        return tuple(arrival(q) * self.dt for q in self.configurations)

    @property
    def makespan(self) -> float:
        """Seconds until the last robot is at its goal."""
        return max(self.arrivals)

    @property
    def sum_of_costs(self) -> float:
        """Seconds of all robots together."""
        return sum(self.arrivals)

    @cached_property
    def lengths(self) -> tuple[float, ...]:
        """Of each robot's path: meters of a base that moves, else of `Robot.distance`."""
        models = self.scenario.build().robots
        return tuple(_length(m, q) for m, q in zip(models, self.configurations, strict=True))

    def at(self, time: ArrayLike) -> list[Floats]:
        """Configurations (..., nq) of each robot at times (...) in seconds; at rest outside."""
        when = np.asarray(time, dtype=np.float64)
        if np.isnan(when).any():
            raise ValueError("time: NaN, expected seconds")
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
        """Scenario and what is said about the plan, as they are stored."""
        about = {
            "method": self.method,
            "planner": self.planner,
            "seed": self.seed,
            "facts": self.facts,
            "certificate": asdict(self.certificate),
            "urdf": self.urdf,
        }
        said = json.dumps(about, sort_keys=True, separators=(",", ":"))
        return {"scenario": text_of(self.scenario), "about": said}

    @property
    def arrays(self) -> dict[str, Floats]:
        """By the names they are stored under."""
        return {
            f"{name}_{i}": array
            for name in ("configurations", "way_points")
            for i, array in enumerate(getattr(self, name))
        }

    @property
    def id(self) -> str:
        """Hash of all that is in it, 64 hexadecimal digits."""
        return PLAN.id(self.texts, self.arrays)

    def save(self, path: str | Path) -> None:
        """Write a compressed .npz file; one that is there is replaced in one go.

        Raises:
            ValueError: its name does not end in .npz.
            OSError: it cannot be written.
        """
        folder = Path(path).parent
        scenario = with_hashes(moved(self.scenario, folder).at(folder))
        here = replace(self, scenario=scenario, urdf=urdf_hashes(scenario))
        PLAN.save(path, here.texts, here.arrays)

    @classmethod
    def load(cls, path: str | Path) -> Plan:
        """Read a file; `verify` proves what it claims.

        Raises:
            PlanError: no plan, damaged, or of another version.
            FileNotFoundError: no such file.
        """

        def read(texts: dict[str, str], arrays: dict[str, Floats]) -> Plan:
            scenario = Scenario.model_validate(json.loads(texts["scenario"]))
            about, n = json.loads(texts["about"]), range(len(scenario.robots))
            proof = about.pop("certificate")
            proof["nearest"] = proof["nearest"] and tuple(proof["nearest"])
            return cls(
                scenario.at(Path(path).parent),
                tuple(arrays[f"configurations_{i}"] for i in n),
                tuple(arrays[f"way_points_{i}"] for i in n),
                certificate=Certificate(**proof),
                **about,
            )

        return PLAN.load(path, read)


def verify(plan: Plan | str | Path, margin: float | None = None) -> Certificate:
    """Prove a plan again, from nothing but the file: the scenario is built anew.

    Starts and goals, limits of configurations, speeds and accelerations are looked at too.

    Args:
        plan: or its file.
        margin: meters; what the plan claims if left out.

    Raises:
        PlanError: it does not fit its scenario: ends, limits, shapes, other mesh files.
    """
    if not isinstance(plan, Plan):
        plan = Plan.load(plan)
    for found in files(plan.scenario):
        raise PlanError(f"plan: {found.problem}")
    changed = {m for m, h in urdf_hashes(plan.scenario).items() if h != plan.urdf.get(m)}
    if plan.urdf and changed:
        raise PlanError(f"plan: the URDF of {changed.pop()!r} is another than it was made with")
    problem = Problem.of(plan.scenario, plan.certificate.margin if margin is None else margin)
    steps = {len(q) if q.ndim else 0 for q in plan.configurations}
    if len(plan.configurations) != len(problem.models) or len(steps) != 1 or 0 in steps:
        raise PlanError("plan: not one configuration for each robot and step; plan again")
    for i, q in enumerate(plan.configurations):
        wrong = wrong_with(problem, i, q)
        if wrong:
            raise PlanError(f"plan: {problem.names[i]!r} {wrong}; plan again")
    return certify(problem, plan.configurations)


def _length(model: Any, q: Floats) -> float:
    if model.base == "fixed":
        return float(np.sum(model.distance(q[:-1], q[1:])))
    place = q[:, : 3 if model.base == "free" else 2]
    return float(np.linalg.norm(np.diff(place, axis=0), axis=1).sum())


def padded(paths: Sequence[Floats]) -> tuple[Floats, ...]:
    """Timed paths made equally long: who is there first rests."""
    most = max(len(q) for q in paths)
    return tuple(np.concatenate([q, np.repeat(q[-1:], most - len(q), axis=0)]) for q in paths)

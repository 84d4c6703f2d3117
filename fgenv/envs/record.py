"""Records of episodes: compact files that can be looked at, measured, drawn and run again.

A record is an archive (`fgenv.archive`) of the format "fgenv record 1":

    scenario    JSON: the scenario of this very episode, defaults left out; paths of mesh files are
                relative to the record, with their SHA-256
    about       JSON: policy; seed and episode (of the world's random numbers); actions (drive or
                way_points) and way_point_seconds; dt (s); ended (terminated, truncated, or stopped
                before its end); names (of bodies, by id); urdf (SHA-256 of each model's file);
                versions (of fgenv and NumPy)

and for T steps of n robots, rows as wide as the widest robot's and ending in zeros:

    configurations  (T + 1, n, nq) float64, the first before the first step (m, rad)
    status          (T + 1, n) uint8, 0 on the way, 1 parked at the goal, 2 gone from there
    actions         (T, n, size) float64, as the policy gave them
    rewards         (T, n) float64
    hits            (T, n) int32, id of the body that each robot met, -1: none
    hit_robots      (T, n) int32, the place of the robot that it belongs to, -1: none
    hit_times       (T, n) float64, seconds in the step
    hit_points      (T, n, 3) float64, world (m)
    clearances      (T, n) float64, to whatever is nearest (m), infinite where not measured
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fgenv.archive import Archive
from fgenv.scenarios import Scenario
from fgenv.scenarios.frozen_set import text_of
from fgenv.scenarios.io.yaml_text import moved

if TYPE_CHECKING:
    from .simulator import Simulator

ARRAYS = {
    "configurations": "<f8",
    "status": "|u1",
    "actions": "<f8",
    "rewards": "<f8",
    "hits": "<i4",
    "hit_robots": "<i4",
    "hit_times": "<f8",
    "hit_points": "<f8",
    "clearances": "<f8",
}
BEFORE = ("configurations", "status")  # have a row for the time before the first step
WIDE = ("configurations", "actions", "hit_points")  # have a row for each robot
Arrays = dict[str, NDArray[Any]]


class RecordError(ValueError):
    """A record that cannot be used: why, and the remedy."""


RECORD = Archive(
    "record", 1, ("scenario", "about"), RecordError, "record the run again", dtypes=ARRAYS
)


@dataclass(frozen=True, eq=False)
class Record:
    """An episode of one world; see the module for what is in it.

    Attributes:
        scenario: of this very episode.
        about: plain values.
        arrays: by name.
    """

    scenario: Scenario
    about: dict[str, Any]
    arrays: Arrays = field(repr=False)

    def __post_init__(self) -> None:
        arrays = {name: np.array(self.arrays[name], dtype) for name, dtype in ARRAYS.items()}
        for array in arrays.values():
            array.flags.writeable = False
        object.__setattr__(self, "arrays", arrays)
        self._check()

    def __len__(self) -> int:
        """Steps."""
        return len(self.arrays["actions"])

    def __getitem__(self, name: str) -> NDArray[Any]:
        """An array by its name."""
        return self.arrays[name]

    @property
    def n_robots(self) -> int:
        """Of the scenario."""
        return len(self.scenario.robots)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the robots."""
        return tuple(robot.name for robot in self.scenario.robots)

    @property
    def dt(self) -> float:
        """Seconds of a step."""
        return self.scenario.time_step

    @property
    def policy(self) -> str:
        """What acted, as whoever recorded it named it."""
        return str(self.about["policy"])

    @cached_property
    def id(self) -> str:
        """Hash of all that is in it, 64 hexadecimal digits."""
        return RECORD.id(self.texts, self.arrays)

    @property
    def texts(self) -> dict[str, str]:
        """The scenario and what is said about it, as they are stored."""
        about = json.dumps(self.about, sort_keys=True, separators=(",", ":"))
        return {"scenario": text_of(self.scenario), "about": about}

    def save(self, path: str | Path) -> None:
        """Write a compressed .npz file; one that is there is replaced in one go.

        Raises:
            ValueError: its name does not end in .npz.
            OSError: it cannot be written.
        """
        here = Record(moved(self.scenario, Path(path).parent), self.about, self.arrays)
        RECORD.save(path, here.texts, here.arrays)

    @classmethod
    def load(cls, path: str | Path) -> Record:
        """Read and verify a file.

        Raises:
            RecordError: no record, damaged, or of another version.
            FileNotFoundError: no such file.
        """

        def read(texts: dict[str, str], arrays: Arrays) -> Record:
            scenario = Scenario.model_validate(json.loads(texts["scenario"]))
            return cls(scenario.at(Path(path).parent), json.loads(texts["about"]), arrays)

        return RECORD.load(path, read)

    def replay(self, threads: int | None = None) -> Simulator:
        """Run it again with its actions, and prove that all comes out the same, bit for bit.

        Returns:
            A simulator at the end of the episode.

        Raises:
            RecordError: mesh files are others, or the first step that differs, and where.
        """
        from .record_check import replayed

        return replayed(self, threads)

    def _check(self) -> None:
        """RecordError where arrays do not fit together."""
        steps, n = len(self.arrays["actions"]), self.n_robots
        for name in ARRAYS:
            array, rows = self.arrays[name], steps + (name in BEFORE)
            if array.shape[:2] != (rows, n) or array.ndim != 2 + (name in WIDE):
                expected = f"({rows}, {n}{', ...' if name in WIDE else ''})"
                raise RecordError(f"record: {name} has shape {array.shape}, expected {expected}")

    def __repr__(self) -> str:
        name = self.scenario.name
        return f"Record({name!r} by {self.policy}: {len(self)} steps, {self.n_robots} robots)"

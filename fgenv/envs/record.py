"""Records of episodes: compact files to inspect, measure, draw and run again.

A record is an archive (`fgenv.archive`) of the format "fgenv record 1":

    scenario    JSON: the scenario of this episode without default values; paths of mesh files are
                relative to the record, with their SHA-256
    about       JSON: policy; seed and episode (of the world's random numbers); actions (drive or
                way_points) and way_point_seconds; dt (s); ended (terminated, truncated or stopped);
                names (of bodies, by id); urdf (SHA-256 of each model's file); versions (of fgenv
                and NumPy)

and for T steps of n robots, rows padded with zeros to the length of the longest:

    configurations  (T + 1, n, nq) float64, the first before the first step (m, rad)
    status          (T + 1, n) uint8, 0 moving, 1 parked at the goal, 2 removed at the goal
    actions         (T, n, size) float64, as returned by the policy
    rewards         (T, n) float64
    hits            (T, n) int32, id of the body that each robot touched, -1: none
    hit_robots      (T, n) int32, index of the robot with that body, -1: none
    hit_times       (T, n) float64, seconds within the step
    hit_points      (T, n, 3) float64, world (m)
    clearances      (T, n) float64, to the nearest body (m), infinite where not measured
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv.archive import Archive
from fgenv.npz import Header
from fgenv.scenarios import Scenario
from fgenv.scenarios.frozen_set import text_of
from fgenv.scenarios.yaml_io import moved

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
INITIAL = ("configurations", "status")  # arrays with a row before the first step
MAX_ACTIONS = 4  # numbers of an action per coordinate of the robot with the most
VECTORS = ("configurations", "actions", "hit_points")  # arrays with a row per robot
Arrays = dict[str, NDArray[Any]]


class RecordError(ValueError):
    """An invalid record, with the reason and the remedy."""


def check_headers(texts: dict[str, str], headers: dict[str, Header]) -> None:
    """Raise RecordError if the sizes of a file's arrays are not those of its scenario's episode."""
    scenario = Scenario.model_validate(json.loads(texts["scenario"]))
    n, widest = len(scenario.robots), max(len(robot.start) for robot in scenario.robots)
    if headers.keys() != ARRAYS.keys():
        raise RecordError(f"record: got arrays {', '.join(headers)[:80]}, expected {list(ARRAYS)}")
    steps = headers["actions"].shape[:1]
    widths = {"configurations": widest, "actions": MAX_ACTIONS * widest, "hit_points": 3}
    for name, header in headers.items():
        rows = steps[0] + (name in INITIAL) if steps else 0
        width = header.shape[2:]
        valid = header.shape[:2] == (rows, n) and len(width) == (name in VECTORS)
        if not valid or header.dtype.str != ARRAYS[name] or any(w > widths[name] for w in width):
            raise RecordError(
                f"record: {name}: got {header.dtype} {header.shape}, expected {ARRAYS[name]} of"
                f" {rows} steps and {n} robots"
            )


RECORD = Archive(
    "record",
    1,
    ("scenario", "about"),
    RecordError,
    "record the run again",
    dtypes=ARRAYS,
    check=check_headers,
)


@dataclass(frozen=True, eq=False)
class Record:
    """An episode of one world; see the module for its contents.

    Attributes:
        scenario: of this episode, with its starts and goals.
        about: plain values.
        arrays: read-only, by name.
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
        """Number of steps."""
        return len(self.arrays["actions"])

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return an array by its name."""
        return self.arrays[name]

    @property
    def n_robots(self) -> int:
        """Number of robots."""
        return len(self.scenario.robots)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the robots."""
        return tuple(robot.name for robot in self.scenario.robots)

    @property
    def dt(self) -> float:
        """Duration of a step, s."""
        return self.scenario.time_step

    @property
    def policy(self) -> str:
        """Name of the policy."""
        return str(self.about["policy"])

    @cached_property
    def id(self) -> str:
        """Hash of the contents, 64 hexadecimal digits."""
        return RECORD.id(self.texts, self.arrays)

    @property
    def texts(self) -> dict[str, str]:
        """Stored texts: `scenario` and `about`."""
        about = json.dumps(self.about, sort_keys=True, separators=(",", ":"))
        return {"scenario": text_of(self.scenario), "about": about}

    def save(self, path: str | Path) -> None:
        """Write a compressed .npz file; an existing file is replaced atomically.

        Raises:
            ValueError: the name does not end in .npz.
            OSError: the file cannot be written.
        """
        relative = Record(moved(self.scenario, Path(path).parent), self.about, self.arrays)
        RECORD.save(path, relative.texts, relative.arrays)

    @classmethod
    def load(cls, path: str | Path) -> Record:
        """Read and verify a file.

        Raises:
            RecordError: not a record, damaged, or of another version.
            FileNotFoundError: no such file.
        """

        def read(texts: dict[str, str], arrays: Arrays) -> Record:
            scenario = Scenario.model_validate(json.loads(texts["scenario"]))
            return cls(scenario.at(Path(path).parent), json.loads(texts["about"]), arrays)

        return RECORD.load(path, read)

    def _check(self) -> None:
        """Raise RecordError if the shapes of the arrays are inconsistent."""
        steps, n = len(self.arrays["actions"]), self.n_robots
        for name in ARRAYS:
            array, rows = self.arrays[name], steps + (name in INITIAL)
            if array.shape[:2] != (rows, n) or array.ndim != 2 + (name in VECTORS):
                expected = f"({rows}, {n}{', ...' if name in VECTORS else ''})"
                raise RecordError(f"record: {name}: got shape {array.shape}, expected {expected}")

    def __repr__(self) -> str:
        name = self.scenario.name
        return f"Record({name!r} by {self.policy}: {len(self)} steps, {self.n_robots} robots)"

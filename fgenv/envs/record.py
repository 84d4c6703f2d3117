"""Records of episodes: compact files that can be looked at, measured, drawn and run again.

A record is a NumPy `.npz` (a zip of arrays; `numpy.load` reads it), compressed:

    format      "fgenv record 1"
    id          SHA-256 of all the rest, little-endian: 64 hexadecimal digits
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

All are little-endian.
"""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fgenv.scenarios import Scenario
from fgenv.scenarios.frozen import text_of
from fgenv.scenarios.text import moved

if TYPE_CHECKING:
    from .simulator import Simulator

FORMAT = "fgenv record 1"
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
        return hash_of(self.texts, self.arrays)

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
        path = Path(path)
        if path.suffix != ".npz":
            raise ValueError(f"record: {path}, wanted a name that ends in .npz")
        here = Record(moved(self.scenario, path.parent), self.about, dict(self.arrays))
        head = {"format": FORMAT, "id": here.id, **here.texts}
        half = path.with_name(f".{path.name}.part")
        try:
            with open(half, "wb") as file:
                np.savez_compressed(file, **head, **here.arrays)  # type: ignore[arg-type]
            os.replace(half, path)
        finally:
            half.unlink(missing_ok=True)

    @classmethod
    def load(cls, path: str | Path) -> Record:
        """Read and verify a file.

        Raises:
            RecordError: no record, damaged, or of another version.
            FileNotFoundError: no such file.
        """
        path = Path(path)
        damaged = RecordError(f"{path}: is damaged, or no record; record the run again")
        try:
            with np.load(path, allow_pickle=False) as file:
                said = str(file["format"])
                if said.startswith("fgenv record ") and said != FORMAT:
                    told = f"{path}: is {said!r}, wanted {FORMAT!r}"
                    raise RecordError(f"{told}; use the fgenv that wrote it, or record it again")
                texts = {name: str(file[name]) for name in ("scenario", "about")}
                arrays = {name: file[name] for name in ARRAYS}
                if said != FORMAT or str(file["id"]) != hash_of(texts, arrays):
                    raise damaged
            scenario = Scenario.model_validate(json.loads(texts["scenario"]))
            return cls(scenario.at(path.parent), json.loads(texts["about"]), arrays)
        except (FileNotFoundError, IsADirectoryError, PermissionError, RecordError):
            raise
        except Exception as error:  # zip, zlib, NumPy and JSON each have their own
            raise damaged from error

    def replay(self, threads: int | None = None) -> Simulator:
        """Run it again with its actions, and prove that all comes out the same, bit for bit.

        Returns:
            A simulator at the end of the episode.

        Raises:
            RecordError: mesh files are others, or the first step that differs, and where.
        """
        from .replaying import replayed

        return replayed(self, threads)

    def _check(self) -> None:
        """RecordError where arrays do not fit together."""
        steps, n = len(self.arrays["actions"]), self.n_robots
        for name in ARRAYS:
            array, rows = self.arrays[name], steps + (name in BEFORE)
            if array.shape[:2] != (rows, n) or array.ndim != 2 + (name in WIDE):
                wanted = f"({rows}, {n}{', ...' if name in WIDE else ''})"
                raise RecordError(f"record: {name} has shape {array.shape}, wanted {wanted}")

    def __repr__(self) -> str:
        name = self.scenario.name
        return f"Record({name!r} by {self.policy}: {len(self)} steps, {self.n_robots} robots)"


def hash_of(texts: dict[str, str], arrays: Arrays) -> str:
    """SHA-256 of all that a record says."""
    found = hashlib.sha256(f"{FORMAT}\n".encode())
    for name, text in texts.items():
        found.update(f"{name} {len(text)}\n{text}\n".encode())
    for name, dtype in ARRAYS.items():
        array = np.ascontiguousarray(arrays[name], dtype=dtype)
        found.update(f"{name} {array.shape}\n".encode() + array.tobytes())
    return found.hexdigest()

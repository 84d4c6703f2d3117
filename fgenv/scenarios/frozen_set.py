"""Frozen evaluation sets: cases of one scenario, identical everywhere, identified by a hash.

A set stores the values that differ between cases, which are starts, goals and poses of bodies, as
integers in micrometers or microradians (`int32`), and one scenario as the template of all others.
Its id is the SHA-256 of these numbers, little-endian, and of the template's JSON. The id does not
depend on the machine or on the compression of the file. A set stays readable when a generator
changes.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Ints32
from fgenv.file_kind import FROZEN_SET, other_kind
from fgenv.npz import open_npz
from fgenv.saving import atomic

from .errors import Problem, ScenarioError
from .scenario import Scenario

FORMAT = "fgenv frozen set 1"
MOST = 100_000  # cases
CASES, SEED = 500, 1_000_000  # far from the usual seeds of training
SCALE = 1e6  # numbers in a meter or radian


@dataclass(frozen=True, eq=False)
class FrozenSet:
    """Cases of one scenario. `len`, indexing and iteration give `Scenario`s.

    Attributes:
        template: the first case.
        seeds: (cases,) of the generator. `Scenario.load` with seeds[i] gives case i, until the
            generator changes.
        starts, goals: (cases, numbers), the robots' configurations one after another, 1e-6 m or rad
            (a quaternion's numbers: 1e-6).
        bodies: (cases, bodies, 6), position and rpy, 1e-6 m or rad.
    """

    template: Scenario
    seeds: NDArray[np.int64]
    starts: Ints32
    goals: Ints32
    bodies: Ints32

    def __len__(self) -> int:
        return len(self.seeds)

    def __getitem__(self, i: int) -> Scenario:
        if not -len(self) <= i < len(self):
            raise IndexError(f"case {i} of {len(self)}")
        robots, ends = [], np.cumsum([0, *(len(r.start) for r in self.template.robots)])
        for k, spec in enumerate(self.template.robots):
            part = slice(ends[k], ends[k + 1])
            start, goal = plain(self.starts[i, part]), plain(self.goals[i, part])
            robots.append(spec.model_copy(update={"start": start, "goal": goal}))
        bodies = [
            body.model_copy(update={"position": plain(p[:3]), "rpy": plain(p[3:])})
            for body, p in zip(self.template.bodies, self.bodies[i], strict=True)
        ]
        changes = {"robots": tuple(robots), "bodies": tuple(bodies), "seed": int(self.seeds[i])}
        return self.template.model_copy(update=changes)

    def __iter__(self) -> Iterator[Scenario]:
        return (self[i] for i in range(len(self)))

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The hashed and stored arrays, little-endian."""
        return {
            "seeds": self.seeds.astype("<i8"),
            "starts": self.starts.astype("<i4"),
            "goals": self.goals.astype("<i4"),
            "bodies": self.bodies.astype("<i4"),
        }

    @cached_property
    def id(self) -> str:
        """SHA-256 hash of the set: 64 hexadecimal digits."""
        found = hashlib.sha256(f"{FORMAT}\n{text_of(self.template)}\n".encode())
        for name, array in self.arrays.items():
            found.update(f"{name} {array.shape}\n".encode() + array.tobytes())
        return found.hexdigest()

    def save(self, path: str | Path) -> None:
        """Write a compressed .npz file; an existing file is replaced atomically."""
        with atomic(path) as partial, open(partial, "wb") as file:
            head = {"format": FORMAT, "id": self.id, "template": text_of(self.template)}
            np.savez_compressed(file, **head, **self.arrays)  # type: ignore[arg-type]

    def __repr__(self) -> str:
        name, n = self.template.name, len(self.template.robots)
        return f"FrozenSet({len(self)} cases of {name}, {n} robots, id {self.id[:12]})"


def frozen(
    source: str | Path,
    *,
    cases: int = CASES,
    seed: int = SEED,
    id: str | None = None,
    progress: Callable[[int], object] | None = None,
    **overrides: Any,
) -> FrozenSet:
    """A frozen set from a file, or made from a built-in scenario.

    Args:
        source: a file that `FrozenSet.save` wrote (it ends in .npz), or a built-in scenario's name.
        cases, seed, overrides: of a new set: case i is the scenario with seed + i.
        id: the expected id of the set, or its first digits.
        progress: called with the number of finished cases.

    Raises:
        ScenarioError: damaged file, another id, or an error of `Scenario.load`.
        FileNotFoundError: no such file.
    """
    is_file = Path(source).suffix == ".npz"
    if is_file and overrides:
        raise TypeError(f"overrides: {', '.join(overrides)}, a file of a set takes none")
    found = opened(Path(source)) if is_file else made(str(source), cases, seed, overrides, progress)
    if id is not None and not found.id.startswith(id):
        raise ScenarioError(
            source, [Problem(f"has id {found.id}, expected {id}", "get the set meant")]
        )
    return found


def made(
    name: str,
    cases: int,
    seed: int,
    overrides: dict[str, Any],
    progress: Callable[[int], object] | None = None,
) -> FrozenSet:
    """Generate the cases. Each generator checks its scenario."""
    if not 1 <= cases <= MOST:
        raise ValueError(f"cases: got {cases}, expected 1 to {MOST}")
    every = []
    for i in range(cases):
        every.append(Scenario.load(name, seed=seed + i, **overrides))
        if progress is not None:
            progress(i + 1)
    columns = zip(*(numbers(s) for s in every), strict=True)
    starts, goals, bodies = (np.array(column, dtype=np.int32) for column in columns)
    template, seeds = every[0], np.array([s.seed for s in every], dtype=np.int64)
    result = FrozenSet(template, seeds, starts, goals, bodies.reshape(cases, -1, 6))
    for i, scenario in enumerate(every):
        if result[i] != scenario:
            told = f"case {i} differs from the first in more than places, or has finer numbers"
            raise ScenarioError(name, [Problem(told, "it cannot be frozen")])
    return result


def numbers(scenario: Scenario) -> tuple[list[int], list[int], list[int]]:
    """Starts, goals and poses of bodies in millionths."""
    starts = [x for robot in scenario.robots for x in robot.start]
    goals = [x for robot in scenario.robots for x in robot.goal]
    bodies = [x for body in scenario.bodies for x in (*body.position, *body.rpy)]
    whole = [[round(x * SCALE) for x in values] for values in (starts, goals, bodies)]
    return whole[0], whole[1], whole[2]


def plain(values: Sequence[int] | NDArray[Any]) -> tuple[float, ...]:
    """Millionths as the nearest doubles, equal to those of a file with six decimals."""
    return tuple(float(x) for x in np.asarray(values, dtype=np.float64) / SCALE)


def text_of(template: Scenario) -> str:
    """The template as JSON with sorted keys. Defaults are omitted: a new field keeps all ids."""
    data = template.model_dump(mode="json", exclude_defaults=True)
    return json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=True)


def opened(path: Path) -> FrozenSet:
    """Read and verify a file."""
    damaged = ScenarioError(path, [Problem("is damaged, or no frozen set", "get or make it again")])
    try:
        with open_npz(path) as file:
            if file.text("format") != FORMAT:
                raise damaged
            template = Scenario.model_validate(json.loads(file.text("template")))
            arrays = [file.read(name) for name in ("seeds", "starts", "goals", "bodies")]
            found, said = FrozenSet(template, *arrays), file.text("id")
    except (FileNotFoundError, IsADirectoryError, PermissionError):
        raise
    except Exception as error:  # zip, zlib, NumPy and JSON each have their own
        if other := other_kind(path, FROZEN_SET):
            raise ScenarioError(path, [Problem(other)]) from error
        raise damaged from error
    if found.id != said:
        raise damaged
    return found

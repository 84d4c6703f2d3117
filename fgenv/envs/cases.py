"""The cases of a scenario, each the start and goal of an episode, as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.scenarios import Built, FrozenSet, Scenario, frozen
from fgenv.scenarios.errors import UnknownOverrideError


@dataclass(frozen=True, eq=False)
class Cases:
    """Starts and goals, (cases, nq) per robot, and static bodies with a pose per case.

    Attributes:
        bodies: Indices of these bodies in `Built.shapes`.
        poses: Their poses, (cases, len(bodies), 4, 4).
        frozen_set: The set of the cases; None: there is one case.
    """

    starts: tuple[Floats, ...]
    goals: tuple[Floats, ...]
    bodies: tuple[int, ...] = ()
    poses: Floats | None = None
    frozen_set: FrozenSet | None = None

    def __len__(self) -> int:
        return len(self.starts[0])

    @classmethod
    def of(cls, built: Built, frozen_set: FrozenSet | None) -> Cases:
        """Return the case of a scenario, or those of a frozen set of it."""
        if frozen_set is None:
            return cls(tuple(q[None] for q in built.starts), tuple(q[None] for q in built.goals))
        ends = np.cumsum([len(q) for q in built.starts])[:-1]
        starts, goals = (
            tuple(np.split(numbers / 1e6, ends, axis=1))
            for numbers in (frozen_set.starts, frozen_set.goals)
        )
        moved = np.flatnonzero((frozen_set.bodies != frozen_set.bodies[0]).any(axis=(0, 2)))
        if len(moved) == 0:
            return cls(starts, goals, frozen_set=frozen_set)
        each = [[case.bodies[k].pose for k in moved] for case in frozen_set]
        return cls(starts, goals, tuple(moved.tolist()), np.array(each), frozen_set)


def resolve_scenario(
    source: str | Path | Scenario | FrozenSet, cases: int | None, overrides: dict[str, Any]
) -> tuple[Scenario, FrozenSet | None]:
    """Return a scenario, and its frozen set if episodes have several cases.

    Raises:
        TypeError, ValueError, ScenarioError: with the argument, its value and the expected value.
    """
    if isinstance(source, (FrozenSet, Scenario)):
        if overrides or cases is not None:
            names = ", ".join([*overrides, *(["cases"] if cases is not None else [])])
            raise TypeError(f"overrides: got {names}, expected with the name of a scenario only")
        if isinstance(source, FrozenSet):
            return source.template, source
        return source, None
    if not isinstance(source, (str, Path)):
        kind = type(source).__name__
        raise TypeError(f"scenario: got {kind}, expected a name, a path, a Scenario or a FrozenSet")
    try:
        if Path(source).suffix == ".npz":
            return resolve_scenario(frozen(source, **overrides), cases, {})
        if cases is None:
            return Scenario.load(source, **overrides), None
        frozen_set = frozen(source, cases=cases, **overrides)
    except UnknownOverrideError as error:  # libraries probe for keywords, and read this wording
        name = error.problems[0].where
        raise TypeError(f"got an unexpected keyword argument {name!r} ({error})") from None
    return frozen_set.template, frozen_set

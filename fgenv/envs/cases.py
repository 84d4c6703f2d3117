"""Where episodes begin and end: the cases of a scenario as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.scenarios import Built, FrozenSet, Scenario, frozen


@dataclass(frozen=True, eq=False)
class Cases:
    """Starts and goals, (cases, nq) for each robot; bodies that stand elsewhere in each case.

    Attributes:
        stands: places of those bodies in `Built.shapes`.
        poses: theirs, (cases, len(stands), 4, 4).
        several: the set that they are of; None: there is one case.
    """

    starts: tuple[Floats, ...]
    goals: tuple[Floats, ...]
    stands: tuple[int, ...] = ()
    poses: Floats | None = None
    several: FrozenSet | None = None

    def __len__(self) -> int:
        return len(self.starts[0])

    @classmethod
    def of(cls, built: Built, several: FrozenSet | None) -> Cases:
        """A scenario's own, or those of a frozen set of it."""
        if several is None:
            return cls(tuple(q[None] for q in built.starts), tuple(q[None] for q in built.goals))
        ends = np.cumsum([len(q) for q in built.starts])[:-1]
        starts, goals = (
            tuple(np.split(numbers / 1e6, ends, axis=1))
            for numbers in (several.starts, several.goals)
        )
        moved = np.flatnonzero((several.bodies != several.bodies[0]).any(axis=(0, 2)))
        if len(moved) == 0:
            return cls(starts, goals, several=several)
        each = [[case.bodies[k].pose for k in moved] for case in several]
        return cls(starts, goals, tuple(moved.tolist()), np.array(each), several)


def scenario_of(
    source: str | Path | Scenario | FrozenSet, cases: int | None, overrides: dict[str, Any]
) -> tuple[Scenario, FrozenSet | None]:
    """The scenario meant, and a frozen set of it where episodes have several cases.

    Raises:
        TypeError, ValueError, ScenarioError: saying what does not fit.
    """
    if isinstance(source, (FrozenSet, Scenario)):
        if overrides or cases is not None:
            names = ", ".join([*overrides, *(["cases"] if cases is not None else [])])
            raise TypeError(f"overrides: got {names}, expected with the name of a scenario only")
        several = source if isinstance(source, FrozenSet) else None
        return (several.template if several else source), several  # type: ignore[return-value]
    if not isinstance(source, (str, Path)):
        kind = type(source).__name__
        raise TypeError(f"scenario: got {kind}, expected a name, a path, a Scenario or a FrozenSet")
    if Path(source).suffix == ".npz":
        return scenario_of(frozen(source, **overrides), cases, {})
    if cases is None:
        return Scenario.load(source, **overrides), None
    several = frozen(source, cases=cases, **overrides)
    return several.template, several

"""The frozen sets that ``fgenv bench fleets`` plans."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

METHODS = ("composite", "prioritized", "conflict_based")


@dataclass(frozen=True)
class Fleet:
    """Cases of a scenario, planned by some methods.

    Attributes:
        name: of the row.
        scenario, overrides: for `frozen`.
        limit: seconds per case.
        methods: of `fgenv.planners.METHODS`.
    """

    name: str
    scenario: str
    overrides: dict[str, Any]
    limit: float
    methods: tuple[str, ...] = METHODS
    planner: dict[str, Any] = field(default_factory=dict)


FLEETS = (
    Fleet("swap, 8 long", "swap", {"n": 8, "body": "long", "jitter": 0.1}, 10.0),
    Fleet("swap, 16 long", "swap", {"n": 16, "body": "long", "jitter": 0.1}, 10.0, METHODS[1:]),
    Fleet("doorway, 4", "doorway", {"n": 4}, 10.0),
    Fleet("corridor, 4", "corridor", {"n": 4}, 20.0),
    Fleet("forest, 16", "forest", {"n": 16}, 10.0, METHODS[1:]),
    Fleet("warehouse, 32", "warehouse", {"n": 32}, 20.0, METHODS[1:]),
    Fleet("cell, 2 Pandas", "cell", {"n": 2, "arm": "panda"}, 10.0, METHODS[:1]),
    Fleet("cell, 3 Pandas", "cell", {"n": 3, "arm": "panda"}, 10.0, METHODS[:1]),
    Fleet("cell, 4 Pandas", "cell", {"n": 4, "arm": "panda"}, 10.0, METHODS[:1]),
)


def chosen(which: str) -> tuple[Fleet, ...]:
    """Fleets with one of these words (with commas) in their names; all of `all`.

    Raises:
        ValueError: there is none.
    """
    if which == "all":
        return FLEETS
    words = [word.strip() for word in which.split(",")]
    found = tuple(fleet for fleet in FLEETS if any(word in fleet.name for word in words))
    if not found:
        names = "; ".join(fleet.name for fleet in FLEETS)
        raise ValueError(f"fleets: nothing has {which!r} in its name, expected a part of: {names}")
    return found

"""The frozen sets of ``fgenv bench fleets``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fgenv.bench.common.selection import select, split_names

METHODS = ("composite", "prioritized", "conflict_based")


@dataclass(frozen=True)
class Fleet:
    """Cases of a scenario and the methods that plan them.

    Attributes:
        name: of the row.
        scenario, overrides: arguments of `frozen`.
        limit: seconds per case.
        methods: names from `fgenv.planners.METHODS`.
    """

    name: str
    scenario: str
    overrides: dict[str, Any]
    limit: float
    methods: tuple[str, ...] = METHODS


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


def select_fleets(which: str) -> tuple[Fleet, ...]:
    """Return the fleets for `all`, or for parts of names with commas.

    Raises:
        ValueError: no fleet matches.
    """
    return FLEETS if which == "all" else select(FLEETS, split_names(which), "fleets")

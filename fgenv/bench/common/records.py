"""Records of measurements: plain data for JSON, goals among them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

Record = dict[str, Any]
OWN = "fgenv"


def at_least(expected: float, measured: float) -> Record:
    """Return a goal where more is better."""
    return {"expected": expected, "measured": measured}


def at_most(expected: float, measured: float) -> Record:
    """Return a goal where less is better."""
    return {"expected": expected, "measured": measured, "at_most": True}


def without_own(values: Mapping[str, Any], own: str = OWN) -> dict[str, Any]:
    """Return the values of the other libraries."""
    return {name: value for name, value in values.items() if name != own}


def geometric_means(records: Sequence[Record]) -> dict[str, dict[str, float]]:
    """Return geometric mean and worst value of each entry of `ratio` over the records.

    `build` is a share of time, where the largest value is the worst.
    """
    summary = {}
    for kind in sorted({kind for record in records for kind in record.get("ratio", {})}):
        values = [r["ratio"][kind] for r in records if kind in r.get("ratio", {})]
        worst = max(values) if kind == "build" else min(values)
        summary[kind] = {"mean": float(np.exp(np.mean(np.log(values)))), "worst": worst}
    return summary

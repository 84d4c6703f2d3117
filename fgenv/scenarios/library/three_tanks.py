"""The published experiment."""

from __future__ import annotations

from pathlib import Path

from fgenv.scenarios.registry import builtin
from fgenv.scenarios.scenario import Scenario

FILE = Path(__file__).with_suffix(".yaml")


@builtin(dimension=2)
def three_tanks() -> Scenario:
    """The published experiment: a mobile robot with a fork, a tank in its way, two beside it."""
    return Scenario.load(FILE)

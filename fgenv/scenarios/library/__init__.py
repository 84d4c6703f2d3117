"""Scenarios that come with fgenv: generators, a file each, and scenario files."""

from fgenv.scenarios.registry import ENTRIES, Entry, entry

from . import (
    bug_trap,
    cell,
    corridor,
    cubicles,
    doorway,
    forest,
    home,
    intersection,
    mbm,
    random,
    rings,
    swap,
    three_tanks,
    twist,
    warehouse,
)

__all__ = [
    "ENTRIES",
    "Entry",
    "bug_trap",
    "cell",
    "corridor",
    "cubicles",
    "doorway",
    "entry",
    "forest",
    "home",
    "intersection",
    "mbm",
    "random",
    "rings",
    "swap",
    "three_tanks",
    "twist",
    "warehouse",
]

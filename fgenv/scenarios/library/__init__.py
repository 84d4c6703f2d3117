"""Scenarios that come with fgenv: generators, a file each, and scenario files."""

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
    twist,
    warehouse,
)
from .registry import ENTRIES, Entry, entry

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
    "twist",
    "warehouse",
]

"""Scenarios that come with fgenv: generators, a file each, and scenario files."""

from . import cell, corridor, doorway, forest, intersection, random, swap, warehouse
from .registry import ENTRIES, Entry, entry

__all__ = [
    "ENTRIES",
    "Entry",
    "cell",
    "corridor",
    "doorway",
    "entry",
    "forest",
    "intersection",
    "random",
    "swap",
    "warehouse",
]

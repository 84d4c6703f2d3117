"""Motions at the limit of rounding: flush slides, flush starts and ends, far from the origin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fgenv.arrays import Floats
from fgenv.bench.common.poses import random_rotations
from fgenv.bench.common.solids import (
    Solid,
    angle_iron,
    at,
    bowl,
    box,
    moved,
    opened,
    scaled,
    turned,
)

GAPS = (0.0, 1e-17, 1e-16, 3e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-9, 1e-7, 1e-4)


@dataclass(frozen=True)
class FlushMotion:
    """A part that moves beside a fixed table; poses are in the world frame, lengths in meters."""

    kind: str
    table: Solid
    part: Solid
    table_pose: Floats
    start: Floats
    end: Floats
    tolerance: float = 1e-6


def solids(rng: np.random.Generator) -> tuple[Solid, Solid]:
    """A table with its top at z = 0 and a part with its bottom at z = 0, of under 100 triangles."""
    tables: list[Callable[[], Solid]] = [
        lambda: moved(box(), 0, 0, -0.5),
        lambda: moved(box(3.0, 2.0, 0.1), 0, 0, -0.05),
        lambda: moved(angle_iron(), 0, 0, -1.0),
        lambda: opened(moved(box(), 0, 0, -0.5)),
    ]
    parts: list[Callable[[], Solid]] = [
        lambda: moved(box(), 0, 0, 0.5),
        lambda: angle_iron(),
        lambda: moved(box(0.4, 0.3, 0.2), 0, 0, 0.1),
        lambda: opened(moved(box(), 0, 0, 0.5)),
        lambda: bowl(0.5, 0.1, 6),
    ]
    return tables[rng.integers(len(tables))](), parts[rng.integers(len(parts))]()


def flush_motion(rng: np.random.Generator, kind: str) -> FlushMotion:
    """A motion of one kind, one of KINDS."""
    table, part = solids(rng)
    gap = float(rng.choice(GAPS))
    angle = float(rng.choice([0.0, 0.1, 1.0, 2.0, 3.0])) * float(rng.choice([-1, 1]))
    shift = rng.uniform(-1, 1, 2)
    start, end = at(-shift[0], -shift[1], gap), at(shift[0], shift[1], gap) @ turned(angle)
    frame, tolerance = np.eye(4), 1e-6
    if kind == "apart":
        end[2, 3] += rng.choice([1e-9, 1e-3, 1.0])
    elif kind == "together":
        start[2, 3] += rng.choice([1e-9, 1e-3, 1.0])
    elif kind == "tilt":
        axis = (*rng.normal(size=2), float(rng.choice([0.0, 1.0, 1e3, 1e9])))
        end[:3, :3] = turned(angle, axis)[:3, :3]
    elif kind == "through":
        end[2, 3] -= rng.choice([1e-9, 1e-3, 0.3])
    elif kind == "dip":
        start[2, 3] += 0.2
        end[2, 3] += 0.2
    elif kind == "corner":  # the part slides along two walls
        table = angle_iron(2.0, 0.25)
        part = moved(box(0.3), 0.4, 0.4, 0.5)
        size = 0.0 if rng.random() < 0.5 else float(rng.uniform(0, 1))
        start, end = at(gap, gap, 0), at(gap + size, gap, rng.uniform(-0.2, 0.2))
    elif kind == "far":
        frame = at(*rng.choice([1e6, 1e8, -1e8], 3))
        tolerance = float(rng.choice([1e-9, 1e-8, 1e-7, 1e-6]))
        start, end = at(-2, 0.1, 0.05), at(1, 0.1, 0.05) @ turned(angle)
    if kind in ("turned", "apart", "through") and rng.random() < 0.5:
        frame = at(*rng.normal(size=3))
        frame[:3, :3] = random_rotations(rng, 1)[0]
    size = float(rng.choice([1e-3, 1.0, 1e3])) if kind == "scaled" else 1.0
    start[:3, 3] *= size
    end[:3, 3] *= size
    return FlushMotion(
        kind,
        scaled(table, size),
        scaled(part, size),
        frame,
        frame @ start,
        frame @ end,
        tolerance * size,
    )


KINDS = (
    "slide",
    "turned",
    "apart",
    "together",
    "tilt",
    "through",
    "dip",
    "corner",
    "far",
    "scaled",
)


def flush_motions(seed: int, count: int) -> list[FlushMotion]:
    """A mix of motions of all kinds."""
    rng = np.random.default_rng(seed)
    return [flush_motion(rng, KINDS[i % len(KINDS)]) for i in range(count)]

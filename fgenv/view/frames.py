"""Pictures of a recorded episode, step by step, headless."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from fgenv.view.fleet import FleetPainter
from fgenv.view.movie import Frame

if TYPE_CHECKING:
    from fgenv.envs import Record

GONE = 2  # of a record's status


def steps_shown(record: Record, seconds: float) -> list[int]:
    """Which steps frames that are so long apart show, in real time; the last is the end."""
    every, last = max(1.0, seconds / record.dt), len(record)
    return [*(round(k * every) for k in range(math.ceil((last - 0.5) / every))), last]


def frames_of(
    record: Record, steps: Sequence[int], width: int = 480, height: int = 360
) -> Iterator[Frame]:
    """Frames (height, width, 3) of a record after some of its steps, 0 being before the first."""
    built = record.scenario.build()
    painter = FleetPainter(built, width=width, height=height)
    for step in steps:
        here = record["status"][step] != GONE
        yield painter.paint(record["configurations"][step], built.goals, here)

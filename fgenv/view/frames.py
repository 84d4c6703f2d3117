"""Pictures of a recorded episode, step by step, headless."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from fgenv.view.fleet import FleetPainter
from fgenv.view.meetings import meetings
from fgenv.view.movie import Frame
from fgenv.view.moving import Tripod
from fgenv.view.notes import annotated, check

if TYPE_CHECKING:
    from fgenv.envs import Record

GONE = 2  # of a record's status


def steps_shown(record: Record, seconds: float) -> list[int]:
    """Which steps frames that are so long apart show, in real time; the last is the end."""
    every, last = max(1.0, seconds / record.dt), len(record)
    return [*(round(k * every) for k in range(math.ceil((last - 0.5) / every))), last]


def frames_of(
    record: Record,
    steps: Sequence[int],
    width: int = 480,
    height: int = 360,
    *,
    camera: str = "overview",
    robot: int = 0,
    notes: Sequence[str] = (),
) -> Iterator[Frame]:
    """Frames (height, width, 3) of a record after some of its steps, 0 being before the first.

    Args:
        camera: of `moving.CAMERAS`.
        robot: which one `follow` follows.
        notes: what is written over them: of `notes.NOTES`.

    Raises:
        ValueError: no such camera, robot or note.
    """
    check(notes)
    if not 0 <= robot < record.n_robots:
        raise ValueError(f"robot: {robot}, wanted 0 to {record.n_robots - 1}")
    built, met = record.scenario.build(), meetings(record)
    painter = FleetPainter(built, width=width, height=height)
    tripod = Tripod(camera, built, painter.corners, width, height, robot)
    for step in steps:
        q = record["configurations"][step]
        painter.camera = tripod.at(step * record.dt, q[robot])
        here = record["status"][step] != GONE
        frame = painter.paint(q, built.goals, here)
        if notes:
            frame = annotated(frame, painter.camera, record, built, step, notes, met)
        yield frame

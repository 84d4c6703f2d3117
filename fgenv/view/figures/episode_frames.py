"""Pictures of a recorded episode, step by step, headless."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from fgenv.view.contact_events import meetings
from fgenv.view.figures.annotations import Notes
from fgenv.view.figures.camera_path import Tripod
from fgenv.view.figures.fleet_painter import FleetPainter
from fgenv.view.figures.movie import Frame
from fgenv.view.mask_links import world_at

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
    robot: int | None = None,
    notes: Sequence[str] = (),
    azimuth: float | None = None,
    elevation: float | None = None,
) -> Iterator[Frame]:
    """Frames (height, width, 3) of a record after some of its steps, 0 being before the first.

    Args:
        camera: of `moving.CAMERAS`.
        robot: which one `follow` follows (the first if left out), whose masks alone are drawn.
        notes: what is written over them: of `notes.NOTES`.
        azimuth, elevation: rad, of where `overview` looks from.

    Raises:
        ValueError: no such camera, robot or note, or a camera that looks from elsewhere.
    """
    if robot is not None and not 0 <= robot < record.n_robots:
        raise ValueError(f"robot: got {robot}, expected 0 to {record.n_robots - 1}")
    built, followed = record.scenario.build(), robot or 0
    whose = None if robot is None else [robot]
    over = Notes(record, built, notes, meetings(record), whose)
    painter = FleetPainter(built, width=width, height=height)
    tripod = Tripod(camera, built, painter.corners, width, height, followed, azimuth, elevation)
    for step in steps:
        q = record["configurations"][step]
        painter.camera = tripod.at(step * record.dt, q[followed])
        here = record["status"][step] != GONE
        masked = "masks" in notes
        world = world_at(record, built, step, masked) if masked or "trails" in notes else None
        if world is not None and masked:
            marked = over.candidates(world, step)
            painter.tint({name for name in built.names if int(world.parts(name)[0]) in marked})
        frame = painter.paint(q, built.goals, here)
        yield over.over(frame, painter.camera, step, world) if notes else frame

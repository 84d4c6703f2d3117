"""Frames of a recorded episode, without a display."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from fgenv.envs import Record
from fgenv.envs.contact_events import contact_events
from fgenv.envs.state_readers import GONE
from fgenv.view.figures.annotations import Annotations
from fgenv.view.figures.camera_path import CameraPath
from fgenv.view.figures.movie import Frame
from fgenv.view.figures.scenario_painter import ScenarioPainter
from fgenv.view.mask_links import world_at


def steps_shown(record: Record, seconds: float) -> list[int]:
    """Return the steps for frames at an interval in simulated seconds; the last one is the end."""
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
    """Yield frames (height, width, 3) of a record after some of its steps; 0 is the start.

    Args:
        camera: one of `camera_path.CAMERAS`.
        robot: the robot that `follow` follows (the first if left out). If given, only its mask
            is drawn.
        notes: a selection of `annotations.ANNOTATIONS`.
        azimuth, elevation: rad, direction of the camera `overview`.

    Raises:
        ValueError: an unknown camera, robot or annotation, or an invalid direction.
    """
    if robot is not None and not 0 <= robot < record.n_robots:
        raise ValueError(f"robot: got {robot}, expected 0 to {record.n_robots - 1}")
    built, followed = record.scenario.build(), robot or 0
    mask_robots = None if robot is None else [robot]
    annotations = Annotations(record, built, notes, contact_events(record), mask_robots)
    painter = ScenarioPainter(built, width=width, height=height)
    path = CameraPath(camera, built, painter.corners, width, height, followed, azimuth, elevation)
    masks = "masks" in notes
    for step in steps:
        q = record["configurations"][step]
        painter.camera = path.at(step * record.dt, q[followed])
        world = world_at(record, built, step, masks) if masks or "trails" in notes else None
        if world is not None and masks:
            bodies = annotations.candidates(world, step)
            painter.highlight({n for n in built.names if int(world.parts(n)[0]) in bodies})
        frame = painter.paint(q, built.goals, record["status"][step] != GONE)
        yield annotations.annotate(frame, painter.camera, step, world) if notes else frame

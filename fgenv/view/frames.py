"""Pictures of a recorded episode, step by step, headless."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fgenv.scenarios import Built
from fgenv.view.camera import Camera
from fgenv.view.gallery import GHOST, LIFT, color, corners_of, overview, stone
from fgenv.view.movie import Frame
from fgenv.view.palette import to_srgb
from fgenv.view.shader import render
from fgenv.view.surfaces import Floats, Floor, Solid

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
    """Frames (height, width, 3) of a record after some of its steps, 0 being before the first.

    Robots at their goals are drawn faint. The camera stands still and sees all starts and goals.
    """
    built = record.scenario.build()
    worlds = built.world(), built.world(built.goals)
    corners = np.concatenate([corners_of(world) for world in worlds])
    camera = overview(corners, width, height)
    floor = Floor(height=min(0.0, float(corners[:, 2].min())))
    stand = [Solid(s, p, stone(s.name)) for s, p in zip(built.shapes, built.poses, strict=True)]
    for i in range(len(built.robots)):
        stand += robot_solids(built, i, built.goals[i], GHOST)
    for step in steps:
        solids = list(stand)
        for i, robot in enumerate(built.robots):
            if record["status"][step, i] != GONE:
                q = record["configurations"][step, i, : robot.nq]
                solids += robot_solids(built, i, q, 1.0)
        yield painted(camera, solids, floor)


def robot_solids(built: Built, i: int, q: Floats, opacity: float) -> list[Solid]:
    """The parts of robot i at a configuration (nq,)."""
    links, found = built.robots[i].forward(q), []
    for part in built.robots[i].parts:
        pose = links[part.link] @ part.origin
        pose[2, 3] += (1.0 - opacity) * LIFT  # else it flickers where it lies in another
        found.append(Solid(part.shape, pose, color(i), opacity))
    return found


def painted(camera: Camera, solids: Sequence[Solid], floor: Floor) -> Frame:
    """One frame."""
    pixels, _ = render(camera, solids, floor=floor, samples=1)
    return np.asarray(to_srgb(pixels) * 255 + 0.5, dtype=np.uint8)

"""A scenario of two mesh files: a robot, the world around it, a start and a goal."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fgenv.scenarios import Scenario

SIZES = {3: "planar", 7: "free"}  # how many numbers a configuration of which base has
ROOM = 1.0  # of the robot's size, that it may leave the world's box by


def scenario_of_meshes(
    robot: Path, world: Path | None, start: str, goal: str, scale: float
) -> Scenario:
    """The robot in the world: both in one frame, the robot's mesh about its own origin.

    Args:
        robot, world: mesh files, z up.
        start, goal: "x,y,yaw" of a robot that stays on the floor, or "x,y,z,qx,qy,qz,qw"
            (meters, radians, a unit quaternion).
        scale: factor of both meshes to meters.

    Raises:
        ValueError: numbers that are none, or not that many.
        OSError: a file that cannot be read.
    """
    from fgenv.scenarios import Scenario

    ends = numbers("--start", start), numbers("--goal", goal)
    if len(ends[0]) != len(ends[1]):
        raise ValueError(f"--goal: {len(ends[1])} numbers, --start has {len(ends[0])}")
    if not scale > 0:
        raise ValueError(f"--scale: got {scale}, expected a factor over 0")
    files = {"robot": robot} | ({} if world is None else {"world": world})
    return Scenario.model_validate(
        {
            "version": 1,
            "name": robot.stem,
            "workspace": workspace(robot, world, ends, scale),
            "shapes": {
                name: {"kind": "mesh", "file": os.path.relpath(path), "scale": scale}
                for name, path in files.items()
            },
            "models": {"robot": {"shape": "robot", "base": SIZES[len(ends[0])]}},
            "robots": [{"name": "robot", "model": "robot", "start": ends[0], "goal": ends[1]}],
            "bodies": [] if world is None else [{"name": "world", "shape": "world"}],
        }
    )


def numbers(option: str, text: str) -> tuple[float, ...]:
    """A configuration from the command line; a quaternion is brought to unit length."""
    try:
        found = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        raise ValueError(f"{option}: got {text!r}, expected numbers with commas between") from None
    if len(found) not in SIZES or not np.isfinite(found).all():
        raise ValueError(f"{option}: got {text!r}, expected x,y,yaw or x,y,z,qx,qy,qz,qw")
    if len(found) == 7:
        length = float(np.linalg.norm(found[3:]))
        if abs(length - 1) > 1e-3:
            raise ValueError(f"{option}: quaternion of length {length:.4g}, expected 1")
        found[3:] = [x / length for x in found[3:]]
    return tuple(found)


def workspace(
    robot: Path, world: Path | None, ends: tuple[tuple[float, ...], ...], scale: float
) -> dict[str, list[float]]:
    """The world's box and both ends, and the robot's size around them (m)."""
    from fgenv.collision import Shape

    axes = 3 if len(ends[0]) == 7 else 2
    own = Shape.load(robot, scale=scale).vertices
    places = [np.array([end[:axes] for end in ends])]
    if world is not None:
        places.append(np.asarray(Shape.load(world, scale=scale).vertices)[:, :axes])
    room = ROOM * float(np.ptp(own, axis=0).max())
    corners = np.concatenate(places)
    low, high = corners.min(axis=0) - room, corners.max(axis=0) + room
    return {"low": low.tolist(), "high": high.tolist()}

"""A scenario of two mesh files: a robot and its surroundings, with a start and a goal."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fgenv.scenarios import Scenario
    from fgenv.scenarios.shapes.bodies import MeshFile

UP_AXES = ("z", "y", "x")
BASES = {3: "planar", 7: "free"}  # base by the length of a configuration
ROOM = 1.0  # margin of the workspace around the world's box, in sizes of the robot


def scenario_of_meshes(
    robot: Path, world: Path | None, start: str, goal: str, scale: float, up: str = "z"
) -> Scenario:
    """Return the scenario of a robot in a world; both meshes are in one frame.

    Args:
        robot, world: mesh files.
        start, goal: "x,y,yaw" of a robot on the floor, or "x,y,z,qx,qy,qz,qw" (meters, radians,
            a unit quaternion).
        scale: factor of both meshes to meters.
        up: axis of both meshes that becomes z; y turns (x, y, z) to (x, -z, y).

    Raises:
        ValueError: invalid numbers, or a wrong count.
        OSError: a file cannot be read.
    """
    from fgenv.scenarios import Scenario
    from fgenv.scenarios.shapes.bodies import MeshFile

    ends = numbers("--start", start), numbers("--goal", goal)
    if len(ends[0]) != len(ends[1]):
        raise ValueError(f"--goal: got {len(ends[1])} numbers, expected {len(ends[0])}, as --start")
    if not scale > 0:
        raise ValueError(f"--scale: got {scale}, expected a factor over 0")
    if up not in UP_AXES:
        raise ValueError(f"--up: got {up!r}, expected one of {', '.join(UP_AXES)}")
    files = {"robot": robot} | ({} if world is None else {"world": world})
    forms = {
        name: MeshFile.model_validate(
            {"kind": "mesh", "file": os.path.relpath(path), "scale": scale, "up": up}
        )
        for name, path in files.items()
    }
    return Scenario.model_validate(
        {
            "version": 1,
            "name": robot.stem,
            "workspace": workspace(forms, ends),
            "shapes": {
                name: form.model_dump(exclude_defaults=True) for name, form in forms.items()
            },
            "models": {"robot": {"shape": "robot", "base": BASES[len(ends[0])]}},
            "robots": [{"name": "robot", "model": "robot", "start": ends[0], "goal": ends[1]}],
            "bodies": [] if world is None else [{"name": "world", "shape": "world"}],
        }
    )


def numbers(option: str, text: str) -> tuple[float, ...]:
    """Parse a configuration; a quaternion is normalized."""
    try:
        q = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        raise ValueError(f"{option}: got {text!r}, expected numbers with commas between") from None
    if len(q) not in BASES or not np.isfinite(q).all():
        raise ValueError(f"{option}: got {text!r}, expected x,y,yaw or x,y,z,qx,qy,qz,qw")
    if len(q) == 7:
        length = float(np.linalg.norm(q[3:]))
        if abs(length - 1) > 1e-3:
            raise ValueError(f"{option}: got a quaternion of length {length:.4g}, expected 1")
        q[3:] = [x / length for x in q[3:]]
    return tuple(q)


def workspace(
    forms: dict[str, MeshFile], ends: tuple[tuple[float, ...], ...]
) -> dict[str, list[float]]:
    """Return the corners of the workspace: the world and both ends, with a margin (m)."""
    axes = 3 if len(ends[0]) == 7 else 2
    vertices = {name: np.asarray(form.shape().vertices) for name, form in forms.items()}
    points = [np.array([end[:axes] for end in ends])]
    if "world" in vertices:
        points.append(vertices["world"][:, :axes])
    room = ROOM * float(np.ptp(vertices["robot"], axis=0).max())
    corners = np.concatenate(points)
    low, high = corners.min(axis=0) - room, corners.max(axis=0) + room
    return {"low": low.tolist(), "high": high.tolist()}

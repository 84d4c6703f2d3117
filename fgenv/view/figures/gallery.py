"""The picture of a scenario: robots at their starts, their goals as ghosts, lines between."""

from __future__ import annotations

import numpy as np
from PIL import Image

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.scenarios import Built, Scenario
from fgenv.view.figures.camera import box_corners, overview
from fgenv.view.figures.palette import robot_color, static_color
from fgenv.view.figures.picture import Picture
from fgenv.view.figures.quantize import small
from fgenv.view.figures.surfaces import Floor, Solid

GHOST, LIFT = 0.4, 0.02  # opacity of what is at its goal; meters of marks over the floor
GLASS, CLEAR = "glass", 0.25  # group of bodies that are seen through, and their opacity
RING = np.linspace(0.0, 2 * np.pi, 33)


def draw(scenario: Scenario, width: int = 480, height: int = 360) -> Image.Image:
    """The picture of a scenario, headless: goals are translucent, with a ring on the floor."""
    built = scenario.build()
    worlds = built.world(), built.world(built.goals)
    corners = np.concatenate([corners_of(world) for world in worlds])
    camera = overview(corners, width, height)
    solids = [
        Solid(s, p, static_color(s.name), CLEAR if GLASS in groups else 1.0)
        for s, p, groups in zip(built.shapes, built.poses, built.body_groups, strict=True)
    ]
    for i in range(len(built.robots)):
        for world, opacity in zip(worlds, (1.0, GHOST), strict=True):
            for record in map(world.record, world.parts(built.groups[i][0]).tolist()):
                pose = record.pose.copy()
                pose[2, 3] += (1.0 - opacity) * LIFT  # else it flickers where it lies in another
                solids.append(Solid(record.shape, pose, robot_color(i), opacity))
    picture = Picture(camera, solids, floor=Floor(height=min(0.0, float(corners[:, 2].min()))))
    for i, robot in enumerate(built.robots):
        if robot.base != "fixed":
            mark(picture, built, i)
    return small(picture.image())


def corners_of(world: World) -> Floats:
    """Corners (n, 3) of the boxes of all bodies."""
    boxes = [world.record(int(body)).bounds for body in world.ids]
    return np.concatenate([box_corners(low, high) for low, high in boxes])


def mark(picture: Picture, built: Built, i: int) -> None:
    """A line from start to goal, and a ring around the goal."""
    free = built.robots[i].base == "free"
    ends = np.array(
        [built.robots[i].forward(q)[0, :3, 3] for q in (built.starts[i], built.goals[i])]
    )
    if not free:
        ends[:, 2] = LIFT
    picture.segments(ends, robot_color(i), width=0.9, opacity=0.6, hidden=0.15)
    part = built.robots[i].parts[0].shape.bounds
    radius = 0.5 * float(np.linalg.norm(part[1, :2] - part[0, :2]))
    middle = built.robots[i].forward(built.goals[i])[0] @ [*part.mean(axis=0)[:2], 0.0, 1.0]
    ring = np.column_stack([radius * np.cos(RING), radius * np.sin(RING), np.zeros(33)])
    ring += (middle[0], middle[1], ends[1, 2])
    picture.polyline(ring, robot_color(i), width=1.3, hidden=0.4)

"""The picture of a scenario: robots at their starts, translucent goals, lines between them."""

from __future__ import annotations

import numpy as np
from PIL import Image

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.scenarios import Built, Scenario
from fgenv.view.figures.camera import box_corners, overview
from fgenv.view.figures.palette import robot_color, static_color
from fgenv.view.figures.picture import Picture
from fgenv.view.figures.quantize import quantize
from fgenv.view.figures.surfaces import Floor, Solid

GOAL_OPACITY = 0.4
LIFT = 0.02  # meters from the floor to marks on it
GLASS, GLASS_OPACITY = "glass", 0.25  # group of transparent bodies
CIRCLE = np.linspace(0.0, 2 * np.pi, 33)


def draw_scenario(scenario: Scenario, width: int = 480, height: int = 360) -> Image.Image:
    """Return the picture of a scenario; goals are translucent, with a ring on the floor."""
    built = scenario.build()
    worlds = built.world(), built.world(built.goals)
    corners = np.concatenate([world_corners(world) for world in worlds])
    camera = overview(corners, width, height)
    solids = [*static_solids(built), *robot_solids(built, worlds[0], 1.0)]
    solids += robot_solids(built, worlds[1], GOAL_OPACITY)
    picture = Picture(camera, solids, floor=Floor(height=min(0.0, float(corners[:, 2].min()))))
    for i, robot in enumerate(built.robots):
        if robot.base != "fixed":
            draw_goal(picture, built, i)
    return quantize(picture.image())


def static_solids(built: Built) -> list[Solid]:
    """Return the static bodies of a scenario."""
    return [
        Solid(shape, pose, static_color(shape.name), body_opacity(groups))
        for shape, pose, groups in zip(built.shapes, built.poses, built.body_groups, strict=True)
    ]


def body_opacity(groups: tuple[str, ...]) -> float:
    """Return the opacity of a static body in these groups."""
    return GLASS_OPACITY if GLASS in groups else 1.0


def robot_solids(built: Built, world: World, opacity: float) -> list[Solid]:
    """Return the parts of all robots at their poses in a world."""
    solids = []
    for i, (robot, *_) in enumerate(built.groups):
        for record in map(world.record, world.parts(robot).tolist()):
            pose = record.pose.copy()
            pose[2, 3] += (1.0 - opacity) * LIFT  # coplanar faces would flicker
            solids.append(Solid(record.shape, pose, robot_color(i), opacity))
    return solids


def world_corners(world: World) -> Floats:
    """Return the corners (n, 3) of the boxes of all bodies."""
    boxes = [world.record(int(body)).bounds for body in world.ids]
    return np.concatenate([box_corners(low, high) for low, high in boxes])


def draw_goal(picture: Picture, built: Built, i: int) -> None:
    """Draw a line from a robot's start to its goal, and a ring around the goal."""
    robot = built.robots[i]
    ends = np.array([robot.forward(q)[0, :3, 3] for q in (built.starts[i], built.goals[i])])
    if robot.base != "free":
        ends[:, 2] = LIFT
    picture.segments(ends, robot_color(i), width=0.9, opacity=0.6, hidden=0.15)
    box = robot.parts[0].shape.bounds
    radius = 0.5 * float(np.linalg.norm(box[1, :2] - box[0, :2]))
    center = robot.forward(built.goals[i])[0] @ [*box.mean(axis=0)[:2], 0.0, 1.0]
    ring = np.column_stack([radius * np.cos(CIRCLE), radius * np.sin(CIRCLE), np.zeros(33)])
    ring += (center[0], center[1], ends[1, 2])
    picture.polyline(ring, robot_color(i), width=1.3, hidden=0.4)

"""Geometry of the overlays of a simulator's world: lines or points with a color each."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import World, nearest_points
from fgenv.envs import Simulator
from fgenv.envs.native_config import directions, lidar_of
from fgenv.envs.state_readers import GONE
from fgenv.view.figures.camera import box_corners
from fgenv.view.figures.palette import BLACK, INK, PURPLE, VERMILION, Color, robot_color
from fgenv.view.mask_links import HORIZON, mask_links, set_masks

Drawing = tuple[Floats, list[Color]]  # segments (n, 2, 3) or points (n, 3), meters, and n colors

LIFT = 0.05  # meters from the top of a robot up to the lines of its mask
BOX_EDGES = np.array([(i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit])


@dataclass(frozen=True)
class Snapshot:
    """One of a simulator's worlds after a step.

    Attributes:
        number: of the world.
        q, before: configurations now and a step ago, (robots, nq).
        robot: the robot with visible masks, boxes, rays and clearances; None: all robots.
    """

    simulator: Simulator
    number: int
    q: Floats
    before: Floats
    robot: int | None = None

    @property
    def present(self) -> list[int]:
        """Robots that are in the world."""
        return np.flatnonzero(self.simulator.status[self.number] != GONE).tolist()

    @property
    def selected(self) -> list[int]:
        """Present robots that are shown."""
        return [i for i in self.present if self.robot in (None, i)]

    @cached_property
    def world(self) -> World:
        """A copy of the world, with each robot's mask for the motion of its next second."""
        world = self.simulator.world(self.number)
        change = (self.q - self.before) * (HORIZON / self.simulator.dt)
        set_masks(world, self.simulator.robots, self.present, self.q, change)
        return world


def contact_points(snapshot: Snapshot) -> Drawing:
    """Return the points of the last step's contacts."""
    hit = snapshot.simulator.hits[snapshot.number] >= 0
    return snapshot.simulator.hit_points[snapshot.number][hit], [BLACK] * int(hit.sum())


def clearance_lines(snapshot: Snapshot) -> Drawing:
    """Return the shortest line from each robot to the nearest body."""
    lines = []
    for i in snapshot.selected:
        robot = snapshot.simulator.robots[i]
        clearance = snapshot.world.clearance(robot.name, snapshot.q[i, : robot.nq])
        if int(clearance.body) >= 0:
            lines.append(shortest_line(snapshot.world, robot.name, int(clearance.body)))
    return np.reshape(lines, (-1, 2, 3)), [INK] * len(lines)


def shortest_line(world: World, robot: str, body: int) -> Floats:
    """Return the ends (2, 3) of the shortest line from a robot to a body."""
    other = world.record(body)
    parts = [world.record(part) for part in world.parts(robot).tolist()]
    pairs = [nearest_points(part.shape, part.pose, other.shape, other.pose) for part in parts]
    best = min(pairs, key=lambda pair: float(pair.distance))
    return np.stack([np.asarray(best.point_a), np.asarray(best.point_b)])


def motion_boxes(snapshot: Snapshot) -> Drawing:
    """Return the edges of the boxes that contain each robot during its motion."""
    edges, colors = [], []
    for i in snapshot.selected:
        for low, high in snapshot.world.motion_boxes(snapshot.simulator.names[i]):
            edges.append(box_corners(low, high)[BOX_EDGES])
            colors += [robot_color(i)] * len(BOX_EDGES)
    return np.reshape(edges, (-1, 2, 3)), colors


def mask_lines(snapshot: Snapshot) -> Drawing:
    """Return a line from each robot to each body in its mask.

    The lines of planar robots are drawn above the robot, so that no robot hides them.
    """
    lines, colors = list[Floats](), list[Color]()
    for i in snapshot.selected:
        robot = snapshot.simulator.robots[i]
        own = [line for _, line in mask_links(snapshot.world, robot.name)]
        if robot.base == "planar":
            z = top_of(snapshot.world, robot.name) + LIFT
            own = [np.column_stack([line[:, :2], (z, z)]) for line in own]
        lines += own
        colors += [robot_color(i)] * len(own)
    return np.reshape(lines, (-1, 2, 3)), colors


def top_of(world: World, robot: str) -> float:
    """Return the highest z of a robot's boxes, meters."""
    return max(float(world.record(part).bounds[1, 2]) for part in world.parts(robot).tolist())


def masked_bodies(snapshot: Snapshot) -> set[str]:
    """Return the names of the bodies in the masks of the selected robots."""
    world, names = snapshot.world, snapshot.simulator.names
    bodies = {body for i in snapshot.selected for body in world.candidates(names[i]).tolist()}
    return {world.record(body).name for body in bodies}


def lidar_rays(snapshot: Snapshot) -> Drawing:
    """Return the rays of the robots' last observations."""
    simulator, rays, colors = snapshot.simulator, [np.empty((0, 2, 3))], list[Color]()
    observations = simulator.observe()[snapshot.number].astype(np.float64)
    for i in snapshot.selected:
        spec, robot = simulator.scenario.robots[i], simulator.robots[i]
        lidar = lidar_of(simulator.scenario.models[spec.model].lidar, simulator.observation)
        part = next((p for p in simulator.layouts[i] if p.name == "lidar"), None)
        if lidar is None or part is None:
            continue
        base = robot.forward(snapshot.q[i, : robot.nq], robot.root)
        eye = base[:3, :3] @ np.asarray(lidar.position) + base[:3, 3]
        tips = eye + directions(lidar) @ base[:3, :3].T * observations[i, part.slice, None]
        rays.append(np.stack([np.broadcast_to(eye, tips.shape), tips], axis=1))
        colors += [robot_color(i)] * len(tips)
    return np.concatenate(rays), colors


def feature_points(snapshot: Snapshot) -> Drawing:
    """Return the feature points of all bodies."""
    points = np.concatenate([np.empty((0, 3)), *(p for p, _ in feature_graphs(snapshot.world))])
    return points, [VERMILION] * len(points)


def feature_edges(snapshot: Snapshot) -> Drawing:
    """Return the edges of the feature graphs of all bodies."""
    graphs = feature_graphs(snapshot.world)
    edges = np.concatenate([np.empty((0, 2, 3)), *(points[e] for points, e in graphs)])
    return edges, [PURPLE] * len(edges)


def feature_graphs(world: World) -> list[tuple[Floats, Floats]]:
    """Return each body's feature points (n, 3) in the world frame, and its edges (m, 2)."""
    records = [world.record(body) for body in world.ids.tolist()]
    return [
        (r.feature_points @ r.pose[:3, :3].T + r.pose[:3, 3], np.asarray(r.graph.edges))
        for r in records
    ]

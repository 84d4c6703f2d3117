"""What can be drawn of a moment of a simulator's world, as lines or dots with a color each."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import World, nearest_points
from fgenv.envs import Simulator
from fgenv.envs.native_config import directions, lidar_of
from fgenv.view.figures.palette import BLACK, INK, PURPLE, VERMILION, Color, robot_color
from fgenv.view.mask_links import AHEAD, links, set_masks

Drawn = tuple[Floats, list[Color]]  # segments (n, 2, 3) or points (n, 3), meters, and n colors

GONE = 2  # of a simulator's status
ABOVE = 0.05  # meters that lines of masks are over their robot
ENDS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64)
BOX_EDGES = np.array([(i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit])


@dataclass(frozen=True)
class Moment:
    """One of a simulator's worlds after a step.

    Attributes:
        q, before: configurations now and a step ago, (robots, nq).
        whose: the robot that masks, boxes, rays and clearances are of; all robots if None.
    """

    simulator: Simulator
    number: int
    q: Floats
    before: Floats
    whose: int | None = None

    @property
    def present(self) -> list[int]:
        """Robots that are not gone."""
        return np.flatnonzero(self.simulator.status[self.number] != GONE).tolist()

    @property
    def here(self) -> list[int]:
        """Those of them that are asked for."""
        return [i for i in self.present if self.whose in (None, i)]

    @cached_property
    def world(self) -> World:
        """A copy, with masks set by the motion that each robot goes on with for a second."""
        world = self.simulator.world(self.number)
        by = (self.q - self.before) * (AHEAD / self.simulator.dt)
        set_masks(world, self.simulator.robots, self.present, self.q, by)
        return world


def contacts(moment: Moment) -> Drawn:
    """Points of the last step's contacts."""
    met = moment.simulator.hits[moment.number] >= 0
    return moment.simulator.hit_points[moment.number][met], [BLACK] * int(met.sum())


def clearances(moment: Moment) -> Drawn:
    """The shortest line from each robot to whatever is nearest."""
    ends = []
    for i in moment.here:
        robot = moment.simulator.robots[i]
        found = moment.world.clearance(robot.name, moment.q[i, : robot.nq])
        if int(found.body) >= 0:
            ends.append(shortest(moment.world, robot.name, int(found.body)))
    return np.reshape(ends, (-1, 2, 3)), [INK] * len(ends)


def shortest(world: World, robot: str, body: int) -> Floats:
    """The ends (2, 3) of the shortest line from a robot to a body."""
    other = world.record(body)
    mine = [world.record(part) for part in world.parts(robot).tolist()]
    found = [nearest_points(m.shape, m.pose, other.shape, other.pose) for m in mine]
    best = min(found, key=lambda n: float(n.distance))
    return np.stack([np.asarray(best.point_a), np.asarray(best.point_b)])


def motion_boxes(moment: Moment) -> Drawn:
    """The boxes that hold each robot all along its motion."""
    ends, colors = [], []
    for i in moment.here:
        for low, high in moment.world.motion_boxes(moment.simulator.names[i]):
            ends.append((low + ENDS * (high - low))[BOX_EDGES])
            colors += [robot_color(i)] * len(BOX_EDGES)
    return np.reshape(ends, (-1, 2, 3)), colors


def masks(moment: Moment) -> Drawn:
    """A line from each robot to each body that its mask leaves to be tested.

    Over robots that drive on the floor, where no robot hides it.
    """
    ends, colors = list[Floats](), list[Color]()
    for i in moment.here:
        robot = moment.simulator.robots[i]
        found = [line for _, line in links(moment.world, robot.name)]
        if robot.base == "planar":
            over = top(moment.world, robot.name) + ABOVE
            found = [np.column_stack([line[:, :2], (over, over)]) for line in found]
        ends += found
        colors += [robot_color(i)] * len(found)
    return np.reshape(ends, (-1, 2, 3)), colors


def top(world: World, robot: str) -> float:
    """How high a robot reaches, meters."""
    return max(float(world.record(part).bounds[1, 2]) for part in world.parts(robot).tolist())


def marked(moment: Moment) -> set[str]:
    """Bodies that bear the mask bit of a robot that is asked for."""
    world, names = moment.world, moment.simulator.names
    found = {body for i in moment.here for body in world.candidates(names[i]).tolist()}
    return {world.record(body).name for body in found}


def lidar_rays(moment: Moment) -> Drawn:
    """Rays as the robots' own sensors saw them last."""
    simulator, ends, colors = moment.simulator, [np.empty((0, 2, 3))], list[Color]()
    seen = simulator.observe()[moment.number].astype(np.float64)
    for i in moment.here:
        spec, robot = simulator.scenario.robots[i], simulator.robots[i]
        lidar = lidar_of(simulator.scenario.models[spec.model].lidar, simulator.observation)
        part = next((p for p in simulator.layouts[i] if p.name == "lidar"), None)
        if lidar is None or part is None:
            continue
        base = robot.forward(moment.q[i, : robot.nq], robot.root)
        eye = base[:3, :3] @ np.asarray(lidar.position) + base[:3, 3]
        tips = eye + directions(lidar) @ base[:3, :3].T * seen[i, part.slice, None]
        ends.append(np.stack([np.broadcast_to(eye, tips.shape), tips], axis=1))
        colors += [robot_color(i)] * len(tips)
    return np.concatenate(ends), colors


def feature_points(moment: Moment) -> Drawn:
    """Of all bodies."""
    points = np.concatenate([np.empty((0, 3)), *(p for p, _ in features(moment.world))])
    return points, [VERMILION] * len(points)


def feature_graph(moment: Moment) -> Drawn:
    """The edges that are tested, of all bodies."""
    edges = np.concatenate([np.empty((0, 2, 3)), *(p[e] for p, e in features(moment.world))])
    return edges, [PURPLE] * len(edges)


def features(world: World) -> list[tuple[Floats, Floats]]:
    """Of each body its feature points (n, 3) where they are, and the graph's edges (m, 2)."""
    records = [world.record(body) for body in world.ids.tolist()]
    return [
        (r.feature_points @ r.pose[:3, :3].T + r.pose[:3, 3], np.asarray(r.graph.edges))
        for r in records
    ]

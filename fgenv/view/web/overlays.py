"""Overlays of a live scene that can be switched on: features, masks, rays, clearances, trails."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats
from fgenv.envs import Simulator
from fgenv.view.figures.palette import MARKED, robot_color, static_color
from fgenv.view.robot_poses import base_position

from . import overlay_geometry as geometry
from .line_sets import LineSet, PointSet
from .overlay_geometry import Drawing, Snapshot

if TYPE_CHECKING:
    from viser import SceneApi

    from .scene import ScenarioScene

TRAIL = 150  # steps
LIFT = 0.015  # meters from the floor to trails
GEOMETRY: dict[str, Callable[[Snapshot], Drawing]] = {
    "contact points": geometry.contact_points,
    "clearance lines": geometry.clearance_lines,
    "motion boxes": geometry.motion_boxes,
    "masks": geometry.mask_lines,
    "lidar rays": geometry.lidar_rays,
    "feature points": geometry.feature_points,
    "feature graph": geometry.feature_edges,
}
WIDTHS = {  # of lines, pixels
    "trails": 2.5,
    "clearance lines": 3.0,
    "motion boxes": 2.0,
    "masks": 2.5,
    "lidar rays": 1.2,
    "feature graph": 1.5,
}
SIZES = {"contact points": 0.008, "feature points": 0.003}  # of points, per diagonal of the scene
MAX_DIAGONAL = 13.0  # meters; points do not grow further in larger scenes


class Overlays:
    """Overlays of a simulator's world, by their `NAMES`.

    Attributes:
        on: whether each overlay is shown.
        robot: the robot with visible overlays, as in `Snapshot`.
    """

    NAMES = ("trails", *GEOMETRY)

    def __init__(self, scene: SceneApi, scenario: ScenarioScene, simulator: Simulator) -> None:
        self.scenario, self.simulator = scenario, simulator
        self.on = {name: name in ("trails", "contact points") for name in self.NAMES}
        self.robot: int | None = None
        self._trail: deque[Floats] = deque(maxlen=TRAIL)
        self._before = self._now = np.zeros((simulator.n_robots, 0))
        self._highlighted = False
        size = min(MAX_DIAGONAL, float(np.linalg.norm(scenario.high - scenario.low)))
        self._sets: dict[str, LineSet] = {}
        for name in self.NAMES:
            path = "/drawn/" + name.replace(" ", "_")
            if name in WIDTHS:
                self._sets[name] = LineSet(scene, path, WIDTHS[name])
            else:
                self._sets[name] = PointSet(scene, path, SIZES[name] * size)

    def record_step(self, world: int, begins: bool = False) -> None:
        """Record a step of a world, or the beginning of an episode, which clears the trails."""
        q = self.simulator.configurations[world]
        if begins:
            self._trail.clear()
            self._now = q
        robots = zip(self.simulator.robots, q, strict=True)
        self._trail.append(np.array([base_position(robot, row) for robot, row in robots]))
        self._before, self._now = self._now, q

    def snapshot(self, world: int) -> Snapshot:
        """Return the world at the last recorded step."""
        return Snapshot(self.simulator, world, self._now, self._before, self.robot)

    def draw(self, world: int) -> None:
        """Draw the overlays that are on, and clear the others."""
        snapshot = self.snapshot(world)
        self._highlight(snapshot)
        for name, lines in self._sets.items():
            if not self.on[name]:
                lines.clear()
            elif name == "trails":
                lines.draw(*self._trails())
            else:
                lines.draw(*GEOMETRY[name](snapshot))

    def _trails(self) -> Drawing:
        points = np.array(self._trail)
        for i, robot in enumerate(self.simulator.robots):
            if robot.base == "planar":
                points[:, i, 2] = self.scenario.floor + LIFT
        ends = np.stack([points[:-1], points[1:]], axis=2)
        moved = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=-1) > 1e-6
        return ends[moved], [robot_color(i) for i in np.nonzero(moved)[1].tolist()]

    def _highlight(self, snapshot: Snapshot) -> None:
        """Recolor the static bodies in masks while masks are shown."""
        if not self.on["masks"] and not self._highlighted:
            return
        built = self.scenario.built
        masked = geometry.masked_bodies(snapshot) if self.on["masks"] else set()
        self.scenario.recolor_static(
            [
                MARKED if name in masked else static_color(shape.name)
                for name, shape in zip(built.names, built.shapes, strict=True)
            ]
        )
        self._highlighted = self.on["masks"]

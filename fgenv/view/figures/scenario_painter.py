"""Frames of a scenario at any configurations of its robots, for environments and records."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.scenarios import Built
from fgenv.view.figures.camera import Camera, overview
from fgenv.view.figures.movie import Frame
from fgenv.view.figures.painter import Mark, Painter
from fgenv.view.figures.palette import MARKED, robot_color, static_color
from fgenv.view.figures.scenario_picture import world_corners
from fgenv.view.figures.surfaces import Floor
from fgenv.view.robot_poses import base_position, part_poses


class ScenarioPainter:
    """Paints robots, static bodies, and the goals of mobile bases as rings on the floor.

    The camera sees all starts and goals, and `corners`. It can be replaced at any time.

    Args:
        corners: (n, 3), meters, of more that the camera has to see.
        width, height: pixels.
    """

    def __init__(
        self, built: Built, corners: Floats | None = None, width: int = 480, height: int = 360
    ) -> None:
        self.built = built
        more = [] if corners is None else [corners]
        ends = (world_corners(built.world(q)) for q in (built.starts, built.goals))
        self.corners = np.concatenate([*ends, *more])
        self.camera: Camera = overview(self.corners, width, height)
        self._floor = Floor(height=min(0.0, float(self.corners[:, 2].min())))
        self._radii = [robot.reach[robot.root] for robot in built.robots]
        self._present: list[int] | None = None
        self._highlighted: set[str] = set()

    def highlight(self, names: set[str]) -> None:
        """Paint these static bodies in another color, and only these."""
        if names != self._highlighted:
            self._highlighted, self._present = names, None

    def paint(
        self,
        configurations: Sequence[Floats],
        goals: Sequence[Floats],
        present: Sequence[bool] | None = None,
        poses: Floats | None = None,
    ) -> Frame:
        """Return the frame (height, width, 3), sRGB bytes.

        Args:
            configurations, goals: of each robot, (nq,) or longer.
            present: which robots are painted; all if left out.
            poses: of the static bodies, (m, 4, 4); the scenario's own if left out.
        """
        n = len(self.built.robots)
        shown = [i for i in range(n) if present is None or present[i]]
        if shown != self._present:
            self._present, self._painter = shown, self._painter_of(shown)
        moved = [
            pose for i in shown for pose in part_poses(self.built.robots[i], configurations[i])
        ]
        static = self.built.poses if poses is None else poses
        self._painter.camera = self.camera
        marks = [mark for i in shown if (mark := self._mark(i, goals[i])) is not None]
        return self._painter.paint(np.concatenate([static, np.reshape(moved, (-1, 4, 4))]), marks)

    def _painter_of(self, robots: list[int]) -> Painter:
        parts = [
            (part.shape, robot_color(i)) for i in robots for part in self.built.robots[i].parts
        ]
        shapes = [*self.built.shapes, *(shape for shape, _ in parts)]
        static_colors = [
            MARKED if name in self._highlighted else static_color(shape.name)
            for name, shape in zip(self.built.names, self.built.shapes, strict=True)
        ]
        colors = [*static_colors, *(color for _, color in parts)]
        return Painter(shapes, colors, self.camera, floor=self._floor)

    def _mark(self, i: int, goal: Floats) -> Mark | None:
        robot = self.built.robots[i]
        if robot.base == "fixed":
            return None
        x, y, _ = base_position(robot, goal).tolist()
        return Mark(x, y, self._radii[i], robot_color(i))

"""Pictures of a scenario's robots wherever they are: what environments and records are drawn by."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots.limits import reaches
from fgenv.scenarios import Built
from fgenv.view.figures.camera import Camera, overview
from fgenv.view.figures.gallery import corners_of
from fgenv.view.figures.movie import Frame
from fgenv.view.figures.painter import Mark, Painter
from fgenv.view.figures.palette import MARKED, robot_color, static_color
from fgenv.view.figures.surfaces import Floor


class FleetPainter:
    """Draws robots and what stands around, goals of bases that move as rings on the floor.

    The camera sees all starts and goals, and `corners`; another one may be set at any time.

    Args:
        corners: (n, 3), meters, of more that is to be seen.
        width, height: pixels.
    """

    def __init__(
        self, built: Built, corners: Floats | None = None, width: int = 480, height: int = 360
    ) -> None:
        self.built = built
        more = [] if corners is None else [corners]
        ends = (corners_of(built.world(q)) for q in (built.starts, built.goals))
        self.corners = every = np.concatenate([*ends, *more])
        self.camera: Camera = overview(every, width, height)
        self._floor = Floor(height=min(0.0, float(every[:, 2].min())))
        self._radii = [reaches(robot)[robot.root] for robot in built.robots]
        self._here: list[int] | None = None
        self._tinted: set[str] = set()

    def tint(self, names: set[str]) -> None:
        """Draw those bodies that stand in another color, and only those."""
        if names != self._tinted:
            self._tinted, self._here = names, None

    def paint(
        self,
        configurations: Sequence[Floats],
        goals: Sequence[Floats],
        here: Sequence[bool] | None = None,
        poses: Floats | None = None,
    ) -> Frame:
        """The frame (height, width, 3), sRGB bytes.

        Args:
            configurations, goals: of each robot, (nq,) or longer.
            here: which robots are there; all if left out.
            poses: of the static bodies, (m, 4, 4), where they are not the scenario's own.
        """
        n = len(self.built.robots)
        present = [i for i in range(n) if here is None or here[i]]
        if present != self._here:
            self._here, self._painter = present, self._painter_of(present)
        moved = [p for i in present for p in self._parts(i, configurations[i])]
        stand = self.built.poses if poses is None else poses
        self._painter.camera = self.camera
        marks = [mark for i in present if (mark := self._mark(i, goals[i])) is not None]
        return self._painter.paint(np.concatenate([stand, np.reshape(moved, (-1, 4, 4))]), marks)

    def _painter_of(self, present: list[int]) -> Painter:
        robots = [
            (part.shape, robot_color(i)) for i in present for part in self.built.robots[i].parts
        ]
        shapes = [*self.built.shapes, *(shape for shape, _ in robots)]
        stone = [
            MARKED if name in self._tinted else static_color(shape.name)
            for name, shape in zip(self.built.names, self.built.shapes, strict=True)
        ]
        colors = [*stone, *(color for _, color in robots)]
        return Painter(shapes, colors, self.camera, floor=self._floor)

    def _parts(self, i: int, q: Floats) -> list[Floats]:
        robot = self.built.robots[i]
        links = robot.forward(q[: robot.nq])
        return [links[part.link] @ part.origin for part in robot.parts]

    def _mark(self, i: int, goal: Floats) -> Mark | None:
        robot = self.built.robots[i]
        if robot.base == "fixed":
            return None
        x, y = robot.forward(goal[: robot.nq], robot.root)[:2, 3].tolist()
        return Mark(x, y, self._radii[i], robot_color(i))

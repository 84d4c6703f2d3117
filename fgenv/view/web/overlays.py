"""What is drawn over a live scene on demand: features, masks, rays, clearances, trails..."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats
from fgenv.envs import Simulator
from fgenv.view.figures.palette import MARKED, robot_color, static_color

from . import drawings
from .drawings import Drawn, Moment
from .line_sets import Dots, Lines

if TYPE_CHECKING:
    from viser import SceneApi

    from .scenery import Scenery

TRAIL = 150  # steps
LIFT = 0.015  # meters that trails are over the floor
WIDTHS = {  # pixels
    "trails": 2.5,
    "clearance lines": 3.0,
    "motion boxes": 2.0,
    "masks": 2.5,
    "lidar rays": 1.2,
    "feature graph": 1.5,
}
SIZES = {"contact points": 0.008, "feature points": 0.003}  # of the scene's diagonal


class Overlays:
    """Drawings of a simulator's world that can be switched on and off, by their `NAMES`."""

    NAMES = (
        "trails",
        "contact points",
        "clearance lines",
        "motion boxes",
        "masks",
        "lidar rays",
        "feature points",
        "feature graph",
    )

    def __init__(self, scene: SceneApi, scenery: Scenery, simulator: Simulator) -> None:
        self.scenery, self.simulator = scenery, simulator
        self.on = {name: name in ("trails", "contact points") for name in self.NAMES}
        self.whose: int | None = None  # the robot that these are of, as in `Moment`
        self._trail: deque[Floats] = deque(maxlen=TRAIL)
        self._before = self._now = np.zeros((simulator.n_robots, 0))
        self._tinted = False
        size = min(13.0, float(np.linalg.norm(scenery.high - scenery.low)))
        self._ink: dict[str, Lines | Dots] = {}
        for name in self.NAMES:
            place = "/drawn/" + name.replace(" ", "_")
            if name in WIDTHS:
                self._ink[name] = Lines(scene, place, WIDTHS[name])
            else:
                self._ink[name] = Dots(scene, place, SIZES[name] * size)
        self._drawings: dict[str, Callable[[Moment], Drawn]] = {
            "trails": lambda _: self._trails(),
            "contact points": drawings.contacts,
            "clearance lines": drawings.clearances,
            "motion boxes": drawings.motion_boxes,
            "masks": drawings.masks,
            "lidar rays": drawings.lidar_rays,
            "feature points": drawings.feature_points,
            "feature graph": drawings.feature_graph,
        }

    def note(self, world: int, begins: bool = False) -> None:
        """A step was made; or an episode begins, and nothing lies behind."""
        q = self.simulator.configurations[world]
        if begins:
            self._trail.clear()
            self._now = q
        points = [
            robot.forward(row[: robot.nq], robot.root)[:3, 3]
            for robot, row in zip(self.simulator.robots, q, strict=True)
        ]
        self._trail.append(np.array(points))
        self._before, self._now = self._now, q

    def moment(self, world: int) -> Moment:
        """A world as it was noted last."""
        return Moment(self.simulator, world, self._now, self._before, self.whose)

    def draw(self, world: int) -> None:
        """All that is on; what is off is wiped away."""
        moment = self.moment(world)
        self._tint(moment)
        for name, ink in self._ink.items():
            if self.on[name]:
                ink.draw(*self._drawings[name](moment))
            else:
                ink.wipe()

    def _trails(self) -> Drawn:
        points = np.array(self._trail)
        for i, robot in enumerate(self.simulator.robots):
            if robot.base == "planar":
                points[:, i, 2] = self.scenery.floor + LIFT
        ends = np.stack([points[:-1], points[1:]], axis=2)
        moved = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=-1) > 1e-6
        return ends[moved], [robot_color(i) for i in np.nonzero(moved)[1].tolist()]

    def _tint(self, moment: Moment) -> None:
        """What stands and bears a mask bit in another color, where masks are shown."""
        if not self.on["masks"] and not self._tinted:
            return
        built = self.scenery.built
        colors = [static_color(shape.name) for shape in built.shapes]
        if self.on["masks"]:
            found = drawings.marked(moment)
            colors = [
                MARKED if name in found else color
                for name, color in zip(built.names, colors, strict=True)
            ]
        self.scenery.paint_standing(colors)
        self._tinted = self.on["masks"]

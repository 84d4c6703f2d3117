"""Pictures of a simulator's worlds: one place for all faces' `render`."""

from __future__ import annotations

import itertools
import warnings
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fgenv.collision import World

if TYPE_CHECKING:
    from fgenv.view import Camera, Solid

    from .simulator import Simulator

Frame = NDArray[np.uint8]

MODES = ["human", "rgb_array"]
WIDTH, HEIGHT = 480, 360


class Screen:
    """What a face shows in its render mode.

    Raises:
        ValueError: no such mode.
    """

    def __init__(self, simulator: Simulator, mode: str | None) -> None:
        if mode not in (None, *MODES):
            raise ValueError(f"render_mode: {mode!r}, wanted {', '.join(MODES)} or None")
        self.simulator, self.mode = simulator, mode

    def show(self, world: int = 0) -> Frame | None:
        """The frame (height, width, 3) of a world in mode `rgb_array`, else None."""
        if self.mode == "rgb_array":
            return self.renderer.frame(world)
        told = "'human' shows nothing yet" if self.mode else "none was given"
        warnings.warn(f"render_mode: {told}; 'rgb_array' gives pictures", stacklevel=3)
        return None

    @cached_property
    def renderer(self) -> Renderer:
        """Made when it is first needed."""
        return Renderer(self.simulator)


class Renderer:
    """Draws worlds as they are: robots, what stands around, goals as ghosts; no display needed."""

    def __init__(self, simulator: Simulator) -> None:
        self.simulator = simulator
        self._camera: Camera | None = None

    def frame(self, world: int = 0) -> Frame:
        """sRGB (360, 480, 3); the camera stays where it was for the first frame."""
        from fgenv.view import Floor, render
        from fgenv.view.gallery import corners_of, overview
        from fgenv.view.palette import to_srgb

        now, goals = self._worlds(world)
        if self._camera is None:
            corners = np.concatenate([corners_of(now), corners_of(goals), *self._far()])
            self._camera = overview(corners, WIDTH, HEIGHT)
            self._ground = min(0.0, float(corners[:, 2].min()))
        floor = Floor(height=self._ground)
        color, _ = render(self._camera, self._solids(now, goals), floor=floor, shadows=False)
        return (to_srgb(color) * 255 + 0.5).astype(np.uint8)

    def _far(self) -> list[NDArray[np.float64]]:
        """Corners of where later episodes may be, (n, 3)."""
        space, simulator = self.simulator.scenario.workspace, self.simulator
        if space is None or (simulator.starts == "scenario" and len(simulator.cases) == 1):
            return []
        ends = [*zip(space.low, space.high, strict=True), (0.0, 0.0)][:3]
        return [np.array(list(itertools.product(*ends)))]

    def _worlds(self, world: int) -> tuple[World, World]:
        """As it is, and with all at their goals."""
        now, goals = self.simulator.world(world), self.simulator.world(world)
        wanted = self.simulator.goals[world]
        for i, robot in enumerate(self.simulator.robots):
            if robot.name in goals.names:
                goals.set_configuration(robot.name, wanted[i, : robot.nq])
        return now, goals

    def _solids(self, now: World, goals: World) -> list[Solid]:
        from fgenv.view import Solid
        from fgenv.view.gallery import GHOST, LIFT, color, stone

        parts: set[int] = set()
        solids: list[Solid] = []
        for i, robot in enumerate(self.simulator.robots):
            if robot.name not in now.names:
                continue  # gone
            ids = now.parts(robot.name).tolist()
            parts.update(ids)
            for seen, opacity, lift in ((now, 1.0, 0.0), (goals, GHOST, LIFT)):
                for record in map(seen.record, ids):
                    pose = record.pose.copy()
                    pose[2, 3] += lift  # else it flickers where it lies in another
                    solids.append(Solid(record.shape, pose, color(i), opacity))
        stand = [now.record(int(body)) for body in now.ids if int(body) not in parts]
        return [Solid(r.shape, r.pose, stone(r.shape.name)) for r in stand] + solids

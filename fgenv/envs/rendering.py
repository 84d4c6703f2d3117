"""Pictures of a simulator's worlds: one place for all faces' `render`."""

from __future__ import annotations

import itertools
import warnings
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .readings import GONE

if TYPE_CHECKING:
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
    """Draws worlds as they are: robots, what stands around, rings where goals are."""

    def __init__(self, simulator: Simulator) -> None:
        from fgenv.view.fleet import FleetPainter

        self.simulator = simulator
        self._painter = FleetPainter(simulator.built, self._far())

    def frame(self, world: int = 0) -> Frame:
        """sRGB (360, 480, 3)."""
        simulator = self.simulator
        if not simulator.begun:
            raise RuntimeError("render: before the first reset, call reset()")
        here = (simulator.status[world] != GONE).tolist()
        poses = simulator.standing_poses(world)
        return self._painter.paint(
            simulator.configurations[world], simulator.goals[world], here, poses
        )

    def _far(self) -> NDArray[np.float64] | None:
        """Corners of where later episodes may be, (n, 3)."""
        space, simulator = self.simulator.scenario.workspace, self.simulator
        if space is None or (simulator.starts == "scenario" and len(simulator.cases) == 1):
            return None
        ends = [*zip(space.low, space.high, strict=True), (0.0, 0.0)][:3]
        return np.array(list(itertools.product(*ends)))

"""Pictures of a simulator's worlds: one place for all faces' `render`."""

from __future__ import annotations

import itertools
import os
import sys
import warnings
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .state_readers import GONE

if TYPE_CHECKING:
    from fgenv.view.web.live import Live

    from .simulator import Simulator

Frame = NDArray[np.uint8]

MODES = ["human", "rgb_array"]
WIDTH, HEIGHT = 480, 360


class Screen:
    """What a face shows in its render mode.

    In mode `human` the first picture starts a live view in the browser, at port FGENV_VIEW_PORT
    (8080 if not set; 0: any that is free); stderr says where. Each picture then takes as long as
    its step would, at the speed that is chosen there, and waits where it is paused there.

    Raises:
        ValueError: no such mode.
    """

    def __init__(self, simulator: Simulator, mode: str | None) -> None:
        if mode not in (None, *MODES):
            raise ValueError(f"render_mode: got {mode!r}, expected {', '.join(MODES)} or None")
        self.simulator, self.mode = simulator, mode
        self.live: Live | None = None
        self._episode: tuple[int, int, int] | None = None

    def show(self, world: int = 0) -> Frame | None:
        """The frame (height, width, 3) of a world in mode `rgb_array`, else None.

        Raises:
            RuntimeError: before the first reset.
            ImportError: `human` wants viser, with the remedy.
            ValueError: its port is taken.
        """
        if self.mode == "rgb_array":
            return self.renderer.frame(world)
        if self.mode is None:
            told = "render_mode: none was given; 'rgb_array' gives pictures, 'human' a live view"
            warnings.warn(told, stacklevel=3)
            return None
        self._live(world)
        return None

    def close(self) -> None:
        """End the live view, if there is one."""
        if self.live is not None:
            self.live.close()
        self.live = None

    def _live(self, world: int) -> None:
        simulator = self.simulator
        if not simulator.begun:
            raise RuntimeError("render: before the first reset, call reset()")
        if self.live is None:
            from fgenv.view.web.live import Live

            self.live = Live(simulator, view_port(), far(simulator))
            print(f"fgenv: live view at {self.live.url}", file=sys.stderr)
        episode = int(simulator.seeds[world]), int(simulator.episodes[world]), world
        if simulator.steps[world] == 0 or episode != self._episode:
            self.live.begin(world)
        else:
            self.live.show(world)
        self._episode = episode

    def __getstate__(self) -> dict[str, Any]:
        """Of a copy, which shows nothing yet."""
        return {"simulator": self.simulator, "mode": self.mode, "live": None, "_episode": None}

    @cached_property
    def renderer(self) -> Renderer:
        """Made when it is first needed."""
        return Renderer(self.simulator)


class Renderer:
    """Draws worlds as they are: robots, what stands around, rings where goals are."""

    def __init__(self, simulator: Simulator) -> None:
        from fgenv.view.figures.fleet_painter import FleetPainter

        self.simulator = simulator
        self._painter = FleetPainter(simulator.built, far(simulator))

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


def far(simulator: Simulator) -> NDArray[np.float64] | None:
    """Corners of where later episodes may be, (n, 3)."""
    space = simulator.scenario.workspace
    if space is None or (simulator.starts == "scenario" and len(simulator.cases) == 1):
        return None
    ends = [*zip(space.low, space.high, strict=True), (0.0, 0.0)][:3]
    return np.array(list(itertools.product(*ends)))


def view_port() -> int:
    """The port of live views, from the environment."""
    text = os.environ.get("FGENV_VIEW_PORT", "8080")
    try:
        return int(text)
    except ValueError:
        raise ValueError(f"FGENV_VIEW_PORT: got {text!r}, expected a port, 0 to 65535") from None

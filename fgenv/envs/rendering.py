"""Rendering of worlds, shared by the `render` methods of all environments."""

from __future__ import annotations

import itertools
import os
import sys
import warnings
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.registry import RENDERERS, load

from .state_readers import GONE

if TYPE_CHECKING:
    from .simulator import Simulator

Frame = NDArray[np.uint8]

MODES = ["human", "rgb_array"]
WIDTH, HEIGHT = 480, 360


class FramePainter(Protocol):
    """Paints frames; `RENDERERS["rgb_array"]` makes it of (built scenario, corners to show)."""

    def paint(
        self,
        configurations: Sequence[Floats],
        goals: Sequence[Floats],
        present: Sequence[bool] | None = None,
        poses: Floats | None = None,
    ) -> Frame:
        """Return the frame (height, width, 3), sRGB, of robots at configurations."""


class LiveView(Protocol):
    """Shows a world live; `RENDERERS["human"]` makes it of (simulator, port, corners to show)."""

    @property
    def url(self) -> str:
        """Address of the view."""

    def begin(self, world: int = 0) -> None:
        """Show the start of an episode."""

    def show(self, world: int = 0) -> None:
        """Show the current step, for as long as the step lasts."""

    def close(self) -> None:
        """End the view."""


class Screen:
    """Renders the worlds of a simulator in one render mode.

    In mode `human` the first call starts a live view in the browser, at port FGENV_VIEW_PORT
    (default 8080; 0: any free port), and prints its address to stderr. Each call then takes as long
    as its step, at the speed selected in the view, and waits while the view is paused.

    Raises:
        ValueError: unknown mode.
    """

    def __init__(self, simulator: Simulator, mode: str | None) -> None:
        if mode not in (None, *MODES):
            raise ValueError(f"render_mode: got {mode!r}, expected {', '.join(MODES)} or None")
        self.simulator, self.mode = simulator, mode
        self.live: LiveView | None = None
        self._episode: tuple[int, int, int] | None = None

    def show(self, world: int = 0) -> Frame | None:
        """Return the frame (height, width, 3) of a world in mode `rgb_array`, else None.

        Raises:
            RuntimeError: before the first reset.
            ImportError: mode `human` without viser.
            ValueError: the port is taken.
        """
        if self.mode is None:
            message = "render_mode: got None, expected 'rgb_array' for frames or 'human' to watch"
            warnings.warn(message, stacklevel=3)
            return None
        if not self.simulator.begun:
            raise RuntimeError("render: before the first reset, call reset()")
        if self.mode == "rgb_array":
            return self._frame(world)
        self._show_live(world)
        return None

    def close(self) -> None:
        """End the live view, if there is one."""
        if self.live is not None:
            self.live.close()
        self.live = None

    def _frame(self, world: int) -> Frame:
        simulator = self.simulator
        here = (simulator.status[world] != GONE).tolist()
        poses = simulator.static_poses(world)
        return self._painter.paint(
            simulator.configurations[world], simulator.goals[world], here, poses
        )

    def _show_live(self, world: int) -> None:
        simulator = self.simulator
        if self.live is None:
            make = load(RENDERERS["human"])
            live: LiveView = make(simulator, view_port(), workspace_corners(simulator))
            self.live = live
            print(f"fgenv: live view at {live.url}", file=sys.stderr)
        episode = int(simulator.seeds[world]), int(simulator.episodes[world]), world
        if simulator.steps[world] == 0 or episode != self._episode:
            self.live.begin(world)
        else:
            self.live.show(world)
        self._episode = episode

    def __getstate__(self) -> dict[str, Any]:
        """State of a copy, without the view."""
        return {"simulator": self.simulator, "mode": self.mode, "live": None, "_episode": None}

    @cached_property
    def _painter(self) -> FramePainter:
        make = load(RENDERERS["rgb_array"])
        painter: FramePainter = make(self.simulator.built, workspace_corners(self.simulator))
        return painter


def workspace_corners(simulator: Simulator) -> Floats | None:
    """Return corners of the workspace (n, 3), m; None if all episodes share starts and goals."""
    space = simulator.scenario.workspace
    if space is None or (simulator.settings.starts == "scenario" and len(simulator.cases) == 1):
        return None
    ends = [*zip(space.low, space.high, strict=True), (0.0, 0.0)][:3]
    return np.array(list(itertools.product(*ends)))


def view_port() -> int:
    """Return the port of live views, from the environment variable FGENV_VIEW_PORT."""
    text = os.environ.get("FGENV_VIEW_PORT", "8080")
    try:
        return int(text)
    except ValueError:
        raise ValueError(f"FGENV_VIEW_PORT: got {text!r}, expected a port, 0 to 65535") from None

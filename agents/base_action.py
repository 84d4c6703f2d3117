"""What is added to, or takes the place of, what a trained network asks for: `goto`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fgenv.envs import View
from fgenv.envs.simulator import Floats, Rows


@dataclass(frozen=True)
class BaseAction:
    """How a network's output becomes the action.

    Residual learning (T. Silver et al., "Residual policy learning", 2018): what is known, to go
    straight to the goal or along the path, need not be learned; what is learned is to avoid.

    Attributes:
        near: metres from the goal (of a fixed base: radians of all joints together) at which
            `goto` takes over; 0: it never does.
        residual: if over 0, the action is that of `goto` plus so many times the output, both
            brought to [-1, 1]. Where robots observe a path hint, `goto` follows it.
    """

    near: float = 0.0
    residual: float = 0.0

    def actions(self, asked: Floats, view: View, observations: Rows) -> Floats:
        """Actions (worlds, robots, size) from outputs, alike, and what robots observe."""
        asked = np.clip(np.asarray(asked, dtype=np.float64), -1.0, 1.0)
        if self.residual > 0:
            along = np.clip(view.toward(targets(view, observations)), -1.0, 1.0)
            asked = np.clip(along + self.residual * asked, -1.0, 1.0)
        if self.near > 0:
            home = (view.remaining < self.near)[..., None]
            asked = np.where(home, view.toward(view.goals), asked)
        return asked


def targets(view: View, observations: Rows) -> Floats:
    """The goals, (worlds, robots, nq); on planar bases that observe a path hint, that point."""
    found = view.goals
    for i, (robot, parts) in enumerate(zip(view.robots, view.layouts, strict=True)):
        hint = next((part.slice for part in parts if part.name == "path_hint"), None)
        if hint is None or robot.base != "planar":
            continue
        base = robot.forward(view.configurations[:, i, : robot.nq], 0)
        x, y = np.moveaxis(observations[:, i, hint].astype(np.float64), -1, 0)
        for k in range(2):
            found[:, i, k] = base[:, k, 0] * x + base[:, k, 1] * y + base[:, k, 3]
    return found

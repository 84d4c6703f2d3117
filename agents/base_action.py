"""What is added to, or takes the place of, what a trained network asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from fgenv.agents.following import targets
from fgenv.agents.orca import Orca
from fgenv.agents.seeing import Seeing
from fgenv.envs import View
from fgenv.envs.simulator import Floats, Rows


NEUTRAL = 0.5  # pace of an output of nothing: exploring from the fastest, one could only slow down


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
        orca: the residual is added to the velocity of the base on the plane that `Orca` wants (its
            first two numbers: ahead and to the left, times the speed), and what it then does about
            others is the action: the network decides where to, and ORCA avoids.
        pace: the first number alone counts, and says how fast `goto` drives: its speeds times
            `NEUTRAL` plus the residual, -1 (back) to 1. Whoever keeps to its path meets no wall; when to
            wait is learned (path-velocity decomposition: K. Kant, S. W. Zucker, "Toward efficient
            trajectory planning", 1986).
    """

    near: float = 0.0
    residual: float = 0.0
    orca: bool = False
    pace: bool = False

    @classmethod
    def of(cls, about: Mapping[str, Any]) -> BaseAction:
        """From what a file says; what it does not say is as it is by default."""
        return cls(**{of.name: about[of.name] for of in fields(cls) if of.name in about})


class Acting(Seeing):
    """Makes actions of outputs, in the simulator of a view."""

    def __init__(self, base: BaseAction) -> None:
        self.base = base
        self._orca = Orca.guided() if base.orca else None

    def reset(self, view: View) -> None:
        """Episodes begin.

        Raises:
            ValueError: with `orca`, a robot has no planar base.
        """
        super().reset(view)
        if self._orca is not None:
            self._orca.reset(view)
        size = max(len(robot.actions) for robot in view.robots)
        self._speeds = np.zeros((view.n_robots, size), dtype=bool)
        for i, robot in enumerate(view.robots):
            self._speeds[i, : len(robot.actions)] = [a.unit == "m/s" for a in robot.actions]

    def actions(self, asked: Floats, observations: Rows) -> Floats:
        """Actions (worlds, robots, size) from outputs, alike, and what robots observe."""
        view, base = self.view, self.base
        asked = np.clip(np.asarray(asked, dtype=np.float64), -1.0, 1.0)
        home = (view.remaining < base.near)[..., None]
        if self._orca is not None:
            more = np.where(home, 0.0, base.residual * asked[..., :2])
            return self._orca.toward(targets(view, observations), observations, more)
        if base.residual > 0:
            along = np.clip(view.toward(targets(view, observations)), -1.0, 1.0)
            more = base.residual * asked
            if base.pace:
                pace = np.clip(NEUTRAL + more[..., :1], -1.0, 1.0)
                asked = np.where(self._speeds, pace * along, along)
            else:
                asked = np.clip(along + more, -1.0, 1.0)
        return np.where(home, view.toward(view.goals), asked) if base.near > 0 else asked

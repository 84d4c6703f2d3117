"""What is added to, or takes the place of, what a trained network asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from fgenv.agents.policies.observation import Seeing
from fgenv.agents.policies.orca import Orca
from fgenv.agents.tracking.velocity_tracking import targets
from fgenv.arrays import Floats, Floats32
from fgenv.envs import View


@dataclass(frozen=True)
class BaseAction:
    """How a network's output becomes the action.

    Residual learning (T. Silver et al., "Residual policy learning", 2018): what is known, to go
    straight to the goal or along the path, need not be learned; what is learned is to avoid.

    Attributes:
        near: meters from the goal (of a fixed base: radians of all joints together) at which
            `goto` takes over; 0: it never does.
        residual: if over 0, the action is that of `goto` plus so many times the output, both
            brought to [-1, 1]. Where robots observe a path hint, `goto` follows it.
        orca: the residual is added to the velocity of the base on the plane that `Orca` wants (its
            first two numbers: ahead and to the left, times the speed), and what it then does about
            others is the action: the network decides where to, and ORCA avoids.
    """

    near: float = 0.0
    residual: float = 0.0
    orca: bool = False

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

    def actions(self, asked: Floats, observations: Floats32) -> Floats:
        """Actions (worlds, robots, size) from outputs, alike, and what robots observe."""
        view, base = self.view, self.base
        asked = np.clip(np.asarray(asked, dtype=np.float64), -1.0, 1.0)
        home = (view.remaining < base.near)[..., None]
        if self._orca is not None:
            more = np.where(home, 0.0, base.residual * asked[..., :2])
            return self._orca.toward(targets(view, observations), observations, more)
        if base.residual > 0:
            along = np.clip(view.toward(targets(view, observations)), -1.0, 1.0)
            asked = np.clip(along + base.residual * asked, -1.0, 1.0)
        return np.where(home, view.toward(view.goals), asked) if base.near > 0 else asked

"""Residual policies: actions composed of a network's output and a base controller's action.

T. Silver et al., "Residual policy learning", 2018. The base controller drives straight to the goal
or along the path; the network learns to avoid collisions only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from fgenv.agents.policies.base import BasePolicy
from fgenv.agents.policies.orca import OrcaPolicy
from fgenv.agents.tracking.path_targets import path_targets
from fgenv.arrays import Floats, Floats32
from fgenv.envs import View


@dataclass(frozen=True)
class ResidualConfig:
    """How a network's output becomes an action.

    Attributes:
        near: distance to the goal (m; for a fixed base the sum over its joints, rad) below which
            the action is that of `goto`; 0: never.
        residual: if positive, the action is that of `goto` plus this factor times the output, both
            clipped to [-1, 1]. `goto` follows the path hint if robots observe one.
        orca: add the residual to the preferred velocity of `OrcaPolicy` instead: the first two
            numbers of the output are forward and left, in units of the maximum speed. ORCA then
            avoids collisions.
    """

    near: float = 0.0
    residual: float = 0.0
    orca: bool = False

    @classmethod
    def of(cls, about: Mapping[str, Any]) -> ResidualConfig:
        """Return the configuration stored in a policy file; missing keys have their defaults."""
        return cls(**{key.name: about[key.name] for key in fields(cls) if key.name in about})


class ResidualController(BasePolicy):
    """Composes actions of network outputs."""

    def __init__(self, config: ResidualConfig) -> None:
        self.config = config
        self._orca = OrcaPolicy.guided() if config.orca else None

    def reset(self, view: View) -> None:
        """Begin new episodes.

        Raises:
            ValueError: with `orca`, if a base is not planar.
        """
        super().reset(view)
        if self._orca is not None:
            self._orca.reset(view)

    def actions(self, outputs: Floats, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size) of outputs of the same shape and observations."""
        view, config = self.view, self.config
        outputs = np.clip(np.asarray(outputs, dtype=np.float64), -1.0, 1.0)
        near = (view.remaining < config.near)[..., None]
        if self._orca is not None:
            residual = np.where(near, 0.0, config.residual * outputs[..., :2])
            return self._orca.toward(path_targets(view, observations), observations, residual)
        if config.residual > 0:
            base = np.clip(view.toward(path_targets(view, observations)), -1.0, 1.0)
            outputs = np.clip(base + config.residual * outputs, -1.0, 1.0)
        return np.where(near, view.toward(view.goals), outputs) if config.near > 0 else outputs

"""Environments of Stable-Baselines3 with residual actions."""

from __future__ import annotations

from typing import Any

import numpy as np
from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from fgenv.agents.policies.residual import ResidualConfig, ResidualController
from fgenv.agents.training.vec_env import FleetVecEnv
from fgenv.arrays import Flags, Floats32
from fgenv.envs import Simulator, View
from fgenv.envs.simulator import Source
from fgenv.envs.state_readers import MOVING


class ResidualVecEnv(FleetVecEnv):
    """A `FleetVecEnv` with the actions that a `ResidualController` composes of the given ones.

    Args:
        config: of the residual actions.
        scenario, n_envs, options: see `FleetVecEnv`.

    Attributes:
        moved: rows that were moving when the last step began, (rows,) bool.
    """

    moved: Flags

    def __init__(
        self,
        scenario: Source | Simulator,
        n_envs: int = 1,
        *,
        config: ResidualConfig | None = None,
        **options: Any,
    ) -> None:
        super().__init__(scenario, n_envs, **options)
        self.config = config or ResidualConfig()

    @property
    def moving(self) -> Flags:
        """Rows that are moving, (rows,) bool."""
        return np.asarray(self.simulator.status == MOVING).reshape(-1)

    def reset(self) -> Floats32:
        """See `FleetVecEnv`."""
        self._observations: Floats32 = super().reset()
        self._controller = ResidualController(self.config)
        self._controller.reset(View(self.simulator))
        return self._observations

    def step_wait(self) -> VecEnvStepReturn:
        """See `FleetVecEnv`."""
        shape = self.simulator.n_worlds, self.simulator.n_robots, -1
        self.moved = self.moving
        actions = self._controller.actions(
            self._actions.reshape(shape), self._observations.reshape(shape)
        )
        self._actions = actions.reshape(self.num_envs, -1)
        observations, rewards, dones, infos = super().step_wait()
        self._observations = np.asarray(observations)
        return self._observations, rewards, dones, infos

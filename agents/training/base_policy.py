"""Rows of which each action is made of a network's output and of what `goto` does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from fgenv.agents.policies.residual import ResidualConfig, ResidualController
from fgenv.agents.training.vec_env import FleetVecEnv
from fgenv.envs import View
from fgenv.envs.state_readers import MOVING


class HomingVecEnv(FleetVecEnv):
    """A `FleetVecEnv` whose actions a `ResidualConfig` makes of those that are asked for.

    Attributes:
        base: how.
        moved: which rows were on the way when the last step began, (rows,) bool.
    """

    base = ResidualConfig()
    moved: NDArray[np.bool_]

    @property
    def moving(self) -> NDArray[np.bool_]:
        """Which rows are on the way, (rows,)."""
        return np.asarray(self.simulator.status == MOVING).reshape(-1)

    def reset(self) -> NDArray[np.float32]:
        """See `FleetVecEnv`."""
        self._seen = super().reset()
        self._acting = ResidualController(self.base)
        self._acting.reset(View(self.simulator))
        return self._seen

    def step_wait(self) -> VecEnvStepReturn:
        """See `FleetVecEnv`."""
        worlds, robots = self.simulator.n_worlds, self.simulator.n_robots
        asked = self._actions.reshape(worlds, robots, -1)
        seen = self._seen.reshape(worlds, robots, -1)
        self.moved = self.moving
        made = self._acting.actions(asked, seen)
        self._actions = made.reshape(self.num_envs, -1)
        rows, rewards, dones, infos = super().step_wait()
        self._seen = np.asarray(rows)
        return self._seen, rewards, dones, infos

"""A rollout buffer of PPO without the steps of robots at their goals."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.type_aliases import RolloutBufferSamples

from fgenv.agents.training.multi_scenario import MultiScenarioVecEnv


class MaskedRolloutBuffer(RolloutBuffer):
    """Samples only the steps of rows that were moving.

    A row continues after its robot has arrived, until its world ends. Actions have no effect in
    these steps, which can outnumber the others. Their value is 0.

    Attributes:
        envs: environments of the rows.
    """

    envs: MultiScenarioVecEnv

    def reset(self) -> None:
        """Empty the buffer."""
        super().reset()
        self._mask = np.zeros((self.buffer_size, self.n_envs), dtype=bool)

    def add(
        self,
        obs: NDArray[Any],
        action: NDArray[Any],
        reward: NDArray[Any],
        episode_start: NDArray[Any],
        value: torch.Tensor,
        log_prob: torch.Tensor,
    ) -> None:
        """Add a step of all rows; see `RolloutBuffer`."""
        moved = self._mask[self.pos] = self.envs.moved
        value = value.flatten() * torch.as_tensor(moved)
        super().add(obs, action, reward, episode_start, value, log_prob)

    def compute_returns_and_advantage(self, last_values: torch.Tensor, dones: NDArray[Any]) -> None:
        """See `RolloutBuffer`."""
        moving = torch.as_tensor(self.envs.moving)
        super().compute_returns_and_advantage(last_values.flatten() * moving, dones)

    def get(self, batch_size: int | None = None) -> Generator[RolloutBufferSamples, None, None]:
        """Yield full batches of unmasked samples in random order; omit an incomplete last one."""
        if not self.generator_ready:
            next(super().get(1))  # flattens the arrays
        samples = np.flatnonzero(self._mask.T)
        samples = samples[torch.randperm(len(samples)).numpy()]
        size = min(batch_size or len(samples), len(samples))
        for batch in samples[: len(samples) // size * size].reshape(-1, size):
            yield self._get_samples(batch)

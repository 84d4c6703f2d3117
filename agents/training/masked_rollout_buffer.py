"""What PPO learns from: the steps of robots that were on the way."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.type_aliases import RolloutBufferSamples

from fgenv.agents.training.multi_scenario import MixedVecEnv


class MovingRollouts(RolloutBuffer):
    """A rollout buffer without the steps of robots that rest at their goals.

    These go on until all of their world have arrived, many times as long as those on the way where
    somebody is late, and teach nothing: whatever they ask for is not done. Their value is 0.

    Attributes:
        envs: of which the rows are.
    """

    envs: MixedVecEnv

    def reset(self) -> None:
        """Begin anew."""
        super().reset()
        self._counts = np.zeros((self.buffer_size, self.n_envs), dtype=bool)

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
        moved = self._counts[self.pos] = self.envs.moved
        value = value.flatten() * torch.as_tensor(moved)
        super().add(obs, action, reward, episode_start, value, log_prob)

    def compute_returns_and_advantage(self, last_values: torch.Tensor, dones: NDArray[Any]) -> None:
        """See `RolloutBuffer`."""
        moving = torch.as_tensor(self.envs.moving)
        super().compute_returns_and_advantage(last_values.flatten() * moving, dones)

    def get(self, batch_size: int | None = None) -> Generator[RolloutBufferSamples, None, None]:
        """Batches of those that count, in random order; the last ones, less than a batch, not."""
        if not self.generator_ready:
            next(super().get(1))  # it lays the arrays out in rows
        which = np.flatnonzero(self._counts.T)
        which = which[torch.randperm(len(which)).numpy()]
        size = min(batch_size or len(which), len(which))
        for batch in which[: len(which) // size * size].reshape(-1, size):
            yield self._get_samples(batch)

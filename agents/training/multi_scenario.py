"""Environments of several scenarios as one, so that one policy learns in all of them at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from fgenv.agents.training.residual_vec_env import ResidualVecEnv
from fgenv.arrays import Flags, Floats32


class MultiScenarioVecEnv(VecEnv):
    """Concatenates the rows of environments, for example with few and with many robots.

    The observation space is unbounded, since the bounds of the parts may differ.

    Args:
        parts: with observations of one size and one action space.

    Raises:
        ValueError: the parts differ.
    """

    def __init__(self, parts: Sequence[ResidualVecEnv]) -> None:
        self.parts = tuple(parts)
        first = self.parts[0]
        for part in self.parts:
            here, shape = part.observation_space.shape, first.observation_space.shape
            if here != shape or part.action_space != first.action_space:
                raise ValueError(
                    f"parts: got observations of {here} and {shape}, expected one size and one"
                    " action space"
                )
        self._ends = np.cumsum([part.num_envs for part in self.parts])
        space = Box(-np.inf, np.inf, shape, np.float32)
        super().__init__(int(self._ends[-1]), space, first.action_space)

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Seed part k with seed + 1000 k; return the seed of each row."""
        seeds: list[int | None] = []
        for k, part in enumerate(self.parts):
            seeds += part.seed(None if seed is None else seed + 1000 * k)
        return seeds

    def reset(self) -> Floats32:
        """Begin episodes; return observations (rows, size)."""
        return np.concatenate([part.reset() for part in self.parts])

    def step_async(self, actions: NDArray[Any]) -> None:
        """See `step_wait`."""
        for part, own in zip(self.parts, np.split(actions, self._ends[:-1]), strict=True):
            part.step_async(own)

    def step_wait(self) -> VecEnvStepReturn:
        """Step with actions (rows, size); see `FleetVecEnv`."""
        rows, rewards, dones, infos = zip(*(part.step_wait() for part in self.parts), strict=True)
        flat = [info for part in infos for info in part]
        return np.concatenate(rows), np.concatenate(rewards), np.concatenate(dones), flat

    @property
    def moved(self) -> Flags:
        """Rows that were moving when the last step began, (rows,) bool."""
        return np.concatenate([part.moved for part in self.parts])

    @property
    def moving(self) -> Flags:
        """Rows that are moving, (rows,) bool."""
        return np.concatenate([part.moving for part in self.parts])

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of each row; see `FleetVecEnv`."""
        every = [value for part in self.parts for value in part.get_attr(attr_name)]
        return [every[i] for i in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute for all rows; see `FleetVecEnv`."""
        for part in self.parts:
            part.set_attr(attr_name, value, indices)

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Call a method of each row."""
        methods = self.get_attr(method_name, indices)
        return [method(*method_args, **method_kwargs) for method in methods]

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Return False for each row."""
        return [False for _ in self._get_indices(indices)]

    def close(self) -> None:
        """End the live views, if there are any."""
        for part in self.parts:
            part.close()

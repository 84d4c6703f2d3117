"""Rows of several environments as those of one: the same policy learns in all of them at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from fgenv.agents.training.base_policy import HomingVecEnv


class MixedVecEnv(VecEnv):
    """Rows of `HomingVecEnv`s one after the other: scenarios of few and of many robots, say.

    The space of observations has no bounds, since those of the parts may differ.

    Args:
        parts: alike in what robots observe and do.

    Raises:
        ValueError: they are not.
    """

    def __init__(self, parts: Sequence[HomingVecEnv]) -> None:
        self.parts = tuple(parts)
        first = self.parts[0]
        for part in self.parts:
            here, there = part.observation_space.shape, first.observation_space.shape
            if here != there or part.action_space != first.action_space:
                raise ValueError(
                    f"parts: observe {here} and {there} numbers, expected alike robots"
                )
        shape = first.observation_space.shape
        self._ends = np.cumsum([part.num_envs for part in self.parts])
        space = Box(-np.inf, np.inf, shape, np.float32)
        super().__init__(int(self._ends[-1]), space, first.action_space)

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Part k gets seed + 1000 k; returns the seed of each row."""
        found: list[int | None] = []
        for k, part in enumerate(self.parts):
            found += part.seed(None if seed is None else seed + 1000 * k)
        return found

    def reset(self) -> NDArray[np.float32]:
        """Begin episodes; observations (rows, size)."""
        return np.concatenate([part.reset() for part in self.parts])

    def step_async(self, actions: NDArray[Any]) -> None:
        """See `step_wait`."""
        for part, own in zip(self.parts, np.split(actions, self._ends[:-1]), strict=True):
            part.step_async(own)

    def step_wait(self) -> VecEnvStepReturn:
        """Step with actions (rows, size); see `HomingVecEnv`."""
        rows, rewards, dones, infos = zip(*(part.step_wait() for part in self.parts), strict=True)
        told = [info for part in infos for info in part]
        return np.concatenate(rows), np.concatenate(rewards), np.concatenate(dones), told

    @property
    def moved(self) -> NDArray[np.bool_]:
        """Which rows were on the way when the last step began, (rows,)."""
        return np.concatenate([part.moved for part in self.parts])

    @property
    def moving(self) -> NDArray[np.bool_]:
        """Which rows are on the way, (rows,)."""
        return np.concatenate([part.moving for part in self.parts])

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Of each row; see `HomingVecEnv`."""
        every = [value for part in self.parts for value in part.get_attr(attr_name)]
        return [every[i] for i in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set it for all rows; see `HomingVecEnv`."""
        for part in self.parts:
            part.set_attr(attr_name, value, indices)

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Call a method of each row."""
        methods = self.get_attr(method_name, indices)
        return [method(*method_args, **method_kwargs) for method in methods]

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """No row is."""
        return [False for _ in self._get_indices(indices)]

    def close(self) -> None:
        """End the live views, if there are any."""
        for part in self.parts:
            part.close()

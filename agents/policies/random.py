"""A policy that acts at random."""

import numpy as np

from fgenv.agents.policies.observation import Seeing
from fgenv.arrays import Floats, Floats32


class RandomPolicy(Seeing):
    """Uniform in [-1, 1]; the same numbers for the same seed, other ones in each episode."""

    def __init__(self, seed: int = 0) -> None:
        self._random = np.random.default_rng(seed)

    def act(self, observations: Floats32) -> Floats:
        """Actions (worlds, robots, size)."""
        view = self.view
        return self._random.uniform(-1.0, 1.0, (view.n_worlds, view.n_robots, view.action_size))

"""A policy with random actions."""

import numpy as np

from fgenv.agents.policies.base import BasePolicy
from fgenv.agents.policies.names import refuse_argument
from fgenv.arrays import Floats, Floats32


class RandomPolicy(BasePolicy):
    """Draws actions uniformly from [-1, 1]; a seed fixes the sequence over all episodes."""

    def __init__(self, seed: int = 0) -> None:
        self._random = np.random.default_rng(seed)

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size)."""
        view = self.view
        return self._random.uniform(-1.0, 1.0, (view.n_worlds, view.n_robots, view.action_size))


def random(argument: str, seed: int) -> RandomPolicy:
    """Make the policy named `random`."""
    refuse_argument("random", argument)
    return RandomPolicy(seed)

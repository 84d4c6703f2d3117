"""A policy with random actions."""

import numpy as np

from fgenv.agents.policies.base import BasePolicy
from fgenv.agents.policies.names import refuse_argument
from fgenv.arrays import Floats, Floats32


class RandomPolicy(BasePolicy):
    """Draws actions uniformly from [-1, 1].

    Those of an episode depend on this seed, on the seed of its world and on its number alone: a
    world among many acts as it does alone.
    """

    def __init__(self, seed: int = 0) -> None:
        self.seed = seed
        self._streams: dict[int, tuple[tuple[int, int], np.random.Generator]] = {}

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size)."""
        view = self.view
        keys = zip(view.seeds.tolist(), view.episodes.tolist(), strict=True)
        shape = (view.n_robots, view.action_size)
        steps = view.steps.tolist()
        rows = [
            self._generator(world, key, steps[world] == 0).uniform(-1.0, 1.0, shape)
            for world, key in enumerate(keys)
        ]
        return np.stack(rows)

    def _generator(self, world: int, key: tuple[int, int], begin: bool) -> np.random.Generator:
        """The stream of a world's episode, by the world's seed and the number of the episode."""
        if begin or self._streams.get(world, (None,))[0] != key:
            self._streams[world] = key, np.random.default_rng([self.seed, *key])
        return self._streams[world][1]


def random(argument: str, seed: int) -> RandomPolicy:
    """Make the policy named `random`."""
    refuse_argument("random", argument)
    return RandomPolicy(seed)

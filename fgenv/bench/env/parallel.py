"""A PettingZoo environment as a batch of one world: MPE2's, and fgenv's own."""

from __future__ import annotations

from typing import Any

from fgenv.bench.env.batch import ACTIONS, Batch


def parallel_batch(env: Any, seed: int) -> Batch:
    """Step a `ParallelEnv`; starts anew, which is timed, as soon as one of its agents is gone."""
    env.reset(seed=seed)
    agents = list(env.agents)
    for k, agent in enumerate(agents):
        env.action_space(agent).seed(seed + k)
    drawn = [{agent: env.action_space(agent).sample() for agent in agents} for _ in range(ACTIONS)]

    def step(k: int) -> object:
        out = env.step(drawn[k % ACTIONS])
        if len(env.agents) < len(agents):
            env.reset()
        return out

    return Batch(len(agents), 1, step, lambda: env.reset(seed=seed))

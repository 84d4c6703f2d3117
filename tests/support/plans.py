"""Episodes of the policy `plan`, and a policy that holds a robot back for some steps."""

from __future__ import annotations

from typing import Any

import numpy as np

from fgenv.agents import PlanPolicy, run_episode
from fgenv.envs import Policy, Simulator, View, policy_of, replay
from fgenv.metrics import Results


class Held:
    """A policy, except for a robot that does not act for some steps."""

    def __init__(self, policy: Policy, robot: int, first: int, last: int) -> None:
        self.policy, self.robot, self.steps = policy, robot, range(first, last)

    def reset(self, view: View) -> None:
        self.view = view
        self.policy.reset(view)

    def act(self, observations: np.ndarray) -> np.ndarray:
        actions: np.ndarray = self.policy.act(observations)
        if int(self.view.steps[0]) in self.steps:
            actions[:, self.robot] = 0.0
        return actions


def driven(name: str, policy: str, **options: Any) -> tuple[Results, PlanPolicy]:
    """Run an episode, verify it from its record, and return it with the policy."""
    simulator, made = Simulator(name, autoreset=False, **options), policy_of(policy)
    assert isinstance(made, PlanPolicy)
    made.strict = True
    record = run_episode(simulator, made)
    replay(record)
    return Results.of(record), made

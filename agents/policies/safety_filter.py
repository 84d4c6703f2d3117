"""A safety filter: a robot that would collide in the next step stops instead."""

from __future__ import annotations

from fgenv.agents.policies.base import BasePolicy
from fgenv.arrays import Floats, Floats32
from fgenv.envs import Policy, View, policy_of


class SafetyFilter(BasePolicy):
    """Passes on the actions of another policy up to the certified first contact of each step.

    A robot that would collide in the step is stopped; the step is then checked again, since robots
    behind may collide with the stopped one. After at most one round per robot, no collision is
    left. If every drive can stop within a step (no acceleration limit), an episode with a free
    start has no collision; other drives brake too late. The filter does not resolve deadlocks.

    Args:
        policy: to be filtered.
    """

    def __init__(self, policy: Policy) -> None:
        self.policy = policy
        self.observation = getattr(policy, "observation", None)
        self.actions: str = getattr(policy, "actions", "drive")

    def reset(self, view: View) -> None:
        """Begin new episodes."""
        super().reset(view)
        self.policy.reset(view)

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size)."""
        return self.view.safe_actions(self.policy.act(observations))


def safe(argument: str, seed: int) -> SafetyFilter:
    """Make the policy named `safe:POLICY`."""
    return SafetyFilter(policy_of(argument, seed))

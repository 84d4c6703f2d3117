"""A safety filter: who would meet something in the next step stands still instead."""

from __future__ import annotations

import numpy as np

from fgenv.agents.policies.observation import Seeing
from fgenv.arrays import Floats, Floats32
from fgenv.envs import Policy, View


class Safe(Seeing):
    """Does what another policy asks for, up to the certified first contact of each step.

    Whom the asked actions would bring into contact is told to stop; then the step is asked anew,
    since who stops may be met by those behind. After as many rounds as there are robots nobody is
    left to be met. Where every drive can stop within a step (no limit of acceleration) nobody
    meets anything from a free start; a drive that needs longer brakes too late. It does not find
    a way out: robots that wait for each other wait until the time is out.

    Args:
        policy: that is filtered.
    """

    def __init__(self, policy: Policy) -> None:
        self.policy = policy
        self.observation = getattr(policy, "observation", None)
        self.actions: str = getattr(policy, "actions", "drive")

    def reset(self, view: View) -> None:
        """Episodes begin."""
        super().reset(view)
        self.policy.reset(view)

    def act(self, observations: Floats32) -> Floats:
        """Actions (worlds, robots, size)."""
        asked = np.array(self.policy.act(observations), dtype=np.float64)
        rest, stopped = self.view.toward(self.view.configurations), np.zeros(asked.shape[:2], bool)
        for _ in range(self.view.n_robots):
            meet = self.view.meet(asked) & ~stopped
            if not meet.any():
                break
            asked[meet], stopped = rest[meet], stopped | meet
        return asked

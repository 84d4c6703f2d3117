"""A policy that goes straight to the goal."""

from fgenv.agents.policies.observation import Seeing
from fgenv.envs.simulator import Floats, Rows


class GoTo(Seeing):
    """Every robot drives straight to its goal, as its drive can, whatever is in the way."""

    def act(self, observations: Rows) -> Floats:
        """Actions (worlds, robots, size)."""
        return self.view.toward(self.view.goals)

"""A policy that goes straight to the goal."""

from fgenv.agents.policies.observation import Seeing
from fgenv.arrays import Floats, Floats32


class GoTo(Seeing):
    """Every robot drives straight to its goal, as its drive can, whatever is in the way."""

    def act(self, observations: Floats32) -> Floats:
        """Actions (worlds, robots, size)."""
        return self.view.toward(self.view.goals)

"""A policy that stays where it is."""

from fgenv.agents.policies.observation import Seeing
from fgenv.arrays import Floats, Floats32


class Rest(Seeing):
    """Every robot stops. An action of zeros would not do: it is the middle of a drive's limits,
    which is ahead where backwards is slower."""

    def act(self, observations: Floats32) -> Floats:
        """Actions (worlds, robots, size) to where all are."""
        return self.view.toward(self.view.configurations)

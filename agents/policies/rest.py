"""A policy that stops."""

from fgenv.agents.policies.base import BasePolicy
from fgenv.agents.policies.names import refuse_argument
from fgenv.arrays import Floats, Floats32


class RestPolicy(BasePolicy):
    """Stops every robot.

    Zero actions would not: zero is the middle of a drive's limits, which is a forward speed if
    the reverse limit is lower.
    """

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size) toward the current configurations."""
        return self.view.toward(self.view.configurations)


def rest(argument: str, seed: int) -> RestPolicy:
    """Make the policy named `rest`."""
    refuse_argument("rest", argument)
    return RestPolicy()

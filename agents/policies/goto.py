"""A policy that drives straight to the goal."""

from fgenv.agents.policies.base import BasePolicy
from fgenv.agents.policies.names import refuse_argument
from fgenv.arrays import Floats, Floats32


class GoToPolicy(BasePolicy):
    """Drives every robot straight to its goal within the limits of its drive; ignores obstacles."""

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size)."""
        return self.view.toward(self.view.goals)


def goto(argument: str, seed: int) -> GoToPolicy:
    """Make the policy named `goto`."""
    refuse_argument("goto", argument)
    return GoToPolicy()

"""Base class of policies that use the view of the simulator."""

from fgenv.envs import Observation, View


class BasePolicy:
    """Keeps the view of the last reset.

    Attributes:
        observation: required by the policy; None: any.
    """

    observation: Observation | None = None
    _view: View | None = None

    def reset(self, view: View) -> None:
        """Begin new episodes."""
        self._view = view

    @property
    def view(self) -> View:
        """View of the simulator.

        Raises:
            RuntimeError: before the first reset.
        """
        if self._view is None:
            raise RuntimeError("policy: act before reset, call reset(view) first")
        return self._view

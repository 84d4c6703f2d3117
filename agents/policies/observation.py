"""What policies share that look at more than their observations."""

from fgenv.envs import Observation, View


class Seeing:
    """Keeps the view that it was reset with.

    Attributes:
        observation: what it wants the simulator to let robots observe; None: whatever it does.
    """

    observation: Observation | None = None
    _view: View | None = None

    def reset(self, view: View) -> None:
        """Episodes begin."""
        self._view = view

    @property
    def view(self) -> View:
        """Of the simulator.

        Raises:
            RuntimeError: before the first reset.
        """
        if self._view is None:
            raise RuntimeError("policy: act before reset, call reset(view) first")
        return self._view

"""Policies of the robots that do not learn."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats32

from .simulator_view import View

if TYPE_CHECKING:
    from .simulator import Simulator


@runtime_checkable
class Policy(Protocol):
    """Decides on the actions of all robots in all worlds at once."""

    def reset(self, view: View) -> None:
        """Episodes begin; the view may be kept, it follows the simulator."""

    def act(self, observations: Floats32) -> Any:
        """Actions (worlds, robots, action_size) in [-1, 1], beyond is clipped.

        Args:
            observations: (worlds, robots, size) float32; `view.layouts` tells their parts.
        """


class Called:
    """A function of observations as a policy."""

    def __init__(self, function: Callable[[Floats32], Any]) -> None:
        self._function = function

    def reset(self, view: View) -> None:
        """See `Policy`."""

    def act(self, observations: Floats32) -> Any:
        """See `Policy`."""
        return self._function(observations)


def policy_of(others: Any, seed: int = 0) -> Policy:
    """The policy meant: one, a function of observations, or a name: `rest`, `random`, `goto`...

    Raises:
        TypeError, ValueError: it is none.
    """
    if isinstance(others, str):
        agents: Any = importlib.import_module("fgenv.agents")  # it stands on this package
        found: Policy = agents.policy_of(others, seed)
        return found
    if isinstance(others, Policy):
        return others
    if callable(others):
        return Called(others)
    raise TypeError(
        f"others: got {type(others).__name__}, expected a name ('rest', 'goto', ...), a policy with"
        " reset(view) and act(observations), or a function of observations"
    )


def actions_of(policy: Policy, simulator: Simulator, observations: Floats32) -> NDArray[np.float64]:
    """What a policy wants, (worlds, robots, action size), a copy.

    Raises:
        ValueError: another shape, or a number that is not finite.
    """
    asked = np.array(policy.act(observations), dtype=np.float64)
    expected = (simulator.n_worlds, simulator.n_robots, simulator.action_size)
    if asked.shape != expected:
        raise ValueError(f"others: act gave shape {asked.shape}, expected {expected}")
    if not np.isfinite(asked).all():
        raise ValueError("others: act gave a number that is not finite")
    return asked

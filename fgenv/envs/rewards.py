"""Rewards: a sum of named terms, and of the user's own functions over the batch."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .simulator import Simulator

TERMS = {
    "progress": "meters (of a fixed base: radians of all joints) nearer to the goal in this step",
    "arrival": "1 in the step in which the robot arrives",
    "collision": "1 where it met something in this step",
    "obstacle": "1 more where what it met is no robot",
    "time": "1 in each step on the way",
    "effort": "mean square of its action, 0 to 1",
    "closeness": "1 in contact, falling to 0 at `near` meters of clearance",
}
DEFAULT = {"progress": 1.0, "arrival": 10.0, "collision": -1.0, "time": -0.01}
Term = Callable[["Simulator"], Any]


@dataclass(frozen=True)
class Reward:
    """Weights of the named terms, and own terms.

    Attributes:
        weights: by name of `TERMS`; what is left out is 0.
        own: functions of the simulator after the step, before a world begins anew, that return
            (worlds, robots), and what to multiply each with. Robots that had arrived before the
            step get nothing.
        near: meters, of `closeness`.
    """

    weights: Mapping[str, float] = field(default_factory=lambda: MappingProxyType(DEFAULT))
    own: tuple[tuple[Term, float], ...] = ()
    near: float = 0.5

    def __post_init__(self) -> None:
        for name, weight in self.weights.items():
            if name not in TERMS:
                raise ValueError(f"reward: {name!r} is no term, expected one of {', '.join(TERMS)}")
            if not np.isfinite(weight):
                raise ValueError(f"reward: {name}: got {weight!r}, expected a finite weight")
        for term, weight in self.own:
            if not callable(term) or not np.isfinite(weight):
                raise TypeError("reward: own: expected pairs of a function and a finite weight")
        if not 0 < self.near < np.inf:
            raise ValueError(f"reward: near: got {self.near!r}, expected meters over 0")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self.weights), self.own, self.near)

    def of_own_terms(self, simulator: Simulator) -> NDArray[np.float64]:
        """The own terms' sum, (worlds, robots).

        Raises:
            ValueError: one returns another shape, or a number that is not finite.
        """
        shape = (simulator.n_worlds, simulator.n_robots)
        total = np.zeros(shape)
        for term, weight in self.own:
            name = getattr(term, "__name__", repr(term))
            value = np.asarray(term(simulator), dtype=np.float64)
            if value.shape != shape:
                raise ValueError(f"reward: {name} gave shape {value.shape}, expected {shape}")
            if not np.isfinite(value).all():
                raise ValueError(f"reward: {name} gave a number that is not finite")
            total += weight * value
        return total

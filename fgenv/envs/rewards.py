"""Rewards: weighted sums of named terms and of user-defined functions of the simulator."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from fgenv.arrays import Floats

TERMS = {
    "progress": "decrease of the distance to the goal in this step, meters (fixed base: radians)",
    "arrival": "1 in the step in which the robot arrives",
    "collision": "1 in a step with a collision",
    "obstacle": "1 in a step with a collision with a body that is no robot",
    "time": "1 in each step before arrival",
    "effort": "mean square of the action, 0 to 1",
    "closeness": "1 in contact, falling to 0 at `near` meters of clearance",
}
DEFAULT = {"progress": 1.0, "arrival": 10.0, "collision": -1.0, "time": -0.01}
Term = Callable[[Any], Any]  # of the Simulator; returns (worlds, robots)


@dataclass(frozen=True)
class Reward:
    """Weights of named terms, and user-defined terms.

    Attributes:
        weights: Weights by name of `TERMS`; missing ones are 0.
        own: Pairs of a function and its weight. The function takes the simulator after the step,
            before a world begins anew, and returns (worlds, robots). Robots that had arrived before
            the step get 0.
        near: Range of `closeness`, meters.
    """

    weights: Mapping[str, float] = field(default_factory=lambda: MappingProxyType(DEFAULT))
    own: tuple[tuple[Term, float], ...] = ()
    near: float = 0.5

    def __post_init__(self) -> None:
        for name, weight in self.weights.items():
            if name not in TERMS:
                raise ValueError(f"reward: got {name!r}, expected one of {', '.join(TERMS)}")
            if not np.isfinite(weight):
                raise ValueError(f"reward: {name}: got {weight!r}, expected a finite weight")
        for term, weight in self.own:
            if not callable(term) or not np.isfinite(weight):
                raise TypeError("reward: own: expected pairs of a function and a finite weight")
        if not 0 < self.near < np.inf:
            raise ValueError(f"reward: near: got {self.near!r}, expected meters over 0")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self.weights), self.own, self.near)

    def sum_of_own_terms(self, simulator: Any) -> Floats:
        """Return the weighted sum of the user-defined terms, (worlds, robots).

        Raises:
            ValueError: a term returns another shape, or a number that is not finite.
        """
        shape = (simulator.n_worlds, simulator.n_robots)
        total = np.zeros(shape)
        for term, weight in self.own:
            name = getattr(term, "__name__", repr(term))
            value = np.asarray(term(simulator), dtype=np.float64)
            if value.shape != shape:
                raise ValueError(f"reward: {name}: got shape {value.shape}, expected {shape}")
            if not np.isfinite(value).all():
                raise ValueError(f"reward: {name}: got a number that is not finite")
            total += weight * value
        return total

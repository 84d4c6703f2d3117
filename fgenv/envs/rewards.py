"""Rewards: weighted sums of named terms and of user-defined functions of the simulator."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots.links_joints import number_of
from fgenv.scenarios.errors import near

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
                raise ValueError(f"reward: got {name!r}; {near(name, TERMS)}")
            number_of(weight, f"reward: {name}", finite=True)
        object.__setattr__(self, "own", tuple(map(_checked_term, _pairs(self.own))))
        if number_of(self.near, "reward: near", 0.0, finite=True) == 0:
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


def _pairs(own: Any) -> list[Any]:
    if isinstance(own, Mapping) or not isinstance(own, Iterable):
        raise TypeError(f"reward: own: got {own!r}, expected pairs (function, weight)")
    return list(own)


def _checked_term(pair: Any) -> tuple[Term, float]:
    if not isinstance(pair, Sequence) or len(pair) != 2 or not callable(pair[0]):
        raise TypeError(f"reward: own: got {pair!r}, expected a pair (function, weight)")
    name = getattr(pair[0], "__name__", "own")
    return pair[0], number_of(pair[1], f"reward: {name}", finite=True)

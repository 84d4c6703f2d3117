"""Policies: what decides on actions. One protocol for all, and the built-in ones by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from fgenv.agents.goto import GoTo
from fgenv.agents.random_policy import RandomPolicy
from fgenv.agents.rest import Rest
from fgenv.envs import View
from fgenv.envs.simulator import Floats, Rows
from fgenv.scenarios.trouble import near


class Policy(Protocol):
    """Decides on the actions of all robots in all worlds at once."""

    def reset(self, view: View) -> None:
        """Episodes begin; the view may be kept, it follows the simulator."""

    def act(self, observations: Rows) -> Floats:
        """Actions (worlds, robots, action_size) float64 in [-1, 1], beyond is clipped.

        Args:
            observations: (worlds, robots, size) float32; `view.layouts` tells their parts.
        """


POLICIES: dict[str, Callable[[int], Policy]] = {
    "goto": lambda seed: GoTo(),
    "random": RandomPolicy,
    "rest": lambda seed: Rest(),
}


def policy_of(name: str, seed: int = 0) -> Policy:
    """A built-in policy.

    Args:
        name: of `POLICIES`.
        seed: of what is random in it, 0 or more.

    Raises:
        ValueError: no policy has that name, or the seed is below 0.
    """
    if name not in POLICIES:
        raise ValueError(f"policy: {name!r} is not known; {near(name, POLICIES)}")
    if seed < 0:
        raise ValueError(f"seed: {seed}, wanted 0 or more")
    return POLICIES[name](seed)

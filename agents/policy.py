"""Policies: what decides on actions. One protocol for all, and the built-in ones by name."""

from __future__ import annotations

from collections.abc import Callable

from fgenv.agents.goto import GoTo
from fgenv.agents.random_policy import RandomPolicy
from fgenv.agents.rest import Rest
from fgenv.envs import Policy
from fgenv.scenarios.trouble import near

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

"""Options of environments."""

from __future__ import annotations

import secrets
from typing import Any, TypeVar

from .simulator import Simulator

Seed = TypeVar("Seed")


def refuse_worlds(environment: str, options: dict[str, Any]) -> None:
    """Raise TypeError if options include the number of worlds or autoreset."""
    for name in ("worlds", "autoreset"):
        if name in options:
            raise TypeError(
                f"{name}: got {options[name]!r}, which {environment} does not take; use"
                " fgenv.envs.Simulator, gymnasium.make_vec or fgenv.agents.FleetVecEnv"
            )


def check_reset_options(options: dict[str, Any] | None) -> None:
    """Raise TypeError unless the options of a reset are a dict or None.

    Unknown keys are accepted: the test suites of Gymnasium and PettingZoo pass some.
    """
    if options is not None and not isinstance(options, dict):
        raise TypeError(f"options: got {options!r}, expected a dict or None")


def first_seed(simulator: Simulator, seed: Seed | None) -> Seed | int | None:
    """Return the seed of a reset: before the first one, fresh entropy if there is none."""
    return secrets.randbits(32) if seed is None and not simulator.begun else seed

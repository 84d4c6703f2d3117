"""Options of environments."""

from __future__ import annotations

from typing import Any


def refuse_worlds(environment: str, options: dict[str, Any]) -> None:
    """Raise TypeError if options include the number of worlds or autoreset."""
    for name in ("worlds", "autoreset"):
        if name in options:
            raise TypeError(
                f"{name}: got {options[name]!r}, which {environment} does not take; use"
                " fgenv.envs.Simulator, gymnasium.make_vec or fgenv.agents.FleetVecEnv"
            )

"""Built-in scenarios under names of Gymnasium and PettingZoo: `fgenv/swap-v0` and so on."""

from __future__ import annotations

import gymnasium
import pettingzoo

from fgenv.scenarios.library import ENTRIES


def register() -> None:
    """Register all that are not registered yet."""
    for name in ENTRIES:
        given = {"scenario": name}
        if f"fgenv/{name}-v0" not in gymnasium.registry:
            gymnasium.register(
                f"fgenv/{name}-v0",
                "fgenv.envs.single:FleetEnv",
                vector_entry_point="fgenv.envs.vector:FleetVectorEnv",
                kwargs=given,
            )
        if not hasattr(pettingzoo, "register"):  # it came with 1.27
            continue
        for kind, registry, make in (
            ("parallel", pettingzoo.parallel_registry, "fgenv.envs.parallel:parallel_env"),
            ("aec", pettingzoo.aec_registry, "fgenv.envs.aec:env"),
        ):
            if f"fgenv/{name}-v0" not in registry:
                pettingzoo.register(kind, f"fgenv/{name}-v0", make, kwargs=given)

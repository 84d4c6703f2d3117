"""PettingZoo: the robots of one world act in turn, and move when the last has acted."""

from __future__ import annotations

import copy
from typing import Any

from pettingzoo.utils.conversions import parallel_to_aec_wrapper
from pettingzoo.utils.wrappers import OrderEnforcingWrapper

from .parallel import FleetParallelEnv, parallel_env
from .simulator import Source


class FleetAECEnv(parallel_to_aec_wrapper):  # type: ignore[misc]
    """A FleetParallelEnv in turns; a bad action is told at its own turn."""

    env: FleetParallelEnv

    def step(self, action: Any) -> None:
        """Act for `agent_selection`: (size,), None for one whose episode is over.

        Raises:
            ValueError: naming the robot, saying what came and what is expected. Nothing has
                changed then.
        """
        agent = self.agent_selection
        if self.terminations[agent] or self.truncations[agent]:
            if action is not None:
                raise ValueError(f"action of {agent!r}: its episode is over, expected None")
        else:
            self.env.checked(agent, action)
        super().step(action)

    def __copy__(self) -> FleetAECEnv:
        return copy.deepcopy(self)


class OrderedAECEnv(OrderEnforcingWrapper):  # type: ignore[misc]
    """Says what is called too early; a copy is a deep one."""

    def __str__(self) -> str:
        return str(self.env)

    def __copy__(self) -> OrderedAECEnv:
        return copy.deepcopy(self)


def env(
    scenario: Source,
    *,
    render_mode: str | None = None,
    max_cycles: int | None = None,
    **options: Any,
) -> OrderedAECEnv:
    """A scenario as a PettingZoo AECEnv; arguments and errors are those of `parallel_env`."""
    world = parallel_env(scenario, render_mode=render_mode, max_cycles=max_cycles, **options)
    return OrderedAECEnv(FleetAECEnv(world))

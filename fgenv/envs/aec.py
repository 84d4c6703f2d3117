"""PettingZoo AEC: the robots of one world act in turn, and move after the last action."""

from __future__ import annotations

import copy
from typing import Any

from pettingzoo.utils.conversions import parallel_to_aec_wrapper
from pettingzoo.utils.wrappers import OrderEnforcingWrapper

from .parallel import FleetParallelEnv, parallel_env
from .simulator import Source


class FleetAECEnv(parallel_to_aec_wrapper):  # type: ignore[misc]
    """A FleetParallelEnv in turns; an invalid action raises at its own turn."""

    env: FleetParallelEnv

    def step(self, action: Any) -> None:
        """Set the action (size,) of `agent_selection`; None if its episode is over.

        Raises:
            ValueError: invalid action. The state is unchanged.
        """
        agent = self.agent_selection
        if self.terminations[agent] or self.truncations[agent]:
            if action is not None:
                raise ValueError(
                    f"action of {agent!r}: got {action!r}, expected None: its episode is over"
                )
        else:
            self.env.checked(agent, action)
        super().step(action)

    def get_state(self) -> dict[str, Any]:
        """Return the state of the episode and of the turns, for `set_state`."""
        turns = {name: value for name, value in vars(self).items() if name != "env"}
        return {"env": self.env.get_state(), "turns": copy.deepcopy(turns)}

    def set_state(self, state: dict[str, Any]) -> None:
        """Continue from a state of `get_state`, bit for bit.

        Raises:
            ValueError: the state is of another environment.
        """
        self.env.set_state(state["env"])
        self.__dict__.update(copy.deepcopy(state["turns"]))

    def __copy__(self) -> FleetAECEnv:
        return copy.deepcopy(self)


class OrderedAECEnv(OrderEnforcingWrapper):  # type: ignore[misc]
    """Raises for calls in the wrong order; a copy is a deep copy."""

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
    """Return a scenario as a PettingZoo AECEnv; for arguments and errors see `parallel_env`."""
    world = parallel_env(scenario, render_mode=render_mode, max_cycles=max_cycles, **options)
    return OrderedAECEnv(FleetAECEnv(world))

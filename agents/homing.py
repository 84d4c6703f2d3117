"""Rows that learn what to do beside going to the goal: actions are added to those of `goto`."""

from __future__ import annotations

from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from fgenv.agents.sb3 import FleetVecEnv
from fgenv.agents.trained import homed


class HomingVecEnv(FleetVecEnv):
    """A `FleetVecEnv` whose actions are what `goto` does, and `reach` times what is asked for.

    A policy that asks for nothing arrives where nothing is in the way, and learns to avoid from
    there. With a reach of 2 it can turn what `goto` does into its opposite.
    """

    reach = 2.0

    def step_wait(self) -> VecEnvStepReturn:
        """See `FleetVecEnv`."""
        simulator = self.simulator
        shape = (simulator.n_worlds, simulator.n_robots, simulator.action_size)
        asked, own = self._actions.reshape(shape), simulator.toward(simulator.goals)
        self._actions = homed(asked, own, self.reach).reshape(self.num_envs, -1)
        return super().step_wait()

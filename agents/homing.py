"""Rows that learn how to get near their goals: from there `goto` takes over."""

from __future__ import annotations

from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from fgenv.agents.sb3 import FleetVecEnv
from fgenv.agents.trained import homed
from fgenv.envs import View


class HomingVecEnv(FleetVecEnv):
    """A `FleetVecEnv` in which `goto` drives who is nearer than `near` to its goal.

    To stop at a place and turn as wanted is known: what is to be learned is to avoid others on the
    way there. `near` is in metres (of a fixed base: radians of all joints together).
    """

    near = 0.0

    def step_wait(self) -> VecEnvStepReturn:
        """See `FleetVecEnv`."""
        simulator = self.simulator
        if self.near > 0:
            shape = (simulator.n_worlds, simulator.n_robots, simulator.action_size)
            own = View(simulator).toward(simulator.goals)
            asked = homed(self._actions.reshape(shape), own, simulator.remaining, self.near)
            self._actions = asked.reshape(self.num_envs, -1)
        return super().step_wait()

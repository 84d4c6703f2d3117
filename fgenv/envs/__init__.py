"""Environments: one batched simulator in native code, and views of it.

>>> from fgenv.envs import Simulator
>>> simulator = Simulator("swap", worlds=32, n=8, jitter=0.5)
>>> observations = simulator.reset(seed=0)                       # (32, 8, size) float32
>>> observations, rewards, terminated, truncated = simulator.step(simulator.sample())

Importing it registers every built-in scenario with Gymnasium and PettingZoo.
"""

from .aec import FleetAECEnv, env
from .observations import Observation, Part
from .parallel import FleetParallelEnv, parallel_env
from .policy import Policy
from .record import Record, RecordError
from .recorder import Recorder
from .registration import register
from .rewards import TERMS, Reward
from .simulator import Simulator, Step
from .simulator_view import View
from .single import FleetEnv
from .state_readers import Collision
from .vector import FleetVectorEnv

__all__ = [
    "TERMS",
    "Collision",
    "FleetAECEnv",
    "FleetEnv",
    "FleetParallelEnv",
    "FleetVectorEnv",
    "Observation",
    "Part",
    "Policy",
    "Record",
    "RecordError",
    "Recorder",
    "Reward",
    "Simulator",
    "Step",
    "View",
    "env",
    "parallel_env",
]

register()

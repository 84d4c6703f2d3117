"""Environments: one batched simulator in native code, and views of it.

>>> from fgenv.envs import Simulator
>>> simulator = Simulator("swap", worlds=32, n=8, jitter=0.5)
>>> observations = simulator.reset(seed=0)                       # (32, 8, size) float32
>>> observations, rewards, terminated, truncated = simulator.step(simulator.sample())
"""

from .observations import Observation, Part
from .record import Record, RecordError
from .recorder import Recorder
from .rewards import TERMS, Reward
from .simulator import Simulator, Step
from .view import View

__all__ = [
    "TERMS",
    "Observation",
    "Part",
    "Record",
    "RecordError",
    "Recorder",
    "Reward",
    "Simulator",
    "Step",
    "View",
]

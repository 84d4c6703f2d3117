"""Environments: one batched simulator in native code, and its views.

>>> from fgenv.envs import Simulator
>>> simulator = Simulator("swap", worlds=32, n=8, jitter=0.5)
>>> observations = simulator.reset(seed=0)                       # (32, 8, size) float32
>>> observations, rewards, terminated, truncated = simulator.step(simulator.sample())
"""

from typing import TYPE_CHECKING

from fgenv._lazy import lazy_exports

if TYPE_CHECKING:
    from .aec import FleetAECEnv as FleetAECEnv
    from .aec import env as env
    from .observations import Observation as Observation
    from .observations import Part as Part
    from .parallel import FleetParallelEnv as FleetParallelEnv
    from .parallel import parallel_env as parallel_env
    from .policy import Policy as Policy
    from .policy import policy_of as policy_of
    from .policy import register_policy as register_policy
    from .record import Record as Record
    from .record import RecordError as RecordError
    from .record_replay import replay as replay
    from .recorder import Recorder as Recorder
    from .rewards import TERMS as TERMS
    from .rewards import Reward as Reward
    from .simulator import Simulator as Simulator
    from .simulator import StepResult as StepResult
    from .simulator_view import View as View
    from .single import FleetEnv as FleetEnv
    from .state_readers import Collision as Collision
    from .vector import FleetVectorEnv as FleetVectorEnv

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "aec": ("FleetAECEnv", "env"),
        "observations": ("Observation", "Part"),
        "parallel": ("FleetParallelEnv", "parallel_env"),
        "policy": ("Policy", "policy_of", "register_policy"),
        "record": ("Record", "RecordError"),
        "record_replay": ("replay",),
        "recorder": ("Recorder",),
        "rewards": ("TERMS", "Reward"),
        "simulator": ("Simulator", "StepResult"),
        "simulator_view": ("View",),
        "single": ("FleetEnv",),
        "state_readers": ("Collision",),
        "vector": ("FleetVectorEnv",),
    },
)

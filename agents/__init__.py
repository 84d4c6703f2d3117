"""What moves the bodies of a scene: policies, path following, planning anew."""

import importlib
from typing import TYPE_CHECKING, Any

from fgenv.agents.drive import Drive, drive
from fgenv.agents.episode import run_episode
from fgenv.agents.evaluation import Evaluation, evaluate
from fgenv.agents.events import Arrived, Hit, MasksCleared, MasksSet, Replanned
from fgenv.agents.experiment import Experiment, run_experiment
from fgenv.agents.facts import facts
from fgenv.agents.goto import GoTo
from fgenv.agents.orca import Orca
from fgenv.agents.path_follower import PathFollower
from fgenv.agents.policy import POLICIES, policy_of
from fgenv.agents.policy_file import PolicyError, PolicyFile
from fgenv.agents.random_policy import RandomPolicy
from fgenv.agents.replan import Journey, drive_and_replan
from fgenv.agents.rest import Rest
from fgenv.agents.trained import Trained
from fgenv.envs import Policy

if TYPE_CHECKING:
    from fgenv.agents.planned import Planned, PlanWarning
    from fgenv.agents.replanning import Replanning
    from fgenv.agents.sb3 import FleetVecEnv

# By module; imported when first asked for: they bring OMPL along.
LATER = {"planned": ("PlanWarning", "Planned"), "replanning": ("Replanning",)}

__all__ = [
    "POLICIES",
    "Arrived",
    "Drive",
    "Evaluation",
    "Experiment",
    "FleetVecEnv",
    "GoTo",
    "Hit",
    "Journey",
    "MasksCleared",
    "MasksSet",
    "Orca",
    "PathFollower",
    "PlanWarning",
    "Planned",
    "Policy",
    "PolicyError",
    "PolicyFile",
    "RandomPolicy",
    "Replanned",
    "Replanning",
    "Rest",
    "Trained",
    "drive",
    "drive_and_replan",
    "evaluate",
    "facts",
    "policy_of",
    "run_episode",
    "run_experiment",
]


def __getattr__(name: str) -> Any:
    """What is imported when first asked for; `FleetVecEnv` brings Stable-Baselines3 along."""
    for module, names in LATER.items():
        if name in names:
            return getattr(importlib.import_module(f"fgenv.agents.{module}"), name)
    if name != "FleetVecEnv":
        raise AttributeError(f"module 'fgenv.agents' has no attribute {name!r}")
    try:
        from fgenv.agents.sb3 import FleetVecEnv
    except ModuleNotFoundError as error:
        if error.name != "stable_baselines3":
            raise
        remedy = "pip install 'fgenv[agents]'"
        raise ModuleNotFoundError(
            f"FleetVecEnv needs stable_baselines3, {remedy}", name=error.name
        ) from None
    return FleetVecEnv

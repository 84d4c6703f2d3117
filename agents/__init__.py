"""Policies: built-in, planned and trained; their training and evaluation."""

import importlib
from typing import TYPE_CHECKING, Any

from fgenv.agents.evaluation.episode import run_episode
from fgenv.agents.evaluation.evaluation import Evaluation, evaluate
from fgenv.agents.policies.file import PolicyError, PolicyFile
from fgenv.agents.policies.goto import GoTo
from fgenv.agents.policies.network import Trained
from fgenv.agents.policies.orca import Orca
from fgenv.agents.policies.random import RandomPolicy
from fgenv.agents.policies.rest import Rest
from fgenv.agents.registry import POLICIES, policy_of
from fgenv.envs import Policy

if TYPE_CHECKING:
    from fgenv.agents.policies.plan import Planned, PlanWarning
    from fgenv.agents.policies.replan import Replanning
    from fgenv.agents.training.vec_env import FleetVecEnv

# By module; imported when first asked for: they bring OMPL along.
LATER = {"policies.plan": ("PlanWarning", "Planned"), "policies.replan": ("Replanning",)}

__all__ = [
    "POLICIES",
    "Evaluation",
    "FleetVecEnv",
    "GoTo",
    "Orca",
    "PlanWarning",
    "Planned",
    "Policy",
    "PolicyError",
    "PolicyFile",
    "RandomPolicy",
    "Replanning",
    "Rest",
    "Trained",
    "evaluate",
    "policy_of",
    "run_episode",
]


def __getattr__(name: str) -> Any:
    """What is imported when first asked for; `FleetVecEnv` brings Stable-Baselines3 along."""
    for module, names in LATER.items():
        if name in names:
            return getattr(importlib.import_module(f"fgenv.agents.{module}"), name)
    if name != "FleetVecEnv":
        raise AttributeError(f"module 'fgenv.agents' has no attribute {name!r}")
    try:
        from fgenv.agents.training.vec_env import FleetVecEnv
    except ModuleNotFoundError as error:
        if error.name != "stable_baselines3":
            raise
        remedy = "pip install 'fgenv[agents]'"
        raise ModuleNotFoundError(
            f"FleetVecEnv needs stable_baselines3, {remedy}", name=error.name
        ) from None
    return FleetVecEnv

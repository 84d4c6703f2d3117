"""Policies, the tracking of plans, training and evaluation."""

from typing import TYPE_CHECKING

from fgenv._lazy import lazy_exports

if TYPE_CHECKING:
    from fgenv.agents.evaluation.episode import run_episode as run_episode
    from fgenv.agents.evaluation.evaluation import Evaluation as Evaluation
    from fgenv.agents.evaluation.evaluation import evaluate as evaluate
    from fgenv.agents.policies.goto import GoToPolicy as GoToPolicy
    from fgenv.agents.policies.network import NetworkPolicy as NetworkPolicy
    from fgenv.agents.policies.orca import OrcaPolicy as OrcaPolicy
    from fgenv.agents.policies.plan import PlanPolicy as PlanPolicy
    from fgenv.agents.policies.plan import PlanWarning as PlanWarning
    from fgenv.agents.policies.policy_file import PolicyError as PolicyError
    from fgenv.agents.policies.policy_file import PolicyFile as PolicyFile
    from fgenv.agents.policies.random import RandomPolicy as RandomPolicy
    from fgenv.agents.policies.replan import ReplanPolicy as ReplanPolicy
    from fgenv.agents.policies.rest import RestPolicy as RestPolicy
    from fgenv.agents.policies.safety_filter import SafetyFilter as SafetyFilter
    from fgenv.agents.policies.sb3 import Sb3Policy as Sb3Policy
    from fgenv.agents.training.vec_env import FleetVecEnv as FleetVecEnv

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "evaluation.episode": ("run_episode",),
        "evaluation.evaluation": ("Evaluation", "evaluate"),
        "policies.goto": ("GoToPolicy",),
        "policies.network": ("NetworkPolicy",),
        "policies.orca": ("OrcaPolicy",),
        "policies.plan": ("PlanPolicy", "PlanWarning"),
        "policies.policy_file": ("PolicyError", "PolicyFile"),
        "policies.random": ("RandomPolicy",),
        "policies.replan": ("ReplanPolicy",),
        "policies.rest": ("RestPolicy",),
        "policies.safety_filter": ("SafetyFilter",),
        "policies.sb3": ("Sb3Policy",),
        "training.vec_env": ("FleetVecEnv",),
    },
)

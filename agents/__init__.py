"""What moves the bodies of a scene: policies, path following, planning anew."""

from fgenv.agents.drive import Drive, drive
from fgenv.agents.episode import run_episode
from fgenv.agents.events import Arrived, Hit, MasksCleared, MasksSet, Replanned
from fgenv.agents.experiment import Experiment, run_experiment
from fgenv.agents.facts import facts
from fgenv.agents.goto import GoTo
from fgenv.agents.path_follower import PathFollower
from fgenv.agents.policy import POLICIES, Policy, policy_of
from fgenv.agents.random_policy import RandomPolicy
from fgenv.agents.replan import Journey, drive_and_replan
from fgenv.agents.rest import Rest

__all__ = [
    "POLICIES",
    "Arrived",
    "Drive",
    "Experiment",
    "GoTo",
    "Hit",
    "Journey",
    "MasksCleared",
    "MasksSet",
    "PathFollower",
    "Policy",
    "RandomPolicy",
    "Replanned",
    "Rest",
    "drive",
    "drive_and_replan",
    "facts",
    "policy_of",
    "run_episode",
    "run_experiment",
]

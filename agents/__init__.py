"""What moves the bodies of a scene: path following, driving under masks, planning anew."""

from fgenv.agents.drive import Drive, drive
from fgenv.agents.events import Arrived, Hit, MasksCleared, MasksSet, Replanned
from fgenv.agents.experiment import Experiment, run_experiment
from fgenv.agents.facts import facts
from fgenv.agents.path_follower import PathFollower
from fgenv.agents.replan import Journey, drive_and_replan

__all__ = [
    "Arrived",
    "Drive",
    "Experiment",
    "Hit",
    "Journey",
    "MasksCleared",
    "MasksSet",
    "PathFollower",
    "Replanned",
    "drive",
    "drive_and_replan",
    "facts",
    "run_experiment",
]

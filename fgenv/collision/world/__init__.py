"""A world: moving bodies, their collision masks and certified motions.

Path-driven masks follow Ma Li, Wang Qiang et al. (sections 2.3 and 2.4), made sound and per robot.
Motions are certified by conservative advancement. README, "How it works", gives the reasons.
"""

from .base import TOLERANCE, Bodies, Body, Model
from .results import BodyRecord, Clearances, MotionResult, RayHits
from .world import World

__all__ = [
    "TOLERANCE",
    "Bodies",
    "Body",
    "BodyRecord",
    "Clearances",
    "Model",
    "MotionResult",
    "RayHits",
    "World",
]

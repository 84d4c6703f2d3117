"""Motion planning for scenarios, with OMPL and multi-robot search."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from fgenv.planners.errors import PlanningError

if TYPE_CHECKING:
    from fgenv.planners.certificate import Certificate, certify
    from fgenv.planners.methods import METHODS
    from fgenv.planners.multi.composite import PLANNERS, JointPath, PlannerGraph, plan_composite
    from fgenv.planners.ompl.checkers import MotionValidator, StateValidityChecker
    from fgenv.planners.ompl.setup import Setup, setup
    from fgenv.planners.ompl.spaces import StateLayout, state_space
    from fgenv.planners.plan import Plan, PlanError
    from fgenv.planners.problem import Problem
    from fgenv.planners.steering import Steering, legs
    from fgenv.planners.verification import verify

# Names by module; imported on first access, since most of these modules import OMPL.
LAZY = {
    "certificate": ("Certificate", "certify"),
    "methods": ("METHODS",),
    "multi.composite": ("PLANNERS", "JointPath", "PlannerGraph", "plan_composite"),
    "ompl.checkers": ("MotionValidator", "StateValidityChecker"),
    "ompl.setup": ("Setup", "setup"),
    "ompl.spaces": ("StateLayout", "state_space"),
    "plan": ("Plan", "PlanError"),
    "problem": ("Problem",),
    "steering": ("Steering", "legs"),
    "verification": ("verify",),
}

__all__ = [
    "METHODS",
    "PLANNERS",
    "Certificate",
    "JointPath",
    "MotionValidator",
    "Plan",
    "PlanError",
    "PlannerGraph",
    "PlanningError",
    "Problem",
    "Setup",
    "StateLayout",
    "StateValidityChecker",
    "Steering",
    "certify",
    "legs",
    "plan_composite",
    "setup",
    "state_space",
    "verify",
]


def __getattr__(name: str) -> Any:
    for module, names in LAZY.items():
        if name in names:
            return getattr(importlib.import_module(f"fgenv.planners.{module}"), name)
    raise AttributeError(f"module 'fgenv.planners' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__

"""Motion planning with OMPL over fgenv's worlds."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from fgenv.planners.errors import PlanningError

if TYPE_CHECKING:
    from fgenv.planners.certificate import Certificate, certify
    from fgenv.planners.methods import METHODS, plan
    from fgenv.planners.multi.composite import PLANNERS, Graph, Route, composite
    from fgenv.planners.ompl.plugin import MotionValidator, Setup, StateValidityChecker, setup
    from fgenv.planners.ompl.spaces import Layout, space_of
    from fgenv.planners.plan import Plan, PlanError, verify
    from fgenv.planners.problem import Problem
    from fgenv.planners.steering import Steering, legs

# By module; imported when first asked for: some bring OMPL along, which takes a while.
LATER = {
    "certificate": ("Certificate", "certify"),
    "methods": ("METHODS", "plan"),
    "plan": ("Plan", "PlanError", "verify"),
    "ompl.plugin": ("MotionValidator", "Setup", "StateValidityChecker", "setup"),
    "problem": ("Problem",),
    "multi.composite": ("PLANNERS", "Graph", "Route", "composite"),
    "ompl.spaces": ("Layout", "space_of"),
    "steering": ("Steering", "legs"),
}

__all__ = [
    "METHODS",
    "PLANNERS",
    "Certificate",
    "Graph",
    "Layout",
    "MotionValidator",
    "Plan",
    "PlanError",
    "PlanningError",
    "Problem",
    "Route",
    "Setup",
    "StateValidityChecker",
    "Steering",
    "certify",
    "composite",
    "legs",
    "plan",
    "setup",
    "space_of",
    "verify",
]


def __getattr__(name: str) -> Any:
    for module, names in LATER.items():
        if name in names:
            return getattr(importlib.import_module(f"fgenv.planners.{module}"), name)
    raise AttributeError(f"module 'fgenv.planners' has no attribute {name!r}")

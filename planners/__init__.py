"""Motion planning for scenarios, with OMPL and multi-robot search."""

from typing import TYPE_CHECKING

from fgenv._lazy import lazy_exports

if TYPE_CHECKING:
    from fgenv.planners.certificate import Certificate as Certificate
    from fgenv.planners.certificate import certify as certify
    from fgenv.planners.errors import PlanningError as PlanningError
    from fgenv.planners.methods import METHODS as METHODS
    from fgenv.planners.multi.composite import PLANNERS as PLANNERS
    from fgenv.planners.multi.composite import JointPath as JointPath
    from fgenv.planners.multi.composite import PlannerGraph as PlannerGraph
    from fgenv.planners.multi.composite import plan_composite as plan_composite
    from fgenv.planners.ompl.checkers import MotionValidator as MotionValidator
    from fgenv.planners.ompl.checkers import StateValidityChecker as StateValidityChecker
    from fgenv.planners.ompl.setup import Setup as Setup
    from fgenv.planners.ompl.setup import setup as setup
    from fgenv.planners.ompl.spaces import StateLayout as StateLayout
    from fgenv.planners.ompl.spaces import state_space as state_space
    from fgenv.planners.plan import Plan as Plan
    from fgenv.planners.plan import PlanError as PlanError
    from fgenv.planners.problem import Problem as Problem
    from fgenv.planners.verification import verify as verify

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "certificate": ("Certificate", "certify"),
        "errors": ("PlanningError",),
        "methods": ("METHODS",),
        "multi.composite": ("PLANNERS", "JointPath", "PlannerGraph", "plan_composite"),
        "ompl.checkers": ("MotionValidator", "StateValidityChecker"),
        "ompl.setup": ("Setup", "setup"),
        "ompl.spaces": ("StateLayout", "state_space"),
        "plan": ("Plan", "PlanError"),
        "problem": ("Problem",),
        "verification": ("verify",),
    },
)

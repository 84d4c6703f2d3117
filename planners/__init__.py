"""Motion planning with OMPL over fgenv's collision queries."""

from fgenv.planners.clearance import Clearance, prove_free
from fgenv.planners.planar import PlanarChecker, plan_planar
from fgenv.planners.rrt_connect import Plan, PlanningError, rrt_connect

__all__ = [
    "Clearance",
    "Plan",
    "PlanarChecker",
    "PlanningError",
    "plan_planar",
    "prove_free",
    "rrt_connect",
]

"""Motion planning with OMPL over fgenv's worlds."""

from fgenv.planners.planar import PlanarChecker, plan_planar
from fgenv.planners.proof import Proof, prove_free
from fgenv.planners.rrt_connect import Plan, PlanningError, rrt_connect

__all__ = [
    "Plan",
    "PlanarChecker",
    "PlanningError",
    "Proof",
    "plan_planar",
    "prove_free",
    "rrt_connect",
]

"""Exact, fast collision detection by feature graphs, for environments of many robots."""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fgenv.envs.aec import env as env
    from fgenv.envs.parallel import parallel_env as parallel_env
    from fgenv.planners.planning import plan as plan
    from fgenv.planners.verification import verify as verify

__version__ = "0.1.0"


MODULES = {
    "env": "envs",
    "parallel_env": "envs",
    "plan": "planners.planning",
    "verify": "planners.verification",
}


def __getattr__(name: str) -> Any:
    """Import environments and planning on first access, since PettingZoo and OMPL load slowly."""
    if name not in MODULES:
        raise AttributeError(f"module 'fgenv' has no attribute {name!r}")
    return getattr(importlib.import_module(f"fgenv.{MODULES[name]}"), name)

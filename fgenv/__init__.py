"""Exact, fast collision detection by feature graphs, for environments of many robots."""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fgenv.envs.aec import env as env
    from fgenv.envs.parallel import parallel_env as parallel_env
    from fgenv.planners.methods import plan as plan
    from fgenv.planners.plan import verify as verify

__version__ = "0.1.0"


FACES = {"env": "envs", "parallel_env": "envs", "plan": "planners", "verify": "planners"}


def __getattr__(name: str) -> Any:
    """Environments and planning, imported when first asked for: PettingZoo and OMPL come along."""
    if name not in FACES:
        raise AttributeError(f"module 'fgenv' has no attribute {name!r}")
    return getattr(importlib.import_module(f"fgenv.{FACES[name]}"), name)

"""Exact, fast collision detection by feature graphs, for environments of many robots."""

from typing import TYPE_CHECKING

from fgenv._lazy import lazy_exports
from fgenv.registration import register

if TYPE_CHECKING:
    from fgenv.envs.aec import env as env
    from fgenv.envs.parallel import parallel_env as parallel_env
    from fgenv.planners.planning import plan as plan
    from fgenv.planners.verification import verify as verify

__version__ = "0.1.0"
__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "envs.aec": ("env",),
        "envs.parallel": ("parallel_env",),
        "planners.planning": ("plan",),
        "planners.verification": ("verify",),
    },
)

register()

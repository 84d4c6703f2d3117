"""Exact, fast collision detection by feature graphs, for environments of many robots."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fgenv.envs.aec import env as env
    from fgenv.envs.parallel import parallel_env as parallel_env

__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    """`parallel_env` and `env`, imported when first asked for: they bring PettingZoo along."""
    if name not in ("env", "parallel_env"):
        raise AttributeError(f"module 'fgenv' has no attribute {name!r}")
    import fgenv.envs as envs

    return getattr(envs, name)

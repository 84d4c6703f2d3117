"""Libraries that step many robots, used as their documentation shows, without a display."""

from __future__ import annotations

from importlib.util import find_spec

from fgenv.bench.common.machine import package_versions
from fgenv.bench.env import fgenv_
from fgenv.bench.env.batch import ACTIONS, Batch, Library, parallel_batch

RAYS = 12  # per lidar: the default of VMAS
ENDLESS = 10**9  # steps, so that MPE2 needs no resets


def navigation(robots: int, worlds: int, seed: int) -> Batch:
    """VMAS `navigation`, default sizes: discs that push each other apart, goals, lidars.

    Its lidars detect discs only. It does not restart episodes, and the race does not require it.
    """
    import torch
    from vmas import make_env

    torch.set_num_threads(1)
    env = make_env(
        "navigation",
        num_envs=worlds,
        seed=seed,
        n_agents=robots,
        collisions=True,
        n_lidar_rays=RAYS,
        lidar_range=0.35,  # meters; agents have a radius of 0.1
    )
    draw = torch.Generator().manual_seed(seed)
    actions = 2.0 * torch.rand((ACTIONS, robots, worlds, 2), generator=draw) - 1.0
    lists = [list(step) for step in actions]  # (worlds, 2) per agent, as VMAS expects
    return Batch(robots, worlds, lambda k: env.step(lists[k % ACTIONS]), lambda: env.reset(seed))


def spread(robots: int, worlds: int, seed: int) -> Batch:
    """MPE2 `simple_spread`: discs that push each other apart, landmarks; no rays, one world."""
    from mpe2 import simple_spread_v3

    if worlds != 1:
        raise ValueError(f"worlds: got {worlds}, expected 1; MPE2 steps one world")
    env = simple_spread_v3.parallel_env(N=robots, max_cycles=ENDLESS, continuous_actions=True)
    return parallel_batch(env, seed)


LIBRARIES = (
    Library("fgenv", "fgenv", "fgenv.envs", True, fgenv_.random_batch),
    Library("VMAS", "vmas", "vmas", True, navigation),
    Library("MPE2", "mpe2", "mpe2", False, spread),
)


def installed() -> list[Library]:
    """Return the installed libraries, fgenv first."""
    return [library for library in LIBRARIES if find_spec(library.module) is not None]


def versions() -> dict[str, str]:
    """Return the versions of fgenv, of the libraries, and of torch.

    Raises:
        PackageNotFoundError: an ImportError with the name of the package.
    """
    return package_versions((*(library.package for library in LIBRARIES), "torch"))

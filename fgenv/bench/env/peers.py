"""Libraries that step many robots, as their makers document them. None needs a display."""

from __future__ import annotations

from importlib.metadata import version
from importlib.util import find_spec

from fgenv.bench.env import ours
from fgenv.bench.env.batch import ACTIONS, Batch, Peer
from fgenv.bench.env.parallel import parallel_batch

RAYS = 12  # of a lidar: the default of VMAS
ENDLESS = 10**9  # steps: MPE2 is spared resets


def navigation(robots: int, worlds: int, seed: int) -> Batch:
    """VMAS `navigation`, default sizes: discs that push each other apart, goals, lidars.

    Its lidars see discs only. It starts no episode anew by itself, and is spared it.
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
    drawn = 2.0 * torch.rand((ACTIONS, robots, worlds, 2), generator=draw) - 1.0
    lists = [list(actions) for actions in drawn]  # an (E, 2) for each agent, as it wants them
    return Batch(robots, worlds, lambda k: env.step(lists[k % ACTIONS]), lambda: env.reset(seed))


def spread(robots: int, worlds: int, seed: int) -> Batch:
    """MPE2 `simple_spread`: discs that push each other apart, landmarks; no rays, one world."""
    from mpe2 import simple_spread_v3

    if worlds != 1:
        raise ValueError(f"worlds: got {worlds}, expected 1: MPE2 steps no more at once")
    env = simple_spread_v3.parallel_env(N=robots, max_cycles=ENDLESS, continuous_actions=True)
    return parallel_batch(env, seed)


PEERS = (
    Peer("fgenv", "fgenv", "fgenv.envs", True, ours.random_batch),
    Peer("VMAS", "vmas", "vmas", True, navigation),
    Peer("MPE2", "mpe2", "mpe2", False, spread),
)


def peers() -> list[Peer]:
    """Those that are installed, fgenv first."""
    return [peer for peer in PEERS if find_spec(peer.needs) is not None]


def versions() -> dict[str, str]:
    """Versions of fgenv, of its peers, and of their numeric libraries.

    Raises:
        PackageNotFoundError: an ImportError that names the package.
    """
    return {name: version(name) for name in (*(peer.package for peer in PEERS), "torch")}

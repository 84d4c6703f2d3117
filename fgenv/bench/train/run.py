"""How fast a policy learns: our rows against SuperSuit's, the same environment and the same PPO."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from statistics import median
from time import process_time
from typing import Any

from stable_baselines3.common.callbacks import BaseCallback

import fgenv
from fgenv.agents.training.ppo import ppo
from fgenv.agents.training.recipes import recipe_of
from fgenv.agents.training.vec_env import FleetVecEnv
from fgenv.bench.common.timing import Clock
from fgenv.envs import Observation

ROBOTS, JITTER, MAX_STEPS = 8, 0.3, 300
SEEN = Observation(lidar=False, neighbors=3)
ROWS = {"fgenv": 32, "SuperSuit": 32}  # worlds
Record = dict[str, Any]


def ours(worlds: int, seed: int) -> FleetVecEnv:
    """`FleetVecEnv` over one simulator."""
    return FleetVecEnv(
        "swap",
        worlds,
        n=ROBOTS,
        jitter=JITTER,
        seed=seed,
        observation=SEEN,
        max_steps=MAX_STEPS,
        threads=1,
    )


def theirs(worlds: int, seed: int) -> Any:
    """`fgenv.parallel_env` in SuperSuit's rows, in this process, as its tutorials have them."""
    import supersuit

    env = fgenv.parallel_env(
        "swap",
        n=ROBOTS,
        jitter=JITTER,
        seed=seed,
        observation=SEEN,
        max_cycles=MAX_STEPS,
        threads=1,
    )
    rows = supersuit.pettingzoo_env_to_vec_env_v1(supersuit.black_death_v3(env))
    return supersuit.concat_vec_envs_v1(rows, worlds, num_cpus=0, base_class="stable_baselines3")


def ways() -> dict[str, Callable[[int, int], Any]]:
    """Those that are installed, ours first."""
    found: dict[str, Callable[[int, int], Any]] = {"fgenv": ours}
    if find_spec("supersuit") is not None:
        found["SuperSuit"] = theirs
    return found


class Parts(BaseCallback):
    """CPU seconds of gathering samples and of learning from them."""

    def __init__(self, clock: Clock) -> None:
        super().__init__()
        self.clock, self.gathering = clock, 0.0

    def _on_rollout_start(self) -> None:
        self._began = self.clock()

    def _on_rollout_end(self) -> None:
        self.gathering += self.clock() - self._began

    def _on_step(self) -> bool:
        return True


def bench_train(
    *,
    rounds: int = 3,
    seed: int = 0,
    progress: Callable[[str], object] | None = None,
    clock: Clock = process_time,
) -> list[Record]:
    """Samples in a CPU second, PPO with its default network (two layers of 64), one thread.

    They take turns to gather 64 steps per row and learn from them; the result is the median over
    rounds, a first one not counted: `gather` with the policy's actions, `learn` the whole.
    """
    import torch

    torch.set_num_threads(1)
    models = {name: model(make(ROWS[name], seed), seed) for name, make in ways().items()}
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in models}
    for turn in range(rounds + 1):
        for name, one in models.items():
            if progress is not None:
                progress(f"{name}, round {turn} of {rounds}")
            found = timed(one, clock)
            if turn > 0:
                times[name].append(found)
    return [record(name, models[name], times[name]) for name in models]


def model(envs: Any, seed: int) -> Any:
    """PPO as our recipe for `swap` has it; SuperSuit's rows cannot be seeded."""
    if not isinstance(envs, FleetVecEnv):
        envs.seed = lambda seed=None: [seed] * envs.num_envs
    return ppo(recipe_of("swap"), envs, seed)


def timed(one: Any, clock: Clock) -> tuple[float, float]:
    """Seconds a sample: gathered, and learned from."""
    parts, began, n = Parts(clock), clock(), one.n_steps * one.n_envs
    one.learn(n, callback=parts, reset_num_timesteps=False)
    return parts.gathering / n, (clock() - began) / n


def record(name: str, one: Any, times: list[tuple[float, float]]) -> Record:
    """Rates of one of them."""
    gather, learn = (1.0 / median(row) for row in zip(*times, strict=True))
    return {"name": name, "rows": one.n_envs, "gather": gather, "learn": learn}

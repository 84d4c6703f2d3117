"""Rates of training: fgenv's VecEnv and SuperSuit's, same environment, same PPO."""

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
from fgenv.bench.common.records import OWN, Record
from fgenv.bench.common.timing import Clock, take_turns
from fgenv.envs import Observation

MAX_STEPS = 300
SCENARIO: dict[str, Any] = {"n": 8, "jitter": 0.3, "threads": 1}
SCENARIO["observation"] = Observation(lidar=False, neighbors=3)
ROWS = {"fgenv": 32, "SuperSuit": 32}  # worlds


def fleet_vec_env(worlds: int, seed: int) -> FleetVecEnv:
    """Return `FleetVecEnv` over one simulator."""
    return FleetVecEnv("swap", worlds, seed=seed, max_steps=MAX_STEPS, **SCENARIO)


def supersuit_vec_env(worlds: int, seed: int) -> Any:
    """Return `fgenv.parallel_env` in SuperSuit's rows, in this process, as in its tutorials."""
    import supersuit

    env = fgenv.parallel_env("swap", seed=seed, max_cycles=MAX_STEPS, **SCENARIO)
    rows = supersuit.pettingzoo_env_to_vec_env_v1(supersuit.black_death_v3(env))
    return supersuit.concat_vec_envs_v1(rows, worlds, num_cpus=0, base_class="stable_baselines3")


def makers() -> dict[str, Callable[[int, int], Any]]:
    """Return the makers of environments that are installed, fgenv first."""
    installed: dict[str, Callable[[int, int], Any]] = {OWN: fleet_vec_env}
    if find_spec("supersuit") is not None:
        installed["SuperSuit"] = supersuit_vec_env
    return installed


class Parts(BaseCallback):
    """CPU seconds of gathering samples."""

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
    """Return samples per CPU second of PPO with its default network (2 x 64), one thread.

    The environments take turns to gather 64 steps per row and learn from them. Results are medians
    over rounds, without a first round: `gather` with the policy's actions, `learn` in total.
    """
    import torch

    torch.set_num_threads(1)
    models = {name: model(make(ROWS[name], seed), seed) for name, make in makers().items()}
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in models}
    for name in take_turns(list(models), rounds + 1):
        if progress is not None:
            progress(f"{name}, round {len(times[name])} of {rounds}")
        times[name].append(sample_seconds(models[name], clock))
    return [record(name, models[name], times[name][1:]) for name in models]


def model(envs: Any, seed: int) -> Any:
    """Return PPO with the recipe of `swap`; SuperSuit's rows cannot be seeded."""
    if not isinstance(envs, FleetVecEnv):
        envs.seed = lambda seed=None: [seed] * envs.num_envs
    return ppo(recipe_of("swap"), envs, seed)


def sample_seconds(learner: Any, clock: Clock) -> tuple[float, float]:
    """Return seconds per sample: gathered, and learned from."""
    parts, began, n = Parts(clock), clock(), learner.n_steps * learner.n_envs
    learner.learn(n, callback=parts, reset_num_timesteps=False)
    return parts.gathering / n, (clock() - began) / n


def record(name: str, learner: Any, times: list[tuple[float, float]]) -> Record:
    """Return the rates of one environment."""
    gather, learn = (1.0 / median(row) for row in zip(*times, strict=True))
    return {"name": name, "rows": learner.n_envs, "gather": gather, "learn": learn}

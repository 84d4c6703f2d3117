"""PPO of Stable-Baselines3 with the hyperparameters of a recipe."""

from __future__ import annotations

from typing import Any

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.buffers import RolloutBuffer

from fgenv.agents.training.config import Recipe

ACTIVATIONS = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU}


def ppo(
    recipe: Recipe, envs: Any, seed: int, rollout_buffer: type[RolloutBuffer] | None = None
) -> PPO:
    """Return a new model."""
    return PPO(
        "MlpPolicy",
        envs,
        n_steps=recipe.n_steps,
        batch_size=equal_batch_size(recipe, envs.num_envs),
        n_epochs=recipe.n_epochs,
        learning_rate=recipe.learning_rate,
        gamma=recipe.gamma,
        gae_lambda=recipe.gae_lambda,
        ent_coef=recipe.ent_coef,
        seed=seed,
        use_sde=recipe.sde_sample_freq > 0,
        sde_sample_freq=recipe.sde_sample_freq or -1,
        device="cpu",
        rollout_buffer_class=rollout_buffer,
        policy_kwargs={
            "net_arch": list(recipe.net_arch),
            "activation_fn": ACTIVATIONS[recipe.activation],
            "log_std_init": recipe.log_std_init,
        },
    )


def equal_batch_size(recipe: Recipe, rows: int) -> int:
    """Return the largest size of equal batches up to the recipe's."""
    samples = rows * recipe.n_steps
    return next(b for b in range(min(recipe.batch_size, samples), 0, -1) if samples % b == 0)

"""A model of Stable-Baselines3 as a policy's file that needs no PyTorch."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np
import stable_baselines3
import torch

from fgenv import __version__
from fgenv.agents.policies.policy_file import PolicyFile
from fgenv.agents.policies.residual import ResidualConfig
from fgenv.envs import Simulator

NAMES = {torch.nn.Tanh: "tanh", torch.nn.ReLU: "relu"}


def exported(
    model: Any,
    normal: Any,
    simulator: Simulator,
    about: dict[str, Any],
    base: ResidualConfig,
) -> PolicyFile:
    """The network that gives the best action, and the normalization of what it sees.

    Args:
        model: PPO or A2C with an `MlpPolicy`, of tanh or relu layers.
        normal: the `VecNormalize` that it was trained in; None: it saw observations as they are.
        simulator: that it was trained in.
        about: name, command, seed, scenario, steps.
        base: what made actions of its output, see `HomingVecEnv`.

    Raises:
        ValueError: the network is of another kind.
    """
    inner, last = model.policy.mlp_extractor.policy_net, model.policy.action_net
    linear = [module for module in inner if isinstance(module, torch.nn.Linear)]
    kinds = {type(module) for module in inner if not isinstance(module, torch.nn.Linear)}
    if len(kinds) > 1 or not kinds <= NAMES.keys() or not isinstance(last, torch.nn.Linear):
        told = ", ".join(sorted(kind.__name__ for kind in kinds))
        raise ValueError(f"model: layers of {told}, expected Tanh or ReLU throughout")
    layers = tuple((numbers(module.weight).T, numbers(module.bias)) for module in (*linear, last))
    size = simulator.observation_size
    mean, std, clip = np.zeros(size), np.ones(size), 1e6
    if normal is not None:
        mean, clip = normal.obs_rms.mean.copy(), float(normal.clip_obs)
        std = np.sqrt(normal.obs_rms.var + normal.epsilon)
    whole = {
        **about,
        "observation": asdict(simulator.observation),
        "parts": [[part.name, part.slice.stop - part.slice.start] for part in simulator.layouts[0]],
        "actions": simulator.actions,
        "action_names": [list(action[:4]) for action in simulator.robots[0].actions],
        **asdict(base),
        "activation": NAMES[next(iter(kinds))] if kinds else "tanh",
        "clip": clip,
        "versions": {
            "fgenv": __version__,
            "torch": torch.__version__,
            "stable_baselines3": stable_baselines3.__version__,
        },
    }
    return PolicyFile(whole, mean, std, layers)


def numbers(parameter: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    """A parameter of a network."""
    return np.asarray(parameter.detach().cpu().numpy(), dtype=np.float64)

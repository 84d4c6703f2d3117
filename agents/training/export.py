"""Export of models of Stable-Baselines3 to policy files, which need no PyTorch."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np
import stable_baselines3
import torch

from fgenv import __version__
from fgenv.agents.policies.policy_file import PolicyFile
from fgenv.agents.policies.residual import ResidualConfig
from fgenv.arrays import Floats
from fgenv.envs import Simulator

ACTIVATIONS = {torch.nn.Tanh: "tanh", torch.nn.ReLU: "relu"}


def export_policy(
    model: Any,
    normalization: Any,
    simulator: Simulator,
    about: dict[str, Any],
    config: ResidualConfig,
) -> PolicyFile:
    """Return the network of the deterministic action with its input normalization.

    Args:
        model: PPO or A2C with an `MlpPolicy` of tanh or relu layers.
        normalization: `VecNormalize` of the training; None: observations were not normalized.
        simulator: of the training.
        about: name, command, seed, scenario, steps.
        config: of the residual actions.

    Raises:
        ValueError: another kind of network.
    """
    layers, activation = network(model.policy)
    size = simulator.observation_size
    mean, std, clip = np.zeros(size), np.ones(size), 1e6
    if normalization is not None:
        mean, clip = normalization.obs_rms.mean.copy(), float(normalization.clip_obs)
        std = np.sqrt(normalization.obs_rms.var + normalization.epsilon)
    complete = {
        **about,
        "observation": asdict(simulator.observation),
        "parts": [[part.name, part.slice.stop - part.slice.start] for part in simulator.layouts[0]],
        "actions": simulator.actions,
        "action_names": [list(action[:4]) for action in simulator.robots[0].actions],
        **asdict(config),
        "activation": activation,
        "clip": clip,
        "versions": {
            "fgenv": __version__,
            "torch": torch.__version__,
            "stable_baselines3": stable_baselines3.__version__,
        },
    }
    return PolicyFile(complete, mean, std, layers)


def network(policy: Any) -> tuple[tuple[tuple[Floats, Floats], ...], str]:
    """Return layers (weights, offsets) and the activation of a policy network."""
    modules, last = policy.mlp_extractor.policy_net, policy.action_net
    linear = [module for module in modules if isinstance(module, torch.nn.Linear)]
    kinds = {type(module) for module in modules if not isinstance(module, torch.nn.Linear)}
    if len(kinds) > 1 or not kinds <= ACTIVATIONS.keys() or not isinstance(last, torch.nn.Linear):
        names = ", ".join(sorted(kind.__name__ for kind in kinds))
        raise ValueError(f"model: got layers of {names}, expected Tanh or ReLU throughout")
    layers = tuple((as_array(layer.weight).T, as_array(layer.bias)) for layer in (*linear, last))
    return layers, ACTIVATIONS[next(iter(kinds))] if kinds else "tanh"


def as_array(parameter: Any) -> Floats:
    """Return a parameter of a network as an array."""
    return np.asarray(parameter.detach().cpu().numpy(), dtype=np.float64)

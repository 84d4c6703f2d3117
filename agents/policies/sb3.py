"""Models of Stable-Baselines3 as policies."""

from __future__ import annotations

import io
import json
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.agents.policies.base import BasePolicy
from fgenv.agents.policies.residual import ResidualConfig, ResidualController
from fgenv.arrays import Floats, Floats32
from fgenv.envs import Observation, View
from fgenv.trust import check as check_trust
from fgenv.trust import read as read_pickle

# Algorithms by a key of their saved data; others are A2C.
ALGORITHMS = {"clip_range": "PPO", "target_entropy": "SAC", "target_policy_noise": "TD3"}
MAX_DATA = 1 << 26  # bytes of a model's settings


class Sb3Policy(BasePolicy):
    """Takes the deterministic action of a model saved by `model.save(FILE)`: PPO, A2C, SAC or TD3.

    Needs the extra `agents`. If a file of the same name with the suffix `.pkl` exists, observations
    are normalized by the `VecNormalize` that `envs.save(...)` wrote there. Both files hold pickles,
    which can run any code: they are loaded if `fgenv train` wrote them on this machine, or with
    `trust=True` (`--trust` of the commands). The file with the suffix `.json`, written by
    `fgenv train`, has the observation, the kind of actions and the `ResidualConfig`; without it the
    policy accepts the simulator's observation.

    Args:
        path: file of the model.
        trust: load files of any origin.

    Raises:
        TrustError: the files are not known to be written on this machine.
        ValueError: not a model.
        FileNotFoundError: no such file.
    """

    def __init__(self, path: str | Path, *, trust: bool = False) -> None:
        path = Path(path)
        content = read_pickle(path)
        algorithm = algorithm_of(path, content)
        check_trust(path, content, trust)
        import stable_baselines3

        load = getattr(stable_baselines3, algorithm).load
        self._model: Any = load(io.BytesIO(content), device="cpu")
        about: dict[str, Any] = {"observation": None, "actions": "drive"}
        settings = path.with_suffix(".json")
        if settings.exists():
            about |= read_sidecar(settings, lambda: dict(json.loads(read_pickle(settings))))
        self._controller = ResidualController(ResidualConfig.of(about))
        self.actions: Any = about["actions"]
        if about["observation"] is not None:
            self.observation = Observation(**about["observation"])
        statistics = path.with_suffix(".pkl")
        self._normalize: Any = None
        if statistics.exists():  # a VecNormalize, usable here without its environment
            content = read_pickle(statistics)
            check_trust(statistics, content, trust)
            self._normalize = read_sidecar(statistics, lambda: pickle.loads(content))

    def reset(self, view: View) -> None:
        """Begin new episodes.

        Raises:
            ValueError: observations or actions differ from those of the training.
        """
        super().reset(view)
        (expected,) = self._model.observation_space.shape
        for name, parts in zip(view.names, view.layouts, strict=True):
            size = max((part.slice.stop for part in parts), default=0)
            if size != expected:
                sizes = ", ".join(f"{p.name} ({p.slice.stop - p.slice.start})" for p in parts)
                raise ValueError(
                    f"policy: {name!r} observes {size} numbers ({sizes}), expected {expected}; give"
                    " the simulator the observation of the training"
                )
        (size,) = self._model.action_space.shape
        if size != view.action_size:
            raise ValueError(f"policy: got actions of {size}, expected {view.action_size}")
        self._controller.reset(view)

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size)."""
        rows = observations.reshape(-1, observations.shape[-1])
        if self._normalize is not None:
            rows = self._normalize.normalize_obs(rows)
        predicted, _ = self._model.predict(rows, deterministic=True)
        outputs = np.asarray(predicted, dtype=np.float64).reshape(*observations.shape[:2], -1)
        return self._controller.actions(outputs, observations)


def read_sidecar(path: Path, read: Callable[[], Any]) -> Any:
    """Read a file that belongs to a model; raise ValueError if it is damaged."""
    try:
        return read()
    except OSError:
        raise
    except Exception as error:  # a pickle may raise anything
        raise ValueError(f"policy: {path} is damaged; remove it, or save it again") from error


def algorithm_of(path: Path, content: bytes) -> str:
    """Return the name of the algorithm of a saved model."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as file:
            if file.getinfo("data").file_size > MAX_DATA:
                raise ValueError("data")
            keys = json.loads(file.read("data")).keys()
    except (AttributeError, KeyError, ValueError, zipfile.BadZipFile) as error:
        message = f"policy: got {path}, expected a model that Stable-Baselines3 saved (.zip)"
        raise ValueError(message) from error
    return next((name for key, name in ALGORITHMS.items() if key in keys), "A2C")


def sb3(argument: str, seed: int) -> Sb3Policy:
    """Make the policy named `sb3:FILE`."""
    if not argument:
        raise ValueError("policy: got 'sb3:', expected sb3:FILE")
    return Sb3Policy(argument)

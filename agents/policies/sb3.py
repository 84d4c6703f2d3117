"""A model of Stable-Baselines3 as a policy."""

from __future__ import annotations

import json
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.agents.policies.base_action import Acting, BaseAction
from fgenv.agents.policies.observation import Seeing
from fgenv.arrays import Floats, Floats32
from fgenv.envs import Observation, View

KEYS = {"clip_range": "PPO", "target_entropy": "SAC", "target_policy_noise": "TD3"}


class Sb3Policy(Seeing):
    """The best action of a model that `model.save(FILE)` wrote: PPO, A2C, SAC or TD3.

    Needs the extra `agents`. Observations are normalized by the `VecNormalize` that
    `envs.save(...)` wrote to the file of the same name with the suffix `.pkl`, if there is one.
    Both hold pickles: use only files that you trust. What it observes, and where `goto` takes over,
    is in the `.json` that `fgenv train` wrote beside it; without one it
    takes what the simulator gives.

    Raises:
        ValueError: no such model.
        FileNotFoundError: no such file.
    """

    def __init__(self, path: str | Path) -> None:
        path = Path(path)
        import stable_baselines3

        kind = kind_of(path)
        self._model: Any = getattr(stable_baselines3, kind).load(path, device="cpu")
        about: dict[str, Any] = {"observation": None, "actions": "drive"}
        said = path.with_suffix(".json")
        if said.exists():
            about |= beside(said, lambda: dict(json.loads(said.read_text(encoding="utf-8"))))
        self._acting = Acting(BaseAction.of(about))
        self.actions: Any = about["actions"]
        if about["observation"] is not None:
            self.observation = Observation(**about["observation"])
        normal = path.with_suffix(".pkl")
        self._normal: Any = None
        if normal.exists():
            # a VecNormalize, which needs no environment here
            self._normal = beside(normal, lambda: pickle.loads(normal.read_bytes()))

    def reset(self, view: View) -> None:
        """Episodes begin.

        Raises:
            ValueError: the robots observe or act otherwise than those that it was trained on.
        """
        super().reset(view)
        (expected,) = self._model.observation_space.shape
        for name, parts in zip(view.names, view.layouts, strict=True):
            here = max((part.slice.stop for part in parts), default=0)
            if here != expected:
                told = ", ".join(f"{p.name} ({p.slice.stop - p.slice.start})" for p in parts)
                raise ValueError(
                    f"policy: {name!r} observes {here} numbers ({told}), expected {expected}; give"
                    " the simulator the observation that it was trained with"
                )
        (size,) = self._model.action_space.shape
        if size != view.action_size:
            raise ValueError(f"policy: gives actions of {size}, expected {view.action_size}")
        self._acting.reset(view)

    def act(self, observations: Floats32) -> Floats:
        """Actions (worlds, robots, size)."""
        rows = observations.reshape(-1, observations.shape[-1])
        if self._normal is not None:
            rows = self._normal.normalize_obs(rows)
        found, _ = self._model.predict(rows, deterministic=True)
        asked = np.asarray(found, dtype=np.float64).reshape(*observations.shape[:2], -1)
        return self._acting.actions(asked, observations)


def beside(path: Path, read: Callable[[], Any]) -> Any:
    """What is read from a file that belongs to a model; ValueError where it is damaged."""
    try:
        return read()
    except OSError:
        raise
    except Exception as error:  # a pickle may raise anything
        told = f"policy: {path} is damaged; take it away, or save it again"
        raise ValueError(told) from error


def kind_of(path: Path) -> str:
    """Which of the algorithms a file is of."""
    try:
        with zipfile.ZipFile(path) as file:
            keys = json.loads(file.read("data")).keys()
    except (KeyError, ValueError, zipfile.BadZipFile) as error:
        told = f"policy: got {path}, expected a model that Stable-Baselines3 saved (.zip)"
        raise ValueError(told) from error
    return next((name for key, name in KEYS.items() if key in keys), "A2C")

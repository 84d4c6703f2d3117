"""Trained policies as files: a network and all that is needed to use it, without PyTorch.

An archive (`fgenv.archive`) of the format "fgenv policy 1":

    about       JSON: name, command, seed, scenario (name and overrides that it was trained with),
                steps; observation (what `fgenv.envs.Observation` takes), parts (name and size of
                each part of a row, in order), actions (drive or way_points), action_names (with
                unit, lowest and highest: an action of -1 and 1); near; residual (0 if left out);
                activation (tanh or relu),
                clip; versions
    mean, std   (inputs,) float64, of the rows of observations: the network sees
                (row - mean) / std, brought to -clip to clip
    weights_k   (inputs, outputs) float64 of layer k from 0 on
    offsets_k   (outputs,) float64

The last layer's output, brought to [-1, 1], is the action; but who is nearer than `near` to its
goal (meters; of a fixed base radians of all joints) does what `goto` does. All other layers have
the activation. There is a fixed number of neighbors; where a scenario has fewer robots the missing
ones are zeros, as a simulator gives them.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.archive import Archive
from fgenv.arrays import Floats

ACTIVATIONS = ("tanh", "relu")
NEEDED = {"observation", "parts", "actions", "action_names", "near", "activation", "clip"}


class PolicyError(ValueError):
    """A policy's file that cannot be used: why, and the remedy."""


POLICY = Archive("policy", 1, ("about",), PolicyError, "train or get it again")


@dataclass(frozen=True, eq=False)
class PolicyFile:
    """What is in a file; see the module.

    Attributes:
        about: plain values.
        mean, std: (inputs,).
        layers: weights (inputs, outputs) and offsets (outputs,) of each.
    """

    about: dict[str, Any]
    mean: Floats
    std: Floats
    layers: tuple[tuple[Floats, Floats], ...]

    def __post_init__(self) -> None:
        missing = sorted(NEEDED - self.about.keys())
        if missing:
            raise PolicyError(f"policy: says nothing of {', '.join(missing)}; train it again")
        size = sum(size for _, size in self.about["parts"])
        if self.mean.shape != (size,) or self.std.shape != (size,) or not (self.std > 0).all():
            raise PolicyError(f"policy: mean, std: expected ({size},), std over 0")
        if not np.isfinite([self.mean, self.std]).all():
            raise PolicyError("policy: mean, std: expected finite numbers")
        ends = [(weights.shape[0], len(offsets)) for weights, offsets in self.layers]
        drive, actions = self.about["actions"] == "drive", len(self.about["action_names"])
        if not ends or ends[0][0] != size or (drive and ends[-1][1] != actions):
            told = f"from {ends[0][0]} to {ends[-1][1]} numbers" if ends else "none"
            raise PolicyError(f"policy: layers: got {told}, expected from {size} to {actions}")
        if self.about["activation"] not in ACTIVATIONS:
            said = self.about["activation"]
            raise PolicyError(
                f"policy: activation: got {said!r}, expected {' or '.join(ACTIVATIONS)}"
            )

    @property
    def arrays(self) -> dict[str, Floats]:
        """By the names they are stored under."""
        found = {"mean": self.mean, "std": self.std}
        for k, (weights, offsets) in enumerate(self.layers):
            found |= {f"weights_{k}": weights, f"offsets_{k}": offsets}
        return found

    @property
    def texts(self) -> dict[str, str]:
        """What is said about it, as it is stored."""
        return {"about": json.dumps(self.about, sort_keys=True, separators=(",", ":"))}

    @cached_property
    def id(self) -> str:
        """Hash of all that is in it, 64 hexadecimal digits."""
        return POLICY.id(self.texts, self.arrays)

    def save(self, path: str | Path) -> None:
        """Write a compressed .npz file; one that is there is replaced in one go.

        Raises:
            ValueError: its name does not end in .npz.
            OSError: it cannot be written.
        """
        POLICY.save(path, self.texts, self.arrays)

    @classmethod
    def load(cls, path: str | Path) -> PolicyFile:
        """Read and verify a file.

        Raises:
            PolicyError: no policy, damaged, or of another version.
            FileNotFoundError: no such file.
        """

        def read(texts: dict[str, str], arrays: dict[str, Floats]) -> PolicyFile:
            count = sum(name.startswith("weights_") for name in arrays)
            layers = tuple((arrays[f"weights_{k}"], arrays[f"offsets_{k}"]) for k in range(count))
            return cls(json.loads(texts["about"]), arrays["mean"], arrays["std"], layers)

        return POLICY.load(path, read)
